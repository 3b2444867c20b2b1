// How deep contacts are. See contact_depth.rs.

@group(1) @binding(0) var<storage, read> contacts: array<Contact>;
@group(1) @binding(1) var<storage, read> q: array<vec4<f32>>;
@group(1) @binding(2) var<storage, read_write> depths: array<f32>;

fn map(i: u32) {
    let contact = contacts[i];
    let p = contact.particles;
    let aq = weighed(contact.weights, q[p.x].xyz, q[p.y].xyz, q[p.z].xyz, q[p.w].xyz);
    depths[i] = max(depth(contact, aq), 0.0);
}
