// Line 1 of Algorithm 1. See predict.rs.

struct Params {
    h: f32,
}

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read> before: array<vec4<f32>>;
@group(1) @binding(1) var<storage, read> v: array<vec4<f32>>;
@group(1) @binding(2) var<storage, read> a: array<vec4<f32>>;
@group(1) @binding(3) var<storage, read_write> q: array<vec4<f32>>;

fn map(i: u32) {
    let at = before[i];
    q[i] = at;
    if at.w > 0.0 {
        q[i] = vec4(at.xyz + params.h * (v[i].xyz + params.h * a[i].xyz), at.w);
    }
}
