// Boxes around the ways of primitives. See swept_box.rs.

struct Params {
    margin: f32,
}

const ROUNDING = 4.0 * 1.1920929e-7;

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read> primitives: array<vec4<u32>>;
@group(1) @binding(1) var<storage, read> q_from: array<vec4<f32>>;
@group(1) @binding(2) var<storage, read> q_to: array<vec4<f32>>;
@group(1) @binding(3) var<storage, read> drift: array<vec4<f32>>;
@group(1) @binding(4) var<storage, read_write> boxes: array<Aabb>;

fn wider(v: vec4<f32>) -> vec4<f32> {
    return vec4(params.margin) + ROUNDING * abs(v);
}

fn map(i: u32) {
    let ids = primitives[i];
    let first = q_to[ids.x] - drift[0];
    var least = min(q_from[ids.x], first);
    var greatest = max(q_from[ids.x], first);
    for (var k = 1u; k < 4u; k++) {
        let a = q_from[ids[k]];
        let b = q_to[ids[k]] - drift[0];
        least = min(least, min(a, b));
        greatest = max(greatest, max(a, b));
    }
    boxes[i] = Aabb(least - wider(least), greatest + wider(greatest));
}
