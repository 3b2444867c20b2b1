// From pairs to contacts. See touch.rs.

struct Params {
    thickness: f32,
    margin: f32,
    friction: f32,
    every_pair: u32,
}

const KEPT_AT_REST = 0.5;
const MARGIN_AT_REST = 0.25;
const TOUCHING = 1e-4;

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read> pairs: array<vec4<u32>>;
@group(1) @binding(1) var<storage, read> rest: array<vec4<f32>>;
@group(1) @binding(2) var<storage, read> q_from: array<vec4<f32>>;
@group(1) @binding(3) var<storage, read> q_to: array<vec4<f32>>;
@group(1) @binding(4) var<storage, read_write> contacts: array<Contact>;

fn expand(i: u32) {
    let is_edges = (pairs[i].x & EDGES) != 0u;
    let ids = vec4(pairs[i].x & ~EDGES, pairs[i].yzw);
    let a = q_from[ids.x];
    let b = q_from[ids.y];
    let c = q_from[ids.z];
    let d = q_from[ids.w];
    let free = u32(a.w > 0.0) | (u32(b.w > 0.0) << 1u) | (u32(c.w > 0.0) << 2u) | (u32(d.w > 0.0) << 3u);
    if free == 0u {
        return;
    }
    let start = relative(a.xyz, b.xyz, c.xyz, d.xyz);
    let end = relative(q_to[ids.x].xyz, q_to[ids.y].xyz, q_to[ids.z].xyz, q_to[ids.w].xyz);
    var reach = params.thickness + params.margin;
    if is_clear(is_edges, start, end, reach) {
        return;
    }
    let m = motion(is_edges, start, end);
    var met = first_within(m, reach, 0.0);
    if met.time < 0.0 {
        return;
    }
    let at_rest = length(nearest(is_edges, relative(rest[ids.x].xyz, rest[ids.y].xyz, rest[ids.z].xyz, rest[ids.w].xyz)).separation);
    let distance = min(params.thickness, KEPT_AT_REST * at_rest);
    let near = distance + min(params.margin, MARGIN_AT_REST * at_rest);
    if near < reach {
        reach = near;
        met = first_within(m, reach, met.time);
        if met.time < 0.0 {
            return;
        }
    }
    let within = first_within(m, distance, met.time);
    if within.time >= 0.0 {
        met = within;
    } else {
        let last = nearest_at(m, 1.0);
        if length(last.separation) <= reach {
            met.nearest = last;
        }
    }
    let size = length(met.nearest.separation);
    if !(size > TOUCHING * params.thickness) {
        return;
    }
    if is_edges && params.every_pair == 0u && any(met.nearest.weights == vec4(0.0)) {
        return;
    }
    let place = next_place();
    if place < arrayLength(&contacts) {
        let weights = met.nearest.weights;
        let begun = weighed(weights, a.xyz, b.xyz, c.xyz, d.xyz);
        let normal = met.nearest.separation / size;
        let flags = free | select(0u, BETWEEN_EDGES, is_edges);
        contacts[place] = Contact(ids, weights, normal, distance, begun, params.friction, vec3(0.0), flags);
    }
}
