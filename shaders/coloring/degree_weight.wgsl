// Weight of Largest-Degree-First: degree and one. See degree_weight.rs.

@group(1) @binding(0) var<storage, read> offsets: array<u32>;
@group(1) @binding(1) var<storage, read_write> weight: array<u32>;

fn map(v: u32) {
    weight[v] = offsets[v + 1u] - offsets[v] + 1u;
}
