// A spring between two particles. See spring.rs.

const N = 2u;
const R = 1u;

struct Rest {
    rest: f32,
    stiffness: f32,
}

fn weight(rest: Rest) -> f32 {
    return rest.stiffness;
}

fn column(rest: Rest, slot: u32) -> array<f32, R> {
    return array(select(1.0, -1.0, slot == 0u));
}

fn project(rest: Rest, aq: array<vec3<f32>, R>) -> array<vec3<f32>, R> {
    let length = length3(aq[0]);
    if length > 0.0 {
        return array(aq[0] * (rest.rest / length));
    }
    return array(vec3(0.0));
}

fn block(rest: Rest, q: array<vec3<f32>, N>, slot: u32) -> mat3x3<f32> {
    let d = q[1] - q[0];
    let length = length3(d);
    if length == 0.0 {
        return scalar_block(rest.stiffness);
    }
    let u = d / length;
    let across = max(1.0 - rest.rest / length, 0.0);
    let along = rest.stiffness * (1.0 - across);
    return mat3x3(u * (along * u.x), u * (along * u.y), u * (along * u.z)) + scalar_block(rest.stiffness * across);
}

fn deviation(rest: Rest, q: array<vec3<f32>, N>) -> Deviation {
    let d = q[1] - q[0];
    let length = length3(d);
    var u = vec3(0.0);
    if length > 0.0 {
        u = d / length;
    }
    return Deviation(length - rest.rest, array(-u, u));
}
