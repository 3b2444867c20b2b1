// A tetrahedron that keeps its volume, within a range. See tet_volume.rs.

const N = 4u;
const R = 3u;

// 1/√3.
const SCALE = 0.57735026f;

struct Rest {
    columns: array<array<f32, 3>, 4>,
    weight: f32,
    range: array<f32, 2>,
    edges: array<f32, 2>,
    inverse_det: f32,
}

fn weight(rest: Rest) -> f32 {
    return rest.weight;
}

fn column(rest: Rest, slot: u32) -> array<f32, R> {
    var columns = rest.columns;
    return columns[slot];
}

// The determinant nearest to `det` in the range.
fn nearest_det(rest: Rest, det: f32) -> f32 {
    return max(min(det, rest.range[1]), rest.range[0]);
}

// The larger two values at x, and their roots.
fn larger(sigma: vec3<f32>, x: f32) -> vec4<f32> {
    let m4 = 4.0 * x * (x - sigma.z);
    let r0 = sqrt(max(sigma.x * sigma.x + m4, 0.0));
    let r1 = sqrt(max(sigma.y * sigma.y + m4, 0.0));
    return vec4(0.5 * (sigma.x + r0), 0.5 * (sigma.y + r1), r0, r1);
}

fn nearest_with_product(given: vec3<f32>, edge: f32) -> vec3<f32> {
    let scale = max(given.x, edge);
    let root = edge / scale;
    let sigma = given / scale;
    let wanted = root * root * root;
    let is_large = sigma.x * sigma.y * sigma.z > wanted;
    var low = select(max(sigma.z, 0.0), 0.0, is_large);
    var high = select(root, sigma.z, is_large);
    var x = select(0.5 * (low + high), high, is_large);
    for (var k = 0u; k < 40u; k++) {
        let s = larger(sigma, x);
        let error = s.x * s.y * x - wanted;
        if abs(error) <= 2e-7f * wanted {
            break;
        }
        if error > 0.0 {
            high = x;
        } else {
            low = x;
        }
        let slope = s.x * s.y + s.x * s.y * x * (2.0 * x - sigma.z) * (1.0 / (s.x * s.z) + 1.0 / (s.y * s.w));
        let next = x - error / slope;
        x = 0.5 * (low + high);
        if next > low && next < high {
            // Where a comparison takes what is not a number for one, this does not.
            x = clamp(next, low, high);
        }
    }
    let s = larger(sigma, x);
    let s2 = select(x, wanted / (s.x * s.y), s.x * s.y > 0.0);
    return vec3(s.x, s.y, s2) * scale;
}

fn project(rest: Rest, aq: array<vec3<f32>, R>) -> array<vec3<f32>, R> {
    let f = mat3x3(aq[0], aq[1], aq[2]);
    let det = stable_determinant(f);
    let nearest = nearest_det(rest, det);
    if det == nearest {
        return aq;
    }
    let edge = select(rest.edges[1], rest.edges[0], det < nearest);
    let found = of_determinant(f, det, edge);
    if found.is_settled {
        return array(found.p[0], found.p[1], found.p[2]);
    }
    let s = svd(f);
    let sigma = nearest_with_product(s.sigma, edge);
    let p = product(mat3x3(s.u[0] * sigma.x, s.u[1] * sigma.y, s.u[2] * sigma.z), transpose(s.v));
    return array(p[0], p[1], p[2]);
}

// C = (det F − t)/√3; inside the range it and its gradient are 0.
fn deviation(rest: Rest, q: array<vec3<f32>, N>) -> Deviation {
    let x = q[1] - q[0];
    let y = q[2] - q[0];
    let z = q[3] - q[0];
    let yz = cross3(y, z);
    let zx = cross3(z, x);
    let xy = cross3(x, y);
    let det = dot3(x, yz) * rest.inverse_det;
    if det > rest.range[0] && det < rest.range[1] {
        return Deviation();
    }
    let scale = SCALE * rest.inverse_det;
    let b = yz * scale;
    let c = zx * scale;
    let d = xy * scale;
    return Deviation((det - nearest_det(rest, det)) * SCALE, array(-(b + c + d), b, c, d));
}
