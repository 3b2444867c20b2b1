// Ways that lead into a solid end outside. See keep_out.rs.

@group(1) @binding(0) var<storage, read> q_from: array<vec4<f32>>;
@group(1) @binding(1) var<storage, read> values: array<f32>;
@group(1) @binding(2) var<storage, read_write> q: array<vec4<f32>>;

fn map(i: u32) {
    let first = q_from[i];
    let last = q[i];
    let is_still = all(params.begin == params.end) && all(params.rotations[0] == params.rotations[1]);
    if first.w == 0.0 || (is_still && all(first.xyz == last.xyz)) {
        return;
    }
    let a = local_start(first.xyz);
    let b = local_end(last.xyz);
    let part = first_part_within(a, b, params.distance, 0.0);
    if part < 0.0 {
        return;
    }
    var place = a + part * (b - a);
    let there = seen_from(place);
    let end = seen_from(b);
    if params.slides != 0u && dot(there.normal, end.normal) >= SAME_SIDE {
        if end.distance >= params.distance {
            return;
        }
        place = b + (params.distance - end.distance) * end.normal;
    }
    if params.slides == 0u {
        q[i] = first + part * (last - first);
    } else {
        q[i] = vec4(rotate(params.rotations[1], place) + params.end, last.w);
    }
}
