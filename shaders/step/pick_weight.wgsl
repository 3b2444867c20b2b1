// The weights of the iterations until the next look. See pick_weight.rs.

struct Params {
    k: u32,
    stride: u32,
    n: u32,
}

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read> watch: array<Watch>;
@group(1) @binding(1) var<storage, read> table: array<Weight>;
@group(1) @binding(2) var<storage, read_write> own: array<Weight>;

fn map(i: u32) {
    let k = min(params.k + i / params.stride - watch[0].began_at, params.n - 1u);
    own[i] = table[watch[0].level * params.n + k];
}
