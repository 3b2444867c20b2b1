// The contacts of a step, in one of its small steps. See renew.rs.

struct Params {
    on: f32,
    share: f32,
}

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read> before: array<vec4<f32>>;
@group(1) @binding(1) var<storage, read_write> contacts: array<Contact>;

fn map(i: u32) {
    var contact = contacts[i];
    let p = contact.particles;
    contact.origin += contact.way * params.on;
    let begun = weighed(contact.weights, before[p.x].xyz, before[p.y].xyz, before[p.z].xyz, before[p.w].xyz);
    contact.start = begun + contact.way * params.share;
    contacts[i] = contact;
}
