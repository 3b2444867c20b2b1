//! The nearest matrix with a determinant in a range, which is the local step of volumes, without singular values.
//!
//! In units of the edge of the cube whose volume P is to have: P is nearest to F where P − F = μ cof P and det P = 1, and |μ| σ₀(P) ≤ 1.
//! (With the U and V of F: s_i − σ_i = μ s_j s_k, so σ_i ∓ σ_j = (s_i ∓ s_j)(1 ± μ s_k) have the signs that make s the nearest.)
//! F = P − μ cof P says what I = ‖F‖², K = ‖cof F‖² and J = det F are by μ, ‖P‖² and ‖cof P‖². Without the latter two it is
//!
//! ```text
//! (1−J) − Kμ − (2+J)Iμ² − (1+J)(4+J)μ³ + (I²−2K)μ⁴ + (4+J)Iμ⁵ + (6+5J)μ⁶ − Kμ⁷ − 2Iμ⁸ − (4−J)μ⁹ + μ¹² = 0,
//! ```
//!
//! whose root nearest to 0 on the side of 1 − J Newton's method finds between bounds. Then P solves a linear equation: with D = P − F, cof P = D/μ
//! and cof D = μ² P, so cof (F + D) = cof F + F×D + cof D gives (1−μ³) D − μ F×D = μ cof F + μ³ F. Here (F×D)_i = σ_j d_k + σ_k d_j,
//! which takes F to 2 cof F, cof F to F(I − FᵀF), and that to I cof F + J F: D is a sum of these three.

#![allow(clippy::inline_always, reason = "a loop over lanes vectorizes only if this is inlined")]

use crate::mat3::{cofactor, sum_of_squares};

/// The same in WGSL. Needs `mat3.wgsl`.
pub(crate) const WGSL: &str = include_str!("determinant.wgsl");

/// μ and what is known of it.
#[derive(Clone, Copy)]
struct Root {
    mu: f32,
    low: f32,
    high: f32,
    /// By how much μ moved last.
    change: f32,
    /// Of the polynomial, where μ was before.
    slope: f32,
}

/// The matrix nearest to `f` (column by column) whose determinant is in `range`, `edges` being the cube roots of that; and whether this
/// has settled it. It has not if two are as near, or nearly.
#[inline(always)]
pub(crate) fn nearest(f: [f32; 9], range: [f32; 2], edges: [f32; 2]) -> ([f32; 9], bool) {
    let products = products(f);
    let det = determinant(f, products);
    let is_inside = (det >= range[0]) & (det <= range[1]);
    let (p, is_settled) = at_edge(f, products, det, if det < range[0] { edges[0] } else { edges[1] });
    // A loop: a choice between arrays would be a branch.
    let mut nearest = p;
    for k in 0..9 {
        nearest[k] = if is_inside { f[k] } else { p[k] };
    }
    (nearest, is_settled | is_inside)
}

/// FᵀF: entries xx, yy, zz, yz, zx, xy.
#[inline(always)]
fn products(f: [f32; 9]) -> [f32; 6] {
    let dot = |a: usize, b: usize| f[a] * f[b] + f[a + 1] * f[b + 1] + f[a + 2] * f[b + 2];
    [dot(0, 0), dot(3, 3), dot(6, 6), dot(3, 6), dot(6, 0), dot(0, 3)]
}

/// det F, off by no more than if ‖F‖ had been rounded: the longest column is taken out of the others first, or what is small of them
/// would drown.
#[inline(always)]
fn determinant(f: [f32; 9], [xx, yy, zz, yz, zx, xy]: [f32; 6]) -> f32 {
    let (is_x, is_y) = ((xx >= yy) & (xx >= zz), yy >= zz);
    let pick = |x: f32, y: f32, z: f32| {
        let other = if is_y { y } else { z };
        if is_x { x } else { other }
    };
    // In this order or the next: the determinant is the same.
    let a = [pick(f[0], f[3], f[6]), pick(f[1], f[4], f[7]), pick(f[2], f[5], f[8])];
    let b = [pick(f[3], f[6], f[0]), pick(f[4], f[7], f[1]), pick(f[5], f[8], f[2])];
    let c = [pick(f[6], f[0], f[3]), pick(f[7], f[1], f[4]), pick(f[8], f[2], f[5])];
    let inverse = 1.0 / pick(xx, yy, zz);
    let (ab, ac) = (pick(xy, yz, zx) * inverse, pick(zx, xy, yz) * inverse);
    let b = [b[0] - ab * a[0], b[1] - ab * a[1], b[2] - ab * a[2]];
    let c = [c[0] - ac * a[0], c[1] - ac * a[1], c[2] - ac * a[2]];
    a[0] * (b[1] * c[2] - b[2] * c[1])
        + a[1] * (b[2] * c[0] - b[0] * c[2])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
}

