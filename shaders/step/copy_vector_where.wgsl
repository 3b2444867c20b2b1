// A copy, if the safeguard has decided so. See copy_vector_where.rs.

struct Params {
    is_back: u32,
}

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read> watch: array<Watch>;
@group(1) @binding(1) var<storage, read> source: array<vec4<f32>>;
@group(1) @binding(2) var<storage, read_write> own: array<vec4<f32>>;

fn map(i: u32) {
    if watch[0].is_back == params.is_back {
        own[i] = source[i];
    }
}
