// What acts on a particle from outside. See blow.rs.

struct Params {
    gravity: vec3<f32>,
    h: f32,
    velocity: vec3<f32>,
    sixth_of_drag: f32,
    skin: f32,
}

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read> offsets: array<u32>;
@group(1) @binding(1) var<storage, read> corners: array<array<u32, 3>>;
@group(1) @binding(2) var<storage, read> q: array<vec4<f32>>;
@group(1) @binding(3) var<storage, read> v: array<vec4<f32>>;
@group(1) @binding(4) var<storage, read_write> accelerations: array<vec4<f32>>;

fn map(i: u32) {
    var diagonal = vec3(0.0);
    var off = vec3(0.0);
    for (var k = offsets[i]; k < offsets[i + 1u]; k++) {
        let a = q[corners[k][0]].xyz;
        let twice_area = cross3(q[corners[k][1]].xyz - a, q[corners[k][2]].xyz - a);
        let length = length3(twice_area);
        if length > 0.0 {
            let n = twice_area / length;
            let third = params.sixth_of_drag * length;
            let across = third * (1.0 - params.skin);
            diagonal += n * n * across + vec3(third * params.skin);
            off += vec3(n.y * n.z, n.z * n.x, n.x * n.y) * across;
        }
    }
    var acceleration = params.gravity;
    let w = q[i].w;
    if w > 0.0 && any(diagonal != vec3(0.0)) {
        diagonal *= w;
        off *= w;
        let relative = params.velocity - (v[i].xyz + params.h * params.gravity);
        let push = multiplied(diagonal, off, relative);
        acceleration += solved(diagonal * params.h + vec3(1.0), off * params.h, push, vec3(0.0));
    }
    accelerations[i] = vec4(acceleration, 0.0);
}
