// The energy of contacts. See contact_energy.rs.

struct Params {
    stiffness: f32,
}

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read> contacts: array<Contact>;
@group(1) @binding(1) var<storage, read> mobility: array<f32>;
@group(1) @binding(2) var<storage, read> q: array<vec4<f32>>;
@group(1) @binding(3) var<storage, read_write> energies: array<f32>;

fn map(i: u32) {
    let contact = contacts[i];
    let p = contact.particles;
    let a = contact.weights;
    let softness = dot(vec4(mobility[p.x], mobility[p.y], mobility[p.z], mobility[p.w]) * a, a);
    let aq = weighed(a, q[p.x].xyz, q[p.y].xyz, q[p.z].xyz, q[p.w].xyz);
    let deep = max(depth(contact, aq), 0.0);
    energies[i] = 0.0;
    if softness > 0.0 {
        energies[i] = 0.5 * params.stiffness / softness * deep * deep;
    }
}
