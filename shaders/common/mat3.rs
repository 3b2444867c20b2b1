//! 3 × 3 matrices: singular values, and the nearest rotation, which is the local step of tetrahedra.
//!
//! [`svd`] is a one-sided Jacobi iteration (Hestenes 1958): it works on F itself and not on FᵀF, so that small singular values
//! keep their digits. [`rotation`] is the scaled Newton iteration for the polar factor (Higham 1986), a fixed number of steps
//! without a branch, on a matrix of the same rotation that is neither flat nor inverted, as long as F has one nearest rotation; what
//! that does not settle goes to [`svd`]. `eight_at_a_time` runs such a function over many matrices.

use glam::{Mat3, Vec3};

/// The same in WGSL, one matrix at a time.
pub const WGSL: &str = include_str!("mat3.wgsl");

/// Sweeps of the Jacobi iteration. Convergence is quadratic: three or four are usual.
const SWEEPS: usize = 12;

/// Columns whose cosine is below this are orthogonal.
const ORTHOGONAL: f32 = 2e-7;

/// F = U diag(σ) Vᵀ of a finite `f`, as (U, σ, V), where U and V are rotations (determinant +1) and σ descends in magnitude.
///
/// Of the three values only the last may be negative: it has the sign of det F, so that an inverted tetrahedron is one whose
/// thinnest direction points backwards (Irving et al. 2004; Twigg and Kačić-Alesić 2010). F = 0 has U = V = I.
#[must_use]
pub fn svd(f: Mat3) -> (Mat3, Vec3, Mat3) {
    let scale = f.x_axis.abs().max(f.y_axis.abs()).max(f.z_axis.abs()).max_element();
    if !(scale > 0.0 && f.is_finite()) {
        return (Mat3::IDENTITY, Vec3::ZERO, Mat3::IDENTITY);
    }
    // A = F V, with V such that the columns of A are orthogonal.
    let mut a = [f.x_axis / scale, f.y_axis / scale, f.z_axis / scale];
    let mut v = Vec3::AXES;
    for _ in 0..SWEEPS {
        let mut rotated = false;
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if let Some((c, s)) = jacobi(a[p], a[q]) {
                (a[p], a[q]) = (c * a[p] - s * a[q], s * a[p] + c * a[q]);
                (v[p], v[q]) = (c * v[p] - s * v[q], s * v[p] + c * v[q]);
                rotated = true;
            }
        }
        if !rotated {
            break;
        }
    }
    for (p, q) in [(0, 1), (1, 2), (0, 1)] {
        if a[p].length_squared() < a[q].length_squared() {
            // A quarter turn and not a swap: V stays a rotation.
            (a[p], a[q]) = (a[q], -a[p]);
            (v[p], v[q]) = (v[q], -v[p]);
        }
    }
    let [u0, u1] = frame(a[0], a[1]);
    let u2 = u0.cross(u1);
    let z = a[2].dot(u2);
    let y = a[1].dot(u1).max(z.abs());
    let x = a[0].length().max(y);
    (Mat3::from_cols(u0, u1, u2), Vec3::new(x, y, z) * scale, Mat3::from_cols(v[0], v[1], v[2]))
}

/// Cosine and sine of the rotation (a, b) → (c a − s b, s a + c b) that makes `a` and `b` orthogonal; `None` if they are.
#[inline]
pub(crate) fn jacobi(a: Vec3, b: Vec3) -> Option<(f32, f32)> {
    let (aa, bb, ab) = (a.length_squared(), b.length_squared(), a.dot(b));
    // Also false if a square has underflowed.
    if ab * ab > ORTHOGONAL * ORTHOGONAL * aa * bb {
        let zeta = (bb - aa) / (2.0 * ab);
        let t = zeta.signum() / (zeta.abs() + (1.0 + zeta * zeta).sqrt());
        let c = 1.0 / (1.0 + t * t).sqrt();
        Some((c, c * t))
    } else {
        None
    }
}

