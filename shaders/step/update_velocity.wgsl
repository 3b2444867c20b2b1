// Line 9 of Algorithm 1. See update_velocity.rs.

struct Params {
    scale: f32,
}

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read> after: array<vec4<f32>>;
@group(1) @binding(1) var<storage, read> before: array<vec4<f32>>;
@group(1) @binding(2) var<storage, read_write> v: array<vec4<f32>>;

fn map(i: u32) {
    v[i] = vec4((after[i].xyz - before[i].xyz) * params.scale, 0.0);
}
