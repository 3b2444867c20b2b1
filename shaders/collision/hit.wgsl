// The guard: which pairs would pass. See hit.rs.

struct Params {
    gap: f32,
    gap_of_start: f32,
    floor: f32,
    stays: u32,
    n: u32,
}

const KEPT = 0.99;

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read> pairs: array<vec4<u32>>;
@group(1) @binding(1) var<storage, read> q_from: array<vec4<f32>>;
@group(1) @binding(2) var<storage, read> q_to: array<vec4<f32>>;
@group(1) @binding(3) var<storage, read_write> lowest: array<atomic<u32>>;

fn lower(i: u32) {
    let is_edges = (pairs[i].x & EDGES) != 0u;
    let ids = vec4(pairs[i].x & ~EDGES, pairs[i].yzw);
    let start = relative(q_from[ids.x].xyz, q_from[ids.y].xyz, q_from[ids.z].xyz, q_from[ids.w].xyz);
    let end = relative(q_to[ids.x].xyz, q_to[ids.y].xyz, q_to[ids.z].xyz, q_to[ids.w].xyz);
    let m = motion(is_edges, start, end);
    if m.speed == 0.0 || is_clear(is_edges, start, end, params.gap) {
        return;
    }
    let axis = nearest_at(m, 0.0).separation;
    let apart = length(axis);
    if apart <= 0.0 {
        return;
    }
    var time = 0.0;
    if apart < params.floor {
        if !(gap_along(is_edges, axis, end) < KEPT * gap_along(is_edges, axis, start)) {
            return;
        }
    } else {
        time = first_within(m, min(params.gap, params.gap_of_start * apart), 0.0).time;
        if time < 0.0 {
            return;
        }
    }
    let part = select(bitcast<u32>(time), 0u, params.stays != 0u);
    for (var k = 0u; k < 4u; k++) {
        lower_to(ids[k], part);
        lower_to(params.n + 1u + ids[k], 0u);
    }
    lower_to(params.n, 0u);
}
