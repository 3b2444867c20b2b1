// Algorithm 2, lines 8-12: a proposal stands unless a neighbor with higher priority drew the same. See accept_color.rs.

const CONFLICT_HASH = 0u;
const CONFLICT_INDEX = 1u;

struct Params {
    key: u32,
    rule: u32,
}

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read> offsets: array<u32>;
@group(1) @binding(1) var<storage, read> neighbors: array<u32>;
@group(1) @binding(2) var<storage, read> proposal: array<u32>;
@group(1) @binding(3) var<storage, read_write> color: array<u32>;

fn loses_to(v: u32, u: u32) -> bool {
    switch params.rule {
        case CONFLICT_HASH: { return hash(u, params.key) > hash(v, params.key); }
        case CONFLICT_INDEX: { return u > v; }
        default: { return true; }
    }
}

fn select_element(v: u32) -> bool {
    let mine = proposal[v];
    for (var e = offsets[v]; e < offsets[v + 1u]; e++) {
        let u = neighbors[e];
        if proposal[u] == mine && loses_to(v, u) {
            return false;
        }
    }
    color[v] = mine;
    return true;
}

// The same where colored vertices are in the list, too.
const UNCOLORED = 0xffffffffu;

fn map(v: u32) {
    if color[v] == UNCOLORED {
        _ = select_element(v);
    }
}
