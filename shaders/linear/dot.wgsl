// Dot products of x, y and z at once, in a fixed order. See dot.rs.

struct Params {
    first: u32,
    n_sums: u32,
    n_numbers: u32,
}

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read> a: array<vec4<f32>>;
@group(1) @binding(1) var<storage, read> b: array<vec4<f32>>;
@group(1) @binding(2) var<storage, read> c: array<vec4<f32>>;
@group(1) @binding(3) var<storage, read_write> own: array<Pair>;

fn map(i: u32) {
    var sum = Pair(vec4(0.0), vec4(0.0));
    for (var k = i - params.first; k < params.n_numbers; k += params.n_sums) {
        sum.first += a[k] * b[k];
        sum.second += a[k] * c[k];
    }
    own[i] = sum;
}
