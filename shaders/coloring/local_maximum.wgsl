// Vertices heavier than every contending neighbor; each remembers to whom it lost last. See local_maximum.rs.

struct Params {
    key: u32,
}

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read> offsets: array<u32>;
@group(1) @binding(1) var<storage, read> neighbors: array<u32>;
@group(1) @binding(2) var<storage, read> weight: array<u32>;
@group(1) @binding(3) var<storage, read_write> lost_to: array<u32>;

fn is_heavier(u: u32, v: u32) -> bool {
    let other = weight[u];
    let mine = weight[v];
    return other > mine || (other == mine && hash(u, params.key) > hash(v, params.key));
}

fn select_element(v: u32) -> bool {
    let last = lost_to[v];
    if last < arrayLength(&weight) && is_heavier(last, v) {
        return false;
    }
    for (var e = offsets[v]; e < offsets[v + 1u]; e++) {
        let u = neighbors[e];
        if is_heavier(u, v) {
            lost_to[v] = u;
            return false;
        }
    }
    return true;
}
