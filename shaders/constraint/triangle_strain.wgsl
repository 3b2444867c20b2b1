// A triangle whose strain is limited. See triangle_strain.rs.

const N = 3u;
const R = 2u;

struct Rest {
    columns: array<array<f32, 2>, 3>,
    weight: f32,
    limit: f32,
}

fn weight(rest: Rest) -> f32 {
    return rest.weight;
}

fn column(rest: Rest, slot: u32) -> array<f32, R> {
    var columns = rest.columns;
    return columns[slot];
}

fn limited(rest: Rest, sigma: f32) -> f32 {
    return max(min(sigma, 1.0 + rest.limit), 1.0 - rest.limit);
}

// F = U diag(sigma) transpose(V), where V turns by `turn`: (cosine, sine).
struct Singular {
    u: array<vec3<f32>, 2>,
    sigma: vec2<f32>,
    turn: vec2<f32>,
}

fn singular(aq: array<vec3<f32>, R>) -> Singular {
    let turn = jacobi(aq[0], aq[1]);
    let a = turn.x * aq[0] - turn.y * aq[1];
    let b = turn.y * aq[0] + turn.x * aq[1];
    var u: array<vec3<f32>, 2>;
    if dot3(a, a) >= dot3(b, b) {
        u = frame(a, b);
    } else {
        let swapped = frame(b, a);
        u = array(swapped[1], swapped[0]);
    }
    return Singular(u, vec2(length3(a), length3(b)), turn);
}

fn project(rest: Rest, aq: array<vec3<f32>, R>) -> array<vec3<f32>, R> {
    let found = singular(aq);
    let clamped = vec2(limited(rest, found.sigma.x), limited(rest, found.sigma.y));
    if all(clamped == found.sigma) {
        return aq;
    }
    let x = found.u[0] * clamped.x;
    let y = found.u[1] * clamped.y;
    return array(found.turn.x * x + found.turn.y * y, found.turn.x * y - found.turn.y * x);
}

struct Stretch {
    rotation: array<vec3<f32>, R>,
    excess: vec3<f32>,
}

// R of F = R U, and by how much U is too much.
fn stretch(rest: Rest, aq: array<vec3<f32>, R>) -> Stretch {
    let found = singular(aq);
    let u = found.u[0];
    let v = found.u[1];
    let c = found.turn.x;
    let s = found.turn.y;
    let a = found.sigma.x - limited(rest, found.sigma.x);
    let b = found.sigma.y - limited(rest, found.sigma.y);
    let excess = vec3(a * (c * c) + b * (s * s), a * (s * s) + b * (c * c), (b - a) * c * s);
    return Stretch(array(c * u + s * v, c * v - s * u), excess);
}
