// Random weights of Luby and of Jones and Plassmann: a permutation of the vertices, by hash. See random_weight.rs.

struct Params {
    key: u32,
}

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read_write> weight: array<u32>;

fn map(v: u32) {
    weight[v] = max(hash(v, params.key), 1u);
}
