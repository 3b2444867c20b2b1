// What contacts ask of a sweep over the rows of Y. See push.rs.

struct Params {
    scale: f32,
}

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read> contacts: array<Contact>;
@group(1) @binding(1) var<storage, read> lambdas: array<vec4<f32>>;
@group(1) @binding(2) var<storage, read_write> anchors: array<vec4<f32>>;
@group(1) @binding(3) var<storage, read_write> pushed: array<vec4<f32>>;

fn scatter(i: u32) {
    let contact = contacts[i];
    let change = lambdas[i] - pushed[i];
    let step = (contact.normal * change.w + change.xyz) * params.scale;
    pushed[i] = lambdas[i];
    for (var slot = 0u; slot < 4u; slot++) {
        let a = contact.weights[slot];
        if (contact.free & (1u << slot)) != 0u && a != 0.0 {
            let particle = contact.particles[slot];
            anchors[particle] += vec4(step * (a / anchors[particle].w), 0.0);
        }
    }
}
