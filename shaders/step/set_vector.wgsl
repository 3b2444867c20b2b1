// The same vector everywhere. See set_vector.rs.

struct Params {
    value: vec4<f32>,
}

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read_write> own: array<vec4<f32>>;

fn map(i: u32) {
    own[i] = params.value;
}
