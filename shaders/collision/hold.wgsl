// One projection of each contact of a color. See hold.rs.

struct Params {
    compliance: f32,
}

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read> contacts: array<Contact>;
@group(1) @binding(1) var<storage, read> mobility: array<f32>;
@group(1) @binding(2) var<storage, read_write> q: array<vec4<f32>>;
@group(1) @binding(3) var<storage, read_write> lambdas: array<vec4<f32>>;

fn scatter(i: u32) {
    let contact = contacts[i];
    let p = contact.particles;
    let a = contact.weights;
    let w = vec4(mobility[p.x], mobility[p.y], mobility[p.z], mobility[p.w]) * a;
    let softness = dot(w, a);
    if !(softness > 0.0) {
        return;
    }
    let compliance = params.compliance * softness;
    let scale = 1.0 / (softness + compliance);
    let aq = weighed(a, q[p.x].xyz, q[p.y].xyz, q[p.z].xyz, q[p.w].xyz);
    let lambda = lambdas[i];
    let along = max(lambda.w + scale * (depth(contact, aq) - compliance * lambda.w), 0.0);
    let held = lambda.xyz;
    var across = held - (slip(contact, aq) + held * compliance) * scale;
    let most = contact.friction * along;
    let size = length(across);
    if size > most {
        across *= most / size;
    }
    let step = contact.normal * (along - lambda.w) + (across - held);
    lambdas[i] = vec4(across, along);
    for (var slot = 0u; slot < 4u; slot++) {
        if (contact.free & (1u << slot)) != 0u && a[slot] != 0.0 {
            q[p[slot]] += vec4(step * w[slot], 0.0);
        }
    }
}
