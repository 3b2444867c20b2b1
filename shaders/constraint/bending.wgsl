// Bending of two triangles that share an edge. See bending.rs.

const N = 4u;
const R = 1u;

struct Rest {
    row: array<f32, 4>,
    rest: f32,
    weight: f32,
}

fn weight(rest: Rest) -> f32 {
    return rest.weight;
}

fn column(rest: Rest, slot: u32) -> array<f32, R> {
    var row = rest.row;
    return array(row[slot]);
}

fn project(rest: Rest, aq: array<vec3<f32>, R>) -> array<vec3<f32>, R> {
    return array(direction(aq[0]) * rest.rest);
}

// As that of a spring of rest length n along K q.
fn block(rest: Rest, q: array<vec3<f32>, N>, slot: u32) -> mat3x3<f32> {
    let aq = apply(rest, q);
    let stiffness = diagonal_entry(rest, slot);
    let length = length3(aq[0]);
    if !(rest.rest > 0.0 && length > 0.0 && length <= MAX) {
        return scalar_block(stiffness);
    }
    let u = direction(aq[0]);
    let across = max(1.0 - rest.rest / length, 0.0);
    let along = stiffness * (1.0 - across);
    return mat3x3(u * (along * u.x), u * (along * u.y), u * (along * u.z)) + scalar_block(stiffness * across);
}

fn deviation(rest: Rest, q: array<vec3<f32>, N>) -> Deviation {
    let aq = apply(rest, q);
    let u = direction(aq[0]);
    let gradient = array(rest.row[0] * u, rest.row[1] * u, rest.row[2] * u, rest.row[3] * u);
    return Deviation(length3(aq[0]) - rest.rest, gradient);
}
