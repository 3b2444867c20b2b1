// One value for each vertex of the list. See set_value.rs.

struct Params {
    value: u32,
}

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read_write> own: array<u32>;

fn map(v: u32) {
    own[v] = params.value;
}
