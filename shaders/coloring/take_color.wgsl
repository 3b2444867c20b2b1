// One given color for whoever can have it. See take_color.rs.

const UNCOLORED = 0xffffffffu;

struct Params {
    color: u32,
}

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read> offsets: array<u32>;
@group(1) @binding(1) var<storage, read> neighbors: array<u32>;
@group(1) @binding(2) var<storage, read_write> color: array<u32>;

fn update(v: u32) {
    var taken = false;
    for (var e = offsets[v]; e < offsets[v + 1u]; e++) {
        taken |= color[neighbors[e]] == params.color;
    }
    color[v] = select(params.color, UNCOLORED, taken);
}
