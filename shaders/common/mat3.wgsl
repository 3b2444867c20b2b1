// Singular values and nearest rotations of 3 × 3 matrices. See mat3.rs.

const SWEEPS = 12u;
const ORTHOGONAL = 2e-7f;

struct Svd {
    u: mat3x3<f32>,
    sigma: vec3<f32>,
    v: mat3x3<f32>,
}

fn times(m: mat3x3<f32>, x: vec3<f32>) -> vec3<f32> {
    return m[0] * x.x + m[1] * x.y + m[2] * x.z;
}

fn product(a: mat3x3<f32>, b: mat3x3<f32>) -> mat3x3<f32> {
    return mat3x3(times(a, b[0]), times(a, b[1]), times(a, b[2]));
}

fn largest_entry(f: mat3x3<f32>) -> f32 {
    let largest = max(max(abs(f[0]), abs(f[1])), abs(f[2]));
    return max(max(largest.x, largest.y), largest.z);
}

// Cosine and sine of the rotation that makes `a` and `b` orthogonal; 1 and 0 if they are.
fn jacobi(a: vec3<f32>, b: vec3<f32>) -> vec2<f32> {
    let aa = dot3(a, a);
    let bb = dot3(b, b);
    let ab = dot3(a, b);
    if !(ab * ab > ORTHOGONAL * ORTHOGONAL * aa * bb) {
        return vec2(1.0, 0.0);
    }
    let zeta = (bb - aa) / (2.0 * ab);
    let sign = select(-1.0, 1.0, (bb >= aa) == (ab > 0.0));
    let t = sign / (abs(zeta) + sqrt(1.0 + zeta * zeta));
    let c = 1.0 / sqrt(1.0 + t * t);
    return vec2(c, c * t);
}

fn rotate(a: ptr<function, array<vec3<f32>, 3>>, p: u32, q: u32, turn: vec2<f32>) {
    let x = (*a)[p];
    let y = (*a)[q];
    (*a)[p] = turn.x * x - turn.y * y;
    (*a)[q] = turn.y * x + turn.x * y;
}

// Whether the length of `v` has digits left in its square.
fn has_direction(v: vec3<f32>) -> bool {
    let squared = dot3(v, v);
    return squared >= 1e-30f && squared <= MAX;
}

fn normalized(v: vec3<f32>) -> vec3<f32> {
    return v * (1.0 / length3(v));
}

// Some unit vector across the unit vector `u` (Duff et al. 2017).
fn any_orthonormal(u: vec3<f32>) -> vec3<f32> {
    let sign = select(1.0, -1.0, (bitcast<u32>(u.z) >> 31u) == 1u);
    let a = -1.0 / (sign + u.z);
    let b = u.x * u.y * a;
    return vec3(b, sign + u.y * u.y * a, -u.y);
}

// Orthogonal unit vectors along `a` and `b`, of which `a` is the longer; any where there is no direction.
fn frame(a: vec3<f32>, b: vec3<f32>) -> array<vec3<f32>, 2> {
    var u0 = vec3(1.0, 0.0, 0.0);
    if has_direction(a) {
        u0 = normalized(a);
    }
    let across = b - u0 * dot3(u0, b);
    var u1: vec3<f32>;
    if has_direction(across) && dot3(across, across) > 0.25 * dot3(b, b) {
        u1 = normalized(across);
        u1 = u1 - u0 * dot3(u0, u1);
    } else {
        u1 = any_orthonormal(u0);
    }
    return array(u0, u1);
}

fn svd(f: mat3x3<f32>) -> Svd {
    let scale = largest_entry(f);
    if !(scale > 0.0 && scale <= MAX) {
        let unit = mat3x3(vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0), vec3(0.0, 0.0, 1.0));
        return Svd(unit, vec3(0.0), unit);
    }
    var a = array(f[0] / scale, f[1] / scale, f[2] / scale);
    var v = array(vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0), vec3(0.0, 0.0, 1.0));
    for (var sweep = 0u; sweep < SWEEPS; sweep++) {
        var rotated = false;
        for (var pair = 0u; pair < 3u; pair++) {
            let p = pair / 2u;
            let q = min(pair + 1u, 2u);
            let turn = jacobi(a[p], a[q]);
            if turn.y != 0.0 {
                rotate(&a, p, q, turn);
                rotate(&v, p, q, turn);
                rotated = true;
            }
        }
        if !rotated {
            break;
        }
    }
    for (var pair = 0u; pair < 3u; pair++) {
        let p = pair % 2u;
        if dot3(a[p], a[p]) < dot3(a[p + 1u], a[p + 1u]) {
            // A quarter turn and not a swap: V stays a rotation.
            rotate(&a, p, p + 1u, vec2(0.0, -1.0));
            rotate(&v, p, p + 1u, vec2(0.0, -1.0));
        }
    }
    let u = frame(a[0], a[1]);
    let u0 = u[0];
    let u1 = u[1];
    let u2 = cross3(u0, u1);
    let z = dot3(a[2], u2);
    let y = max(dot3(a[1], u1), abs(z));
    let x = max(length3(a[0]), y);
    return Svd(mat3x3(u0, u1, u2), vec3(x, y, z) * scale, mat3x3(v[0], v[1], v[2]));
}

fn sum_of_squares(m: mat3x3<f32>) -> f32 {
    let a = m[0] * m[0];
    let b = m[1] * m[1];
    let c = m[2] * m[2];
    return ((a.x + a.y) + (a.z + b.x)) + ((b.y + b.z) + (c.x + c.y)) + c.z;
}

// det X X⁻ᵀ.
fn cofactor(x: mat3x3<f32>) -> mat3x3<f32> {
    return mat3x3(cross3(x[1], x[2]), cross3(x[2], x[0]), cross3(x[0], x[1]));
}

struct Scaled {
    x: mat3x3<f32>,
    is_regular: bool,
}

fn newton_scaled(x: mat3x3<f32>) -> Scaled {
    let c = cofactor(x);
    let det = dot3(x[0], c[0]);
    let xx = sum_of_squares(x);
    let cc = sum_of_squares(c);
    // A device need not have infinities, nor what is not a number.
    if !(det > 0.0 && xx > 0.0 && cc > 0.0) {
        return Scaled(x, false);
    }
    let inverse = 1.0 / det;
    let gg = sqrt(cc / xx) * inverse;
    let g = sqrt(gg);
    let a = 0.5 * g;
    let b = 0.5 * inverse / g;
    return Scaled(a * x + b * c, gg * xx < 50.0 && cc > 1e-3 * xx * xx);
}

fn newton(x: mat3x3<f32>) -> mat3x3<f32> {
    let c = cofactor(x);
    let b = 0.5 / dot3(x[0], c[0]);
    return 0.5 * x + b * c;
}

// The rotation nearest to `f`.
fn rotation(f: mat3x3<f32>) -> mat3x3<f32> {
    let first = newton_scaled(f);
    if first.is_regular {
        let x = newton(newton_scaled(first.x).x);
        let y = newton(x);
        if sum_of_squares(y - x) < 1e-6 {
            return y;
        }
    }
    let s = svd(f);
    return product(s.u, transpose(s.v));
}
