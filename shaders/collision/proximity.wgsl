// How near two primitives are, and when. See proximity.rs.

const EDGES = 0x80000000u;
const FLAT = 1e-12;
const MAX_STEPS = 256u;
const UNDERCUT = 0.05;
const LARGEST = 3.40282e38;

// Points relative to the first.
struct Points {
    b: vec3<f32>,
    c: vec3<f32>,
    d: vec3<f32>,
}

struct Nearest {
    weights: vec4<f32>,
    separation: vec3<f32>,
}

fn nearest_of(weights: vec4<f32>, x: Points) -> Nearest {
    return Nearest(weights, weights.y * x.b + weights.z * x.c + weights.w * x.d);
}

fn ratio(numerator: f32, denominator: f32) -> f32 {
    if denominator > 0.0 {
        return clamp(numerator / denominator, 0.0, 1.0);
    }
    return 0.0;
}

fn foot(a: vec3<f32>, b: vec3<f32>) -> f32 {
    let ab = b - a;
    return ratio(-dot(a, ab), dot(ab, ab));
}

fn point_triangle(x: Points) -> Nearest {
    let a = x.b;
    let ab = x.c - a;
    let ac = x.d - a;
    let normal = cross(ab, ac);
    let area = dot(normal, normal);
    let is_flat = area <= FLAT * dot(ab, ab) * dot(ac, ac);
    let v = dot(cross(ac, a), normal);
    let w = dot(cross(a, ab), normal);
    let u = area - v - w;
    if !is_flat && u >= 0.0 && v >= 0.0 && w >= 0.0 {
        return nearest_of(vec4(1.0, -u / area, -v / area, -w / area), x);
    }
    var best = nearest_of(vec4(1.0, -1.0, 0.0, 0.0), x);
    var least = LARGEST;
    if is_flat || w < 0.0 {
        let t = foot(x.b, x.c);
        let side = nearest_of(vec4(1.0, t - 1.0, -t, 0.0), x);
        let squared = dot(side.separation, side.separation);
        if squared < least {
            best = side;
            least = squared;
        }
    }
    if is_flat || u < 0.0 {
        let t = foot(x.c, x.d);
        let side = nearest_of(vec4(1.0, 0.0, t - 1.0, -t), x);
        let squared = dot(side.separation, side.separation);
        if squared < least {
            best = side;
            least = squared;
        }
    }
    if is_flat || v < 0.0 {
        let t = foot(x.d, x.b);
        let side = nearest_of(vec4(1.0, -t, 0.0, t - 1.0), x);
        if dot(side.separation, side.separation) < least {
            best = side;
        }
    }
    return best;
}

fn edge_edge(x: Points) -> Nearest {
    let v = x.d - x.c;
    let uu = dot(x.b, x.b);
    let vv = dot(v, v);
    let uv = dot(x.b, v);
    let ur = -dot(x.b, x.c);
    let vr = -dot(v, x.c);
    var s = ratio(uv * vr - ur * vv, uu * vv - uv * uv);
    var t = 0.0;
    if vv > 0.0 {
        t = (uv * s + vr) / vv;
    }
    if vv <= 0.0 || t < 0.0 || t > 1.0 {
        t = clamp(t, 0.0, 1.0);
        s = ratio(t * uv - ur, uu);
    }
    return nearest_of(vec4(1.0 - s, s, t - 1.0, -t), x);
}

fn nearest(is_edges: bool, x: Points) -> Nearest {
    if is_edges {
        return edge_edge(x);
    }
    return point_triangle(x);
}

fn gap_along(is_edges: bool, axis: vec3<f32>, x: Points) -> f32 {
    let a = dot(axis, x.b);
    let b = dot(axis, x.c);
    let c = dot(axis, x.d);
    if is_edges {
        return min(a, 0.0) - max(b, c);
    }
    return -max(max(a, b), c);
}

fn is_clear(is_edges: bool, start: Points, end: Points, reach: f32) -> bool {
    var axis = -(start.b + start.c + start.d);
    if is_edges {
        axis = start.b - (start.c + start.d);
    }
    let least = reach * length(axis);
    return gap_along(is_edges, axis, start) > least && gap_along(is_edges, axis, end) > least;
}

fn relative(a: vec3<f32>, b: vec3<f32>, c: vec3<f32>, d: vec3<f32>) -> Points {
    return Points(b - a, c - a, d - a);
}

struct Motion {
    is_edges: bool,
    start: Points,
    end: Points,
    speed: f32,
}

fn motion(is_edges: bool, start: Points, end: Points) -> Motion {
    let b = end.b - start.b;
    let c = end.c - start.c;
    let d = end.d - start.d;
    let mean = 0.25 * (b + c + d);
    let squared = vec4(dot(mean, mean), dot(b - mean, b - mean), dot(c - mean, c - mean), dot(d - mean, d - mean));
    let second = max(squared.z, squared.w);
    var speed = sqrt(squared.x) + sqrt(max(squared.y, second));
    if is_edges {
        speed = sqrt(max(squared.x, squared.y)) + sqrt(second);
    }
    return Motion(is_edges, start, end, speed);
}

fn nearest_at(m: Motion, time: f32) -> Nearest {
    let b = m.start.b + time * (m.end.b - m.start.b);
    let c = m.start.c + time * (m.end.c - m.start.c);
    let d = m.start.d + time * (m.end.d - m.start.d);
    return nearest(m.is_edges, Points(b, c, d));
}

// When a pair comes near, and how it lies then; `time` is below 0 if it does not.
struct Met {
    time: f32,
    nearest: Nearest,
}

fn first_within(m: Motion, reach: f32, begin: f32) -> Met {
    var time = begin;
    for (var k = 0u; k < MAX_STEPS; k++) {
        let found = nearest_at(m, time);
        let left = length(found.separation) - reach;
        if left <= 0.0 {
            return Met(time, found);
        }
        let to_go = (1.0 - time) * m.speed;
        if left >= to_go {
            return Met(-1.0, found);
        }
        let step = max(left, UNDERCUT * reach);
        if step >= to_go {
            let last = nearest_at(m, 1.0);
            if length(last.separation) <= reach {
                return Met(1.0, last);
            }
            return Met(-1.0, last);
        }
        time += step / m.speed;
    }
    return Met(time, nearest_at(m, time));
}
