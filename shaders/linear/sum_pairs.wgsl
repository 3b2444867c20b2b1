// Sums of many pairs of vectors, in a fixed order. See sum_pairs.rs.

struct Params {
    first: u32,
    n_sums: u32,
    n_numbers: u32,
}

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read> pairs: array<Pair>;
@group(1) @binding(1) var<storage, read_write> own: array<Pair>;

fn map(i: u32) {
    var sum = Pair(vec4(0.0), vec4(0.0));
    for (var k = i - params.first; k < params.n_numbers; k += params.n_sums) {
        sum.first += pairs[k].first;
        sum.second += pairs[k].second;
    }
    own[i] = sum;
}
