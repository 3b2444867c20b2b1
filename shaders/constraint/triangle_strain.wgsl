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

fn project(rest: Rest, aq: array<vec3<f32>, R>) -> array<vec3<f32>, R> {
    let turn = jacobi(aq[0], aq[1]);
    let a = turn.x * aq[0] - turn.y * aq[1];
    let b = turn.y * aq[0] + turn.x * aq[1];
    let sigma = vec2(length3(a), length3(b));
    let clamped = vec2(limited(rest, sigma.x), limited(rest, sigma.y));
    if all(clamped == sigma) {
        return aq;
    }
    var u: array<vec3<f32>, 2>;
    if dot3(a, a) >= dot3(b, b) {
        u = frame(a, b);
    } else {
        let swapped = frame(b, a);
        u = array(swapped[1], swapped[0]);
    }
    let x = u[0] * clamped.x;
    let y = u[1] * clamped.y;
    return array(turn.x * x + turn.y * y, turn.x * y - turn.y * x);
}