#[inline(always)]
fn at_edge(f: [f32; 9], [xx, yy, zz, yz, zx, xy]: [f32; 6], det: f32, edge: f32) -> ([f32; 9], bool) {
    let (cof, _) = cofactor(f);
    let per_edge = 1.0 / edge;
    let per_area = per_edge * per_edge;
    let i = (xx + yy + zz) * per_area;
    let j = det * (per_area * per_edge);
    let k = sum_of_squares(cof) * (per_area * per_area);
    let Root { mu, change, slope, .. } = root(i, j, k);

    let (m2, m3) = (mu * mu, mu * mu * mu);
    let kappa = 1.0 - m3;
    // Π (1 − μ² s²), which is 0 where P is one of several.
    let margin = (kappa * (kappa * kappa - m2 * i) - 2.0 * m3 * j) / (1.0 + m3);
    let is_root = change * change * (1.0 + i) < 1e-7;
    // Rounding moves the root by (1 + |J|)/slope ε, and that moves P by √(1 + K)/margin: to be small beside ‖P‖. Where the polynomial
    // rises is another root.
    let (firm, loose) = (-slope * margin, 1.0 + j.abs());
    let is_firm = firm * firm.abs() * (3.0 + i) > LEAST_FIRM * (loose * loose * (1.0 + k));

    let c = m2 / margin;
    let a = 1.0 + c * i + (m3 + mu * j * c) / kappa;
    let (b, c) = (mu * kappa / margin * per_edge, c * per_area);
    let cubed = [
        f[0] * xx + f[3] * xy + f[6] * zx,
        f[1] * xx + f[4] * xy + f[7] * zx,
        f[2] * xx + f[5] * xy + f[8] * zx,
        f[0] * xy + f[3] * yy + f[6] * yz,
        f[1] * xy + f[4] * yy + f[7] * yz,
        f[2] * xy + f[5] * yy + f[8] * yz,
        f[0] * zx + f[3] * yz + f[6] * zz,
        f[1] * zx + f[4] * yz + f[7] * zz,
        f[2] * zx + f[5] * yz + f[8] * zz,
    ];
    (std::array::from_fn(|n| a * f[n] + b * cof[n] - c * cubed[n]), is_root & is_firm)
}

/// Below this P is nearly one of several, or μ nearly one of several roots.
const LEAST_FIRM: f32 = 0.1;

/// The polynomial's root nearest to 0 on the side of 1 − `j`.
#[inline(always)]
fn root(i: f32, j: f32, k: f32) -> Root {
    let lack = 1.0 - j;
    // |μ| ≤ 1/σ₀(P); more is known if μ > 0, where P is larger than F.
    let bound = (3.0 / i).sqrt().min(1.0);
    let (low, high) = if lack > 0.0 { (0.0, bound) } else { (-bound, 0.0) };
    // The second summand fits flat F.
    let mu = (lack / (k + 1.7 * lack.max(0.0))).max(0.9 * low).min(0.9 * high);
    let mut root = Root { mu, low, high, change: 0.0, slope: 0.0 };
    let quartic = i * i - 2.0 * k;
    let c = [
        lack,
        -k,
        -i * (2.0 + j),
        -(1.0 + j) * (4.0 + j),
        quartic,
        i * (4.0 + j),
        6.0 + 5.0 * j,
        -k,
        -2.0 * i,
    ];
    // Written out: a loop would not be unrolled before the one over lanes is to vectorize.
    root = newton(root, c, j);
    root = newton(root, c, j);
    root = newton(root, c, j);
    root = newton(root, c, j);
    newton(root, c, j)
}

/// One step for the polynomial of the coefficients `c`, then j − 4, 0, 0, 1.
#[inline(always)]
fn newton(Root { mu, low, high, .. }: Root, c: [f32; 9], j: f32) -> Root {
    let (mut value, mut slope) = (mu * mu * mu + (j - 4.0), 3.0 * (mu * mu));
    for c in c.into_iter().rev() {
        (slope, value) = (slope * mu + value, value * mu + c);
    }
    let is_below = value > 0.0;
    let low = if is_below { mu } else { low };
    let high = if is_below { high } else { mu };
    let next = mu - value / slope;
    // NaN is not between.
    let next = if (next >= low) & (next <= high) { next } else { 0.5 * (low + high) };
    Root { mu: next, low, high, change: next - mu, slope }
}
