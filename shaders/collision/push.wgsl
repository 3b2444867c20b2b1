// What contacts do, as forces. See push.rs.

struct Params {
    scale: f32,
}

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read> contacts: array<Contact>;
@group(1) @binding(1) var<storage, read_write> forces: array<vec4<f32>>;
@group(1) @binding(2) var<storage, read_write> lambdas: array<vec4<f32>>;

fn scatter(i: u32) {
    let contact = contacts[i];
    let lambda = lambdas[i];
    let force = (contact.normal * lambda.w + lambda.xyz) * params.scale;
    for (var slot = 0u; slot < 4u; slot++) {
        let a = contact.weights[slot];
        if (contact.free & (1u << slot)) != 0u && a != 0.0 {
            forces[contact.particles[slot]] += vec4(force * a, 0.0);
        }
    }
}
