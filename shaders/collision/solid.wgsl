// Solids that particles stay out of. See solid.rs.

struct Solid {
    rotations: array<vec4<f32>, 2>,
    begin: vec3<f32>,
    shape: u32,
    end: vec3<f32>,
    friction: f32,
    size: vec3<f32>,
    slope: f32,
    least: vec3<f32>,
    spacing: f32,
    nodes: vec3<u32>,
    slides: u32,
    distance: f32,
    margin: f32,
    padding: vec2<u32>,
}

const SAME_SIDE = 0.5;
const MAX_STEPS = 256u;
const Y = vec3<f32>(0.0, 1.0, 0.0);

struct Seen {
    distance: f32,
    normal: vec3<f32>,
}

@group(0) @binding(3) var<uniform> params: Solid;

fn direction(v: vec3<f32>, otherwise: vec3<f32>) -> vec3<f32> {
    let size = length(v);
    if size > 0.0 {
        return v / size;
    }
    return otherwise;
}

fn rotate(rotation: vec4<f32>, v: vec3<f32>) -> vec3<f32> {
    let across = cross(rotation.xyz, v);
    return v + 2.0 * (rotation.w * across + cross(rotation.xyz, across));
}

// A place at the start of the frame, or at its end, in the solid's own coordinates.
fn local_start(place: vec3<f32>) -> vec3<f32> {
    return rotate(params.rotations[0] * vec4(-1.0, -1.0, -1.0, 1.0), place - params.begin);
}

fn local_end(place: vec3<f32>) -> vec3<f32> {
    return rotate(params.rotations[1] * vec4(-1.0, -1.0, -1.0, 1.0), place - params.end);
}

fn around(core: vec3<f32>) -> Seen {
    return Seen(length(core) - params.size.x, direction(core, Y));
}

fn cuboid(point: vec3<f32>) -> Seen {
    let beyond = abs(point) - params.size;
    let sides = select(vec3(1.0), vec3(-1.0), point < vec3(0.0));
    let outside = max(beyond, vec3(0.0));
    if any(outside != vec3(0.0)) {
        return Seen(length(outside), direction(sides * outside, Y));
    }
    if beyond.x >= beyond.y && beyond.x >= beyond.z {
        return Seen(beyond.x, vec3(sides.x, 0.0, 0.0));
    }
    if beyond.y >= beyond.z {
        return Seen(beyond.y, vec3(0.0, sides.y, 0.0));
    }
    return Seen(beyond.z, vec3(0.0, 0.0, sides.z));
}

fn lerp(a: f32, b: f32, t: f32) -> f32 {
    return a + t * (b - a);
}

fn field(point: vec3<f32>) -> Seen {
    let last = vec3<f32>(params.nodes - 1u);
    let at = (point - params.least) / params.spacing;
    let clamped = min(max(at, vec3(0.0)), last);
    let cell = min(floor(clamped), last - 1.0);
    let f = clamped - cell;
    let c = vec3<u32>(cell);
    let first = (c.z * params.nodes.y + c.y) * params.nodes.x + c.x;
    let y = params.nodes.x;
    let z = params.nodes.x * params.nodes.y;
    let even = vec4(values[first], values[first + y], values[first + z], values[first + z + y]);
    let odd = vec4(values[first + 1u], values[first + y + 1u], values[first + z + 1u], values[first + z + y + 1u]);
    let d = odd - even;
    let x = even + f.x * d;
    let low = lerp(x.x, x.y, f.y);
    let high = lerp(x.z, x.w, f.y);
    let value = lerp(low, high, f.z);
    let gradient = vec3(
        lerp(lerp(d.x, d.y, f.y), lerp(d.z, d.w, f.y), f.z),
        lerp(x.y - x.x, x.w - x.z, f.z),
        high - low,
    );
    let normal = direction(gradient, Y);
    let beyond = params.spacing * (at - clamped);
    let away = length(beyond);
    if away == 0.0 {
        return Seen(value, normal);
    }
    return Seen(max(away, value - away), direction(value * normal + beyond, normal));
}

fn seen_from(point: vec3<f32>) -> Seen {
    switch params.shape {
        case 0u: { return Seen(point.y, Y); }
        case 1u: { return around(point); }
        case 2u: { return around(point - Y * clamp(point.y, -params.size.y, params.size.y)); }
        case 3u: { return cuboid(point); }
        default: { return field(point); }
    }
}

// Where the way is first within `level`; below 0 if nowhere.
fn first_part_within(a: vec3<f32>, b: vec3<f32>, level: f32, begin: f32) -> f32 {
    let speed = length(b - a) * params.slope;
    var part = begin;
    for (var k = 0u; k < MAX_STEPS; k++) {
        let left = seen_from(a + part * (b - a)).distance - level;
        if left <= 0.0 {
            return part;
        }
        let to_go = (1.0 - part) * speed;
        if left >= to_go {
            return -1.0;
        }
        let step = max(left, 0.1 * level);
        if step >= to_go {
            return select(-1.0, 1.0, seen_from(b).distance <= level);
        }
        part += step / speed;
    }
    return part;
}
