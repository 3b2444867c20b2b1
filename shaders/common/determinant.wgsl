// The nearest matrix with a given determinant. See determinant.rs.

const STEPS = 5u;
const LEAST_FIRM = 0.1f;

struct OfDeterminant {
    p: mat3x3<f32>,
    is_settled: bool,
}

struct Root {
    mu: f32,
    change: f32,
    slope: f32,
}

// μ.
fn root(i: f32, j: f32, k: f32) -> Root {
    let lack = 1.0 - j;
    let bound = min(sqrt(3.0 / i), 1.0);
    var low = select(-bound, 0.0, lack > 0.0);
    var high = select(0.0, bound, lack > 0.0);
    var mu = min(max(lack / (k + 1.7 * max(lack, 0.0)), 0.9 * low), 0.9 * high);
    var c = array(
        lack, -k, -i * (2.0 + j), -(1.0 + j) * (4.0 + j), i * i - 2.0 * k, i * (4.0 + j), 6.0 + 5.0 * j, -k, -2.0 * i,
    );
    var change = 0.0;
    var slope = 0.0;
    for (var step = 0u; step < STEPS; step++) {
        var value = mu * mu * mu + (j - 4.0);
        slope = 3.0 * (mu * mu);
        for (var n = 0u; n < 9u; n++) {
            slope = slope * mu + value;
            value = value * mu + c[8u - n];
        }
        if value > 0.0 {
            low = mu;
        } else {
            high = mu;
        }
        var next = 0.5 * (low + high);
        if slope < 0.0 {
            let newton = mu - value / slope;
            if newton >= low && newton <= high {
                next = newton;
            }
        }
        change = next - mu;
        mu = next;
    }
    return Root(mu, change, slope);
}

// det F, by way of what is across the longest column.
fn stable_determinant(f: mat3x3<f32>) -> f32 {
    let squared = vec3(dot3(f[0], f[0]), dot3(f[1], f[1]), dot3(f[2], f[2]));
    var a = f[2];
    var b = f[0];
    var c = f[1];
    if squared.x >= squared.y && squared.x >= squared.z {
        a = f[0];
        b = f[1];
        c = f[2];
    } else if squared.y >= squared.z {
        a = f[1];
        b = f[2];
        c = f[0];
    }
    let length = dot3(a, a);
    if !(length > 0.0) {
        return 0.0;
    }
    let inverse = 1.0 / length;
    return dot3(a, cross3(b - (dot3(a, b) * inverse) * a, c - (dot3(a, c) * inverse) * a));
}

// The matrix nearest to `f` whose determinant is the cube of `edge`; `det` is its own.
fn of_determinant(f: mat3x3<f32>, det: f32, edge: f32) -> OfDeterminant {
    let cof = cofactor(f);
    let per_edge = 1.0 / edge;
    let per_area = per_edge * per_edge;
    let i = sum_of_squares(f) * per_area;
    let j = det * (per_area * per_edge);
    let k = sum_of_squares(cof) * (per_area * per_area);
    // A device need not have infinities, nor what is not a number.
    if !(i > 1e-6f && i < 1e12f && k < 1e18f) {
        return OfDeterminant(f, false);
    }
    let found = root(i, j, k);
    let mu = found.mu;
    let m2 = mu * mu;
    let m3 = mu * mu * mu;
    let kappa = 1.0 - m3;
    let margin = (kappa * (kappa * kappa - m2 * i) - 2.0 * m3 * j) / (1.0 + m3);
    let is_root = found.change * found.change * (1.0 + i) < 1e-7f;
    let firm = -found.slope * margin;
    let loose = 1.0 + abs(j);
    let is_firm = firm * abs(firm) * (3.0 + i) > LEAST_FIRM * (loose * loose * (1.0 + k));
    if !(is_root && is_firm) {
        return OfDeterminant(f, false);
    }
    let c = m2 / margin;
    let a = 1.0 + c * i + (m3 + mu * j * c) / kappa;
    let b = mu * kappa / margin * per_edge;
    let cubed = product(f, product(transpose(f), f));
    return OfDeterminant(a * f + b * cof - (c * per_area) * cubed, true);
}