/// Unit vectors along orthogonal `a` and `b`, of which `a` is the longer; any where there is no direction. They are orthogonal
/// even where rounding has left `b` nothing else.
#[inline]
pub(crate) fn frame(a: Vec3, b: Vec3) -> [Vec3; 2] {
    // Of what is smaller or larger the square has no digits left.
    let direction = |v: Vec3| (1e-30..=f32::MAX).contains(&v.length_squared()).then(|| v.normalize());
    let u0 = direction(a).unwrap_or(Vec3::X);
    let across = b - u0 * u0.dot(b);
    let u1 = match direction(across) {
        Some(u1) if across.length_squared() > 0.25 * b.length_squared() => u1 - u0 * u0.dot(u1),
        _ => u0.any_orthonormal_vector(),
    };
    [u0, u1]
}

/// The rotation R (determinant +1) nearest to `f`: it maximizes tr(RᵀF). Where several are nearest, one of them; I for F = 0.
#[inline]
#[must_use]
pub fn rotation(f: Mat3) -> Mat3 {
    let (x, is_rotation) = polar(f.to_cols_array());
    if is_rotation { Mat3::from_cols_array(&x) } else { rotation_by_svd(f) }
}

/// Matrices that are taken at a time.
pub(crate) const LANES: usize = 8;

/// Eight matrices by component, so that a lane is a matrix: one loop over lanes around plain arithmetic vectorizes, and cannot round
/// differently than one at a time.
pub(crate) type Lanes9 = [[f32; LANES]; 9];

/// Replaces all matrices by what `most` makes of them, eight at a time from the one of the given number on. It returns 1 for each that
/// it has settled; the others are left to `rare`. Lanes to spare hold 0, and numbers there are beyond the last.
pub(crate) fn eight_at_a_time(
    all: &mut [Mat3],
    most: impl Fn(usize, &mut Lanes9) -> [f32; LANES],
    rare: impl Fn(usize, Mat3) -> Mat3,
) {
    for (k, eight) in all.chunks_mut(LANES).enumerate() {
        let first = k * LANES;
        let mut lanes = [[0.0; LANES]; 9];
        for (lane, f) in eight.iter().enumerate() {
            for (component, value) in f.to_cols_array().into_iter().enumerate() {
                lanes[component][lane] = value;
            }
        }
        let is_settled = most(first, &mut lanes);
        for (lane, f) in eight.iter_mut().enumerate() {
            *f = if is_settled[lane] == 1.0 {
                Mat3::from_cols_array(&std::array::from_fn(|component| lanes[component][lane]))
            } else {
                rare(first + lane, *f)
            };
        }
    }
}

/// [`rotation`] of each, bit for bit, in its place.
pub fn rotations(all: &mut [Mat3]) {
    eight_at_a_time(all, |_, f| polar_lanes(f), |_, f| rotation_by_svd(f));
}

#[cold]
#[inline(never)]
fn rotation_by_svd(f: Mat3) -> Mat3 {
    let (u, _, v) = svd(f);
    u * v.transpose()
}

/// [`polar`] of every lane.
#[inline(never)]
fn polar_lanes(f: &mut Lanes9) -> [f32; LANES] {
    let mut is_rotation = [0.0; LANES];
    for lane in 0..LANES {
        let (x, good) = polar([
            f[0][lane], f[1][lane], f[2][lane], f[3][lane], f[4][lane], f[5][lane], f[6][lane], f[7][lane],
            f[8][lane],
        ]);
        for component in 0..9 {
            f[component][lane] = x[component];
        }
        is_rotation[lane] = if good { 1.0 } else { 0.0 };
    }
    is_rotation
}

