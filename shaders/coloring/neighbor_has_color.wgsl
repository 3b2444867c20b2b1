// Luby's exclusion: a vertex leaves the contest for a color that a neighbor has got. See neighbor_has_color.rs.

struct Params {
    color: u32,
}

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read> offsets: array<u32>;
@group(1) @binding(1) var<storage, read> neighbors: array<u32>;
@group(1) @binding(2) var<storage, read> color: array<u32>;
@group(1) @binding(3) var<storage, read_write> weight: array<u32>;

fn select_element(v: u32) -> bool {
    for (var e = offsets[v]; e < offsets[v + 1u]; e++) {
        if color[neighbors[e]] == params.color {
            weight[v] = 0u;
            return true;
        }
    }
    return false;
}
