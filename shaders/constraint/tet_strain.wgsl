// A tetrahedron that keeps its shape. See tet_strain.rs.

const N = 4u;
const R = 3u;

struct Rest {
    columns: array<array<f32, 3>, 4>,
    weight: f32,
}

fn weight(rest: Rest) -> f32 {
    return rest.weight;
}

fn column(rest: Rest, slot: u32) -> array<f32, R> {
    var columns = rest.columns;
    return columns[slot];
}

fn project(rest: Rest, aq: array<vec3<f32>, R>) -> array<vec3<f32>, R> {
    let r = rotation(mat3x3(aq[0], aq[1], aq[2]));
    return array(r[0], r[1], r[2]);
}

// w (I − Σ λ_k t_k t_kᵀ) for each direction of motion, of which the twists t_k yield.
fn block(rest: Rest, q: array<vec3<f32>, N>, slot: u32) -> mat3x3<f32> {
    let f = apply(rest, q);
    let s = svd(mat3x3(f[0], f[1], f[2]));
    let of_slot = column(rest, slot);
    let a = vec3(of_slot[0], of_slot[1], of_slot[2]);
    let along = times(transpose(s.v), a);
    var yielding = scalar_block(dot3(a, a));
    yielding -= twist(s.u[0] * along.y - s.u[1] * along.x, s.sigma.x + s.sigma.y);
    yielding -= twist(s.u[0] * along.z - s.u[2] * along.x, s.sigma.x + s.sigma.z);
    yielding -= twist(s.u[1] * along.z - s.u[2] * along.y, s.sigma.y + s.sigma.z);
    return yielding * rest.weight;
}

fn twist(t: vec3<f32>, sum: f32) -> mat3x3<f32> {
    let half = 1.0 / max(sum, 2.0);
    return mat3x3(t * (half * t.x), t * (half * t.y), t * (half * t.z));
}
