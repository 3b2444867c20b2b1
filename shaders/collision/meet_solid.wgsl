// Contacts of particles with a solid. See meet_solid.rs.

@group(1) @binding(0) var<storage, read> q_from: array<vec4<f32>>;
@group(1) @binding(1) var<storage, read> q_to: array<vec4<f32>>;
@group(1) @binding(2) var<storage, read> values: array<f32>;
@group(1) @binding(3) var<storage, read_write> contacts: array<Contact>;

fn select_element(i: u32) -> bool {
    let first = q_from[i];
    if first.w == 0.0 {
        return false;
    }
    let a = local_start(first.xyz);
    let b = local_end(q_to[i].xyz);
    let near = first_part_within(a, b, params.distance + params.margin, 0.0);
    if near < 0.0 {
        return false;
    }
    var point = b;
    var seen = seen_from(b);
    let part = first_part_within(a, b, params.distance, near);
    if part >= 0.0 && part < 1.0 {
        let met = a + part * (b - a);
        let there = seen_from(met);
        if dot(there.normal, seen.normal) < SAME_SIDE {
            point = met;
            seen = there;
        }
    }
    let foot = point - seen.distance * seen.normal;
    let origin = rotate(params.rotations[1], foot) + params.end;
    let begun = rotate(params.rotations[0], foot) + params.begin;
    let moved = origin - begun;
    let normal = rotate(params.rotations[1], seen.normal);
    contacts[i] = Contact(
        vec4(i),
        vec4(1.0, 0.0, 0.0, 0.0),
        normal,
        params.distance,
        first.xyz + moved,
        params.friction,
        origin,
        1u,
    );
    return true;
}
