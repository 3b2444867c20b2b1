// What inertia adds to the objective. See inertia.rs.

struct Params {
    squared_h: f32,
}

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read> predicted: array<vec4<f32>>;
@group(1) @binding(1) var<storage, read> q: array<vec4<f32>>;
@group(1) @binding(2) var<storage, read_write> energies: array<f32>;

fn map(i: u32) {
    let d = q[i].xyz - predicted[i].xyz;
    let w = q[i].w;
    var energy = 0.0;
    if w > 0.0 {
        energy = (d.x * d.x + d.y * d.y + d.z * d.z) / (2.0 * w * params.squared_h);
    }
    energies[i] = energy;
}
