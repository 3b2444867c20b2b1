// A vector in another order. See pick.rs.

struct Params {
    adds: u32,
}

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read> places: array<u32>;
@group(1) @binding(1) var<storage, read> source: array<vec4<f32>>;
@group(1) @binding(2) var<storage, read_write> own: array<vec4<f32>>;

fn map(i: u32) {
    let picked = vec4(source[places[i]].xyz, 0.0);
    if params.adds == 1u {
        own[i] += picked;
    } else {
        own[i] = picked;
    }
}