/// The rotation nearest to F by Newton's iteration X ← (g X + X⁻ᵀ/g)/2 from [`opened`] F, and whether the iteration has converged to
/// one. The factors g of Higham (1986) bring the singular values near 1; once they are, steps without g square the error.
#[inline(always)]
#[allow(clippy::inline_always, reason = "the loop over lanes vectorizes only if this is inlined")]
fn polar(f: [f32; 9]) -> ([f32; 9], bool) {
    let (x, is_regular) = newton_scaled(opened(f));
    let (x, _) = newton_scaled(x);
    let x = newton(x);
    let y = newton(x);
    let change = sum_of_squares(std::array::from_fn(|i| y[i] - x[i]));
    // `change` bounds the error left. NaN, to which an inverted F has led, fails.
    (y, (change < 1e-6) & is_regular)
}

/// F + cof F/σ₀. With F = U diag(σ) Vᵀ as of [`svd`], cof F = U diag(σ₁σ₂, σ₀σ₂, σ₀σ₁) Vᵀ: the sum has the same nearest rotation UVᵀ,
/// and values σ₀ + σ₁σ₂/σ₀, σ₁ + σ₂ and again σ₁ + σ₂. They are positive, even where σ₂ is not, and as far from 0 as the nearest rotation
/// is from being one of several. (Of two equal ones the scaled step makes a ratio of √2 at most, however uneven they are.)
///
/// σ₀² is the largest root of a cubic: from above, Newton's iteration falls to it and not below. Any σ₀ will do that is not much too large.
#[inline(always)]
#[allow(clippy::inline_always, reason = "the loop over lanes vectorizes only if this is inlined")]
fn opened(f: [f32; 9]) -> [f32; 9] {
    let (c, det) = cofactor(f);
    let (ff, cc) = (sum_of_squares(f), sum_of_squares(c));
    // In parts of ‖F‖²: y³ − y² + a y − b = 0.
    let inverse = 1.0 / ff;
    let a = cc * inverse * inverse;
    let b = (det * inverse) * (det * inverse) * inverse;
    let mut y = 1.0;
    for _ in 0..LEADING {
        y -= (((y - 1.0) * y + a) * y - b) / ((3.0 * y - 2.0) * y + a);
    }
    let scale = 1.0 / (y * ff).sqrt();
    std::array::from_fn(|i| f[i] + scale * c[i])
}

/// Steps towards σ₀. Where they are slow two σ are nearly the same.
const LEADING: usize = 4;

/// ‖X‖ ‖X⁻¹‖ from which on rounding may turn a sign.
const MOST_UNEVEN: f32 = 300.0;

/// One scaled step of [`polar`], and whether X is not nearly singular: an inverse loses as many digits as its condition has.
#[inline(always)]
#[allow(clippy::inline_always, reason = "the loop over lanes vectorizes only if this is inlined")]
fn newton_scaled(x: [f32; 9]) -> ([f32; 9], bool) {
    let (c, det) = cofactor(x);
    // g² = ‖X⁻¹‖/‖X‖, by Frobenius; NaN if det X < 0.
    let (xx, cc) = (sum_of_squares(x), sum_of_squares(c));
    let inverse = 1.0 / det;
    let gg = (cc / xx).sqrt() * inverse;
    let g = gg.sqrt();
    let (a, b) = (0.5 * g, 0.5 * inverse / g);
    // ‖X‖ ‖X⁻¹‖ (at least 3), and σ₁/σ₀ by its square: on a line det and the cofactors are both but rounding.
    let is_regular = (gg * xx < MOST_UNEVEN) & (cc > 1e-5 * xx * xx);
    (std::array::from_fn(|i| a * x[i] + b * c[i]), is_regular)
}

/// One step of [`polar`] without scaling.
#[inline(always)]
#[allow(clippy::inline_always, reason = "the loop over lanes vectorizes only if this is inlined")]
fn newton(x: [f32; 9]) -> [f32; 9] {
    let (c, det) = cofactor(x);
    let b = 0.5 / det;
    std::array::from_fn(|i| 0.5 * x[i] + b * c[i])
}

