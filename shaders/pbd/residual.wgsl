// The gradient of the objective, squared. See residual.rs.

struct Params {
    squared_h: f32,
}

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read> predicted: array<vec4<f32>>;
@group(1) @binding(1) var<storage, read> q: array<vec4<f32>>;
@group(1) @binding(2) var<storage, read> gradients: array<vec4<f32>>;
@group(1) @binding(3) var<storage, read_write> squared: array<f32>;

fn map(i: u32) {
    let w = q[i].w;
    var sum = 0.0;
    if w > 0.0 {
        let g = (q[i].xyz - predicted[i].xyz) / (w * params.squared_h) + gradients[i].xyz;
        sum = g.x * g.x + g.y * g.y + g.z * g.z;
    }
    squared[i] = sum;
}
