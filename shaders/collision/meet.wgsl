// Which boxes meet: down a tree, without a stack. See meet.rs.

struct Params {
    n_triangles: u32,
    n_edges: u32,
    padding: vec2<u32>,
    levels: array<vec4<u32>, 6>,
}

const CHILDREN = 8u;
const EDGES = 0x80000000u;

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read> primitives: array<vec4<u32>>;
@group(1) @binding(1) var<storage, read> boxes: array<Aabb>;
@group(1) @binding(2) var<storage, read_write> pairs: array<vec4<u32>>;

fn emit(pair: vec4<u32>) {
    let place = next_place();
    if place < arrayLength(&pairs) {
        pairs[place] = pair;
    }
}

// Where a level of the triangles' tree begins, or of the edges'.
fn level_start(is_edges: bool, level: u32) -> u32 {
    let k = select(level, level + 12u, is_edges);
    return params.levels[k / 4u][k % 4u];
}

fn level_len(n: u32, level: u32) -> u32 {
    return ((n - 1u) >> (3u * level)) + 1u;
}

fn meets(one: Aabb, other: Aabb) -> bool {
    return all(one.least.xyz <= other.greatest.xyz) && all(other.least.xyz <= one.greatest.xyz);
}

fn found(i: u32, is_edges: bool, leaf: u32) {
    let own = primitives[i];
    if is_edges {
        let other = primitives[params.n_triangles + leaf];
        if own.x != other.x && own.x != other.y && own.y != other.x && own.y != other.y {
            emit(vec4(own.x | EDGES, own.y, other.xy));
        }
    } else {
        let corners = primitives[leaf];
        if own.x != corners.x && own.x != corners.y && own.x != corners.z {
            emit(vec4(own.x, corners.xyz));
        }
    }
}

fn expand(i: u32) {
    let is_edges = i < params.n_triangles + params.n_edges;
    let n = select(params.n_triangles, params.n_edges, is_edges);
    if n == 0u {
        return;
    }
    let own = boxes[i];
    var level = 0u;
    var at = i - params.n_triangles;
    if !is_edges {
        at = 0u;
        while level_len(n, level) > 1u {
            level++;
        }
    }
    loop {
        if meets(own, boxes[level_start(is_edges, level) + at]) {
            if level > 0u {
                level--;
                at *= CHILDREN;
                continue;
            }
            found(i, is_edges, at);
        }
        while at % CHILDREN == CHILDREN - 1u || at + 1u == level_len(n, level) {
            if level_len(n, level) == 1u {
                return;
            }
            at /= CHILDREN;
            level++;
        }
        at++;
    }
}