/// det X X⁻ᵀ, and det X.
#[inline(always)]
#[allow(clippy::inline_always, reason = "the loop over lanes vectorizes only if this is inlined")]
pub(crate) fn cofactor(x: [f32; 9]) -> ([f32; 9], f32) {
    let c = [
        x[4] * x[8] - x[5] * x[7],
        x[5] * x[6] - x[3] * x[8],
        x[3] * x[7] - x[4] * x[6],
        x[7] * x[2] - x[8] * x[1],
        x[8] * x[0] - x[6] * x[2],
        x[6] * x[1] - x[7] * x[0],
        x[1] * x[5] - x[2] * x[4],
        x[2] * x[3] - x[0] * x[5],
        x[0] * x[4] - x[1] * x[3],
    ];
    (c, x[0] * c[0] + x[1] * c[1] + x[2] * c[2])
}

/// Σ x², by a tree of sums: one after the other they would wait for each other.
#[inline(always)]
#[allow(clippy::inline_always, reason = "the loop over lanes vectorizes only if this is inlined")]
pub(crate) fn sum_of_squares(x: [f32; 9]) -> f32 {
    let x = x.map(|x| x * x);
    ((x[0] + x[1]) + (x[2] + x[3])) + ((x[4] + x[5]) + (x[6] + x[7])) + x[8]
}

#[cfg(test)]
pub(crate) mod tests {
    use glam::{DMat3, DVec3, Quat};

    use super::*;
    use crate::pcg::pcg;

    /// Numbers in [−1, 1].
    struct Random(u32);

    impl Random {
        fn next(&mut self) -> f32 {
            self.0 = self.0.wrapping_add(1);
            f32::from(u16::try_from(pcg(self.0) >> 16).unwrap()) / 32767.5 - 1.0
        }

        fn matrix(&mut self) -> Mat3 {
            Mat3::from_cols_array(&std::array::from_fn(|_| self.next()))
        }

        fn rotation(&mut self) -> Mat3 {
            Mat3::from_quat(
                Quat::from_xyzw(self.next(), self.next(), self.next(), self.next() + 1e-3).normalize(),
            )
        }

        /// U diag(σ) Vᵀ for random U and V.
        fn with(&mut self, sigma: Vec3) -> Mat3 {
            self.rotation() * Mat3::from_diagonal(sigma) * self.rotation().transpose()
        }
    }

    /// The oracle: V and σ² from a cyclic Jacobi iteration on FᵀF in f64, the rest from F V. As [`svd`] otherwise.
    pub(crate) fn oracle(f: Mat3) -> (DMat3, DVec3, DMat3) {
        let f = f.as_dmat3();
        let (mut s, mut v) = (f.transpose() * f, DMat3::IDENTITY);
        for (p, q) in [(0, 1), (0, 2), (1, 2)].into_iter().cycle().take(90) {
            let (app, aqq, apq) = (s.col(p)[p], s.col(q)[q], s.col(q)[p]);
            let angle = 0.5 * (2.0 * apq).atan2(aqq - app);
            let mut g = DMat3::IDENTITY;
            g.col_mut(p)[p] = angle.cos();
            g.col_mut(q)[q] = angle.cos();
            g.col_mut(q)[p] = angle.sin();
            g.col_mut(p)[q] = -angle.sin();
            s = g.transpose() * s * g;
            v *= g;
        }
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| (f * v.col(b)).length().total_cmp(&(f * v.col(a)).length()));
        let [v0, v1] = [v.col(order[0]), v.col(order[1])];
        let v = DMat3::from_cols(v0, v1, v0.cross(v1));
        let u0 = (f * v0).try_normalize().unwrap_or(DVec3::X);
        let u1 = (f * v1 - u0 * u0.dot(f * v1)).try_normalize().unwrap_or(u0.any_orthonormal_vector());
        let u = DMat3::from_cols(u0, u1, u0.cross(u1));
        let sigma = DVec3::new((f * v0).length(), (f * v1).dot(u1), (f * v.z_axis).dot(u.z_axis));
        (u, sigma, v)
    }

    fn largest(m: Mat3) -> f32 {
        m.to_cols_array().into_iter().fold(0.0, |most, x| if x.abs() <= most { most } else { x.abs() })
    }

    fn largest64(m: DMat3) -> f64 {
        m.to_cols_array().into_iter().fold(0.0, |most, x| if x.abs() <= most { most } else { x.abs() })
    }

    fn assert_rotation(r: Mat3, what: &str) {
        assert!(largest(r.transpose() * r - Mat3::IDENTITY) < 3e-6, "{what}: {r} is not orthogonal");
        assert!(r.determinant() > 0.5, "{what}: {r} mirrors");
    }

    /// Matrices of every sort, by name; `true` if the nearest rotation is unique by a margin.
    pub(crate) fn samples() -> Vec<(&'static str, Mat3, bool)> {
        let mut random = Random(7);
        let mut samples = vec![("zero", Mat3::ZERO, false), ("identity", Mat3::IDENTITY, true)];
        samples.push(("mirror", -Mat3::IDENTITY, false));
        samples.push(("one entry", Mat3::from_cols(Vec3::ZERO, Vec3::Z * 3.0, Vec3::ZERO), false));
        for _ in 0..2000 {
            let f = random.matrix();
            let sigma = oracle(f).1;
            samples.push(("random", f, sigma.y + sigma.z > 0.2 * sigma.x));
            let near = Mat3::IDENTITY + 0.2 * f;
            samples.push(("near a rotation", random.rotation() * near, true));
            let (a, b) = (random.next().abs(), random.next().abs());
            samples.push(("inverted", random.with(Vec3::new(1.0 + a, 0.5 + 0.5 * b, -0.3 * a)), true));
            samples.push(("inverted, equal", random.with(Vec3::new(1.0, a, -a)), false));
            samples.push(("flat", random.with(Vec3::new(1.0 + a, 0.5 + b, 0.0)), true));
            samples.push(("nearly flat", random.with(Vec3::new(1.0 + a, 0.5 + b, 1e-4 * a)), true));
            samples.push(("a line", random.with(Vec3::new(1.0 + a, 0.0, 0.0)), false));
            samples.push(("graded", random.with(Vec3::new(1.0, 1e-3, 1e-7)), false));
            let thin = 10_f32.powf(-2.0 * b);
            samples.push(("stretched", random.with(Vec3::new(1.0 + 9.0 * a, thin, 0.7 * thin)), false));
            samples.push(("stretched, inverted", random.with(Vec3::new(1.0 + a, thin, -0.5 * thin)), false));
            for scale in [1e-38, 1e-30, 1e-12, 1e-6, 1e6, 1e12, 1e30, 1e37] {
                samples.push(("scaled", scale * (random.rotation() * near), true));
            }
        }
        samples
    }

    #[test]
    fn the_oracle_reconstructs() {
        for (what, f, _) in samples() {
            let (u, sigma, v) = oracle(f);
            let scale = f64::from(largest(f)).max(f64::MIN_POSITIVE);
            let back = u * DMat3::from_diagonal(sigma) * v.transpose();
            assert!(largest64(back - f.as_dmat3()) < 1e-7 * scale, "{what}: {f}");
            for r in [u, v] {
                assert!(
                    largest64(r.transpose() * r - DMat3::IDENTITY) < 1e-12 && r.determinant() > 0.5,
                    "{what}: {f}"
                );
            }
        }
    }

    #[test]
    fn svd_is_that_of_the_oracle() {
        for (what, f, _) in samples() {
            let (u, sigma, v) = svd(f);
            assert_rotation(u, what);
            assert_rotation(v, what);
            let scale = f64::from(largest(f)).max(f64::MIN_POSITIVE);
            let back = u.as_dmat3() * DMat3::from_diagonal(sigma.as_dvec3()) * v.as_dmat3().transpose();
            assert!(largest64(back - f.as_dmat3()) < 3e-6 * scale, "{what}: {f}");
            let expected = oracle(f).1;
            assert!((sigma.as_dvec3() - expected).length() < 3e-6 * scale, "{what}: {f} {sigma} {expected}");
            assert!(sigma.x >= sigma.y && sigma.y >= sigma.z.abs(), "{what}: {sigma}");
        }
    }

    #[test]
    fn rotation_is_nearest() {
        let mut worst = 0.0_f64;
        for (what, f, unique) in samples() {
            let r = rotation(f);
            assert_rotation(r, what);
            let (u, sigma, v) = oracle(f);
            // tr(RᵀF) is the most there can be, also where the rotation is not unique.
            let trace: f64 = (0..3).map(|i| r.as_dmat3().col(i).dot(f.as_dmat3().col(i))).sum();
            assert!(trace >= sigma.element_sum() - 1e-5 * sigma.x, "{what}: {f}");
            // The rounding of F alone turns the rotation by so much.
            let gap = (sigma.y + sigma.z) / sigma.x;
            let error = largest64(r.as_dmat3() - u * v.transpose());
            if gap > 1e-3 {
                worst = worst.max(error * gap);
                assert!(error < 2e-6 / gap, "{what}: {f} {error} {gap}");
            }
            if unique {
                assert!(error < 1e-5, "{what}: {f} {error}");
            }
        }
        println!("largest error {worst:e} over the gap");
    }

    /// The way without branches settles nearly all that has one nearest rotation.
    #[test]
    fn hardly_anything_needs_singular_values() {
        let mut random = Random(11);
        // Inverted by most of their width: σ₀ has to be known well.
        let inverted = std::iter::repeat_with(|| {
            let b = 0.5 + 0.5 * random.next().abs();
            random.with(Vec3::new(1.0, b, -0.8 * b))
        });
        let of_all = samples().into_iter().filter(|(what, ..)| *what != "scaled").map(|(_, f, _)| f);
        for all in [of_all.collect::<Vec<_>>(), inverted.take(2000).collect()] {
            let has_one = |f: &&Mat3| {
                let sigma = oracle(**f).1;
                sigma.y + sigma.z > 0.01 * sigma.x
            };
            let some: Vec<&Mat3> = all.iter().filter(has_one).collect();
            let n_left = some.iter().filter(|f| !polar(f.to_cols_array()).1).count();
            println!("{n_left} of {}", some.len());
            assert!(some.len() >= 2000 && n_left * 100 < some.len(), "{n_left} of {}", some.len());
        }
    }

    #[test]
    fn rotations_are_bitwise_those_of_one_at_a_time() {
        let f: Vec<Mat3> = samples().into_iter().map(|(_, f, _)| f).collect();
        let expected: Vec<Mat3> = f.iter().map(|&f| rotation(f)).collect();
        for shift in 0..LANES {
            for length in [0, 1, 7, 8, 9, f.len() - shift] {
                let (f, expected) = (&f[shift..][..length], &expected[shift..][..length]);
                let mut out = f.to_vec();
                rotations(&mut out);
                let bits = |m: &[Mat3]| -> Vec<[u32; 9]> {
                    m.iter().map(|m| m.to_cols_array().map(f32::to_bits)).collect()
                };
                assert_eq!(bits(&out), bits(expected), "{shift}");
            }
        }
    }

    #[test]
    fn even_nan_gives_a_rotation() {
        for f in [Mat3::NAN, Mat3::from_diagonal(Vec3::new(1.0, f32::INFINITY, 1.0))] {
            assert_eq!(rotation(f), Mat3::IDENTITY);
        }
    }
}
