//! A tetrahedron that keeps its volume, within a range (Bouaziz et al. 2014, Sec. 5.4).
//!
//! A q = F, the deformation gradient (row r of A gives its column r), p = the nearest matrix with a determinant in the range:
//! W = w/2 ‖F − p‖², w = stiffness × volume at rest. p has the U and V of F = U diag(σ) Vᵀ; its singular values s are those
//! nearest to σ with s₀ s₁ s₂ = t, where the derivatives of ‖s − σ‖²/2 and of the product are parallel:
//! s_i (s_i − σ_i) = m for one m. Mostly p is found without them (`determinant.rs`).

use bytemuck::{Pod, Zeroable, cast_slice_mut};
use glam::{Mat3, Vec3};
use wide::f32x4;

use super::{APPLY, BATCH, BLOCK, Constraint, Deviations, tet_strain::gradient};
use crate::determinant::{self, nearest};
use crate::lanes::{Lanes3, each};
use crate::mat3::{self, LANES, Lanes9, eight_at_a_time, svd};

/// The rest data of a tetrahedron.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct TetVolume {
    /// Columns of A \[1/m\], by particle.
    pub columns: [[f32; 3]; 4],
    /// w \[J\]: stiffness \[Pa\] × volume at rest \[m³\].
    pub weight: f32,
    /// The least and the most volume, as fractions of that at rest \[1\].
    pub range: [f32; 2],
    /// Cube roots of the range: what is needed in every projection, and rounds differently from machine to machine.
    pub edges: [f32; 2],
    /// 1/det of the edges at rest \[1/m³\], by its sign.
    pub inverse_det: f32,
}

impl TetVolume {
    /// A tetrahedron of `stiffness` \[Pa\] whose volume keeps within `range` (positive, ascending) of that at `x` \[m\].
    /// `None` if it is flat.
    #[must_use]
    pub fn rest(x: [Vec3; 4], stiffness: f32, range: [f32; 2]) -> Option<Self> {
        let (columns, weight) = gradient(x, stiffness)?;
        let [_, b, c, d] = columns.map(Vec3::from_array);
        let edges = range.map(f32::cbrt);
        let inverse_det = b.cross(c).dot(d);
        inverse_det.is_finite().then_some(Self { columns, weight, range, edges, inverse_det })
    }

    /// The determinant nearest to `det` in the range.
    #[inline]
    fn target(&self, det: f32) -> f32 {
        det.min(self.range[1]).max(self.range[0])
    }

    #[cold]
    #[inline(never)]
    fn project_by_svd(&self, f: Mat3) -> Mat3 {
        let det = f.x_axis.cross(f.y_axis).dot(f.z_axis);
        let target = self.target(det);
        if det == target {
            return f;
        }
        let (u, sigma, v) = svd(f);
        let edge = if det < target { self.edges[0] } else { self.edges[1] };
        u * Mat3::from_diagonal(nearest_with_product(sigma, edge)) * v.transpose()
    }
}

/// [`nearest`] of every lane, `range` and `edges` by lane.
#[inline(never)]
fn nearest_lanes(f: &mut Lanes9, range: &[[f32; LANES]; 2], edges: &[[f32; LANES]; 2]) -> [f32; LANES] {
    let mut is_settled = [0.0; LANES];
    for lane in 0..LANES {
        let of_lane = [
            f[0][lane], f[1][lane], f[2][lane], f[3][lane], f[4][lane], f[5][lane], f[6][lane], f[7][lane],
            f[8][lane],
        ];
        let (p, good) = nearest(of_lane, [range[0][lane], range[1][lane]], [edges[0][lane], edges[1][lane]]);
        for component in 0..9 {
            f[component][lane] = p[component];
        }
        is_settled[lane] = if good { 1.0 } else { 0.0 };
    }
    is_settled
}

/// The values nearest to `sigma` (of the order and signs of [`svd`]) whose product is that of a cube of this `edge` > 0.
///
/// With x = s₂ for a parameter, m = x (x − σ₂), s_i = (σ_i + √(σ_i² + 4m))/2 for the larger two, and the product is to be
/// `edge`³: one equation, for Newton's method between bounds.
fn nearest_with_product(sigma: Vec3, edge: f32) -> Vec3 {
    let scale = sigma.x.max(edge);
    let root = edge / scale;
    let (sigma, target) = (sigma / scale, root * root * root);
    let larger = |x: f32| {
        let m4 = 4.0 * x * (x - sigma.z);
        let root = |s: f32| (s * s + m4).max(0.0).sqrt();
        let (r0, r1) = (root(sigma.x), root(sigma.y));
        (0.5 * (sigma.x + r0), 0.5 * (sigma.y + r1), r0, r1)
    };
    // Too much: below σ₂. Too little: s₂ is the least of the three, so at most the cube root.
    let is_large = sigma.x * sigma.y * sigma.z > target;
    let (mut low, mut high) = if is_large { (0.0, sigma.z) } else { (sigma.z.max(0.0), edge / scale) };
    let mut x = if is_large { high } else { 0.5 * (low + high) };
    for _ in 0..40 {
        let (s0, s1, r0, r1) = larger(x);
        let error = s0 * s1 * x - target;
        if error.abs() <= 2e-7 * target {
            break;
        }
        if error > 0.0 {
            high = x;
        } else {
            low = x;
        }
        let slope = s0 * s1 + s0 * s1 * x * (2.0 * x - sigma.z) * (1.0 / (s0 * r0) + 1.0 / (s1 * r1));
        let next = x - error / slope;
        // NaN is not between.
        x = if next > low && next < high { next } else { 0.5 * (low + high) };
    }
    let (s0, s1, ..) = larger(x);
    let s2 = if s0 * s1 > 0.0 { target / (s0 * s1) } else { x };
    Vec3::new(s0, s1, s2) * scale
}

impl Constraint<4, 3> for TetVolume {
    const NAME: &'static str = "tet_volume";
    const WGSL: &'static [&'static str] =
        &[mat3::WGSL, determinant::WGSL, APPLY, BLOCK, include_str!("tet_volume.wgsl")];
    type Multiplier = f32;

    #[inline]
    fn weight(&self) -> f32 {
        self.weight
    }

    #[inline]
    fn column(&self, slot: usize) -> [f32; 3] {
        self.columns[slot]
    }

    fn project(&self, [x, y, z]: [Vec3; 3]) -> [Vec3; 3] {
        let f = Mat3::from_cols(x, y, z);
        let (p, is_settled) = nearest(f.to_cols_array(), self.range, self.edges);
        let p = if is_settled { Mat3::from_cols_array(&p) } else { self.project_by_svd(f) };
        [p.x_axis, p.y_axis, p.z_axis]
    }

    fn project_all<'a>(rest: impl Fn(usize) -> &'a Self, aq: &mut [[Vec3; 3]]) {
        let n = aq.len();
        let most = |first: usize, f: &mut Lanes9| {
            let (mut range, mut edges) = ([[1.0; LANES]; 2], [[1.0; LANES]; 2]);
            for lane in 0..LANES.min(n - first) {
                let rest = rest(first + lane);
                for side in 0..2 {
                    (range[side][lane], edges[side][lane]) = (rest.range[side], rest.edges[side]);
                }
            }
            nearest_lanes(f, &range, &edges)
        };
        eight_at_a_time(cast_slice_mut(aq), most, |k, f| rest(k).project_by_svd(f));
    }

    /// C = (det F − t)/√3, t the nearest determinant in the range, whose gradients are cross products of edges and need no singular
    /// values. W = w/2 C² to lowest order near a rotation, where ‖F − p‖² = (det F − t)²/3; further off it is another energy.
    /// Inside the range C and its gradient are 0.
    #[inline]
    fn deviation(&self, q: &[Vec3; 4]) -> (f32, [Vec3; 4]) {
        let [x, y, z] = [q[1] - q[0], q[2] - q[0], q[3] - q[0]];
        let (yz, zx, xy) = (y.cross(z), z.cross(x), x.cross(y));
        let det = x.dot(yz) * self.inverse_det;
        if det > self.range[0] && det < self.range[1] {
            return (0.0, [Vec3::ZERO; 4]);
        }
        let scale = SCALE * self.inverse_det;
        let [b, c, d] = [yz * scale, zx * scale, xy * scale];
        ((det - self.target(det)) * SCALE, [-(b + c + d), b, c, d])
    }

    #[inline]
    fn deviations(rest: &[Self; BATCH], q: &[Lanes3<f32x4>; 4]) -> Option<Deviations<4>> {
        let (x, y, z) = (q[1] - q[0], q[2] - q[0], q[3] - q[0]);
        let (yz, zx, xy) = (y.cross(z), z.cross(x), x.cross(y));
        let inverse_det = each(rest, |rest| rest.inverse_det);
        let det = x.dot(yz) * inverse_det;
        let (low, high) = (each(rest, |rest| rest.range[0]), each(rest, |rest| rest.range[1]));
        let is_inside = det.simd_gt(low) & det.simd_lt(high);
        let scale = is_inside.bitselect(f32x4::ZERO, inverse_det * f32x4::splat(SCALE));
        let [b, c, d] = [yz * scale, zx * scale, xy * scale];
        let deviation = (det - det.fast_min(high).fast_max(low)) * f32x4::splat(SCALE);
        let a = -(b + c + d);
        let squared = [a.dot(a), b.dot(b), c.dot(c), d.dot(d)];
        Some(Deviations { c: deviation, gradient: [a, b, c, d], squared })
    }
}

/// 1/√3.
const SCALE: f32 = 0.577_350_26;

#[cfg(test)]
mod tests {
    use glam::{DMat3, DVec3};

    use super::*;

    const REST: [Vec3; 4] = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];

    #[test]
    fn nearest_values_have_the_product_and_are_nearest() {
        let values = [-0.9, -0.3, 0.0, 1e-3, 0.2, 0.7, 1.0, 1.5, 3.0];
        for (x, y, z) in values.iter().flat_map(|&x| values.map(|y| values.map(|z| (x, y, z)))).flatten() {
            if !(x >= y && y >= f32::abs(z) && y >= 0.0) {
                continue;
            }
            for target in [0.3_f32, 1.0, 2.0] {
                let sigma = Vec3::new(x, y, z);
                let s = nearest_with_product(sigma, target.cbrt());
                assert!(s.min_element() > 0.0, "{sigma} {target}: {s}");
                assert!((s.element_product() - target).abs() < 2e-6 * target, "{sigma} {target}: {s}");
                // No point of the set around it is nearer.
                for (a, b) in
                    [(0.01, 0.0), (-0.01, 0.0), (0.0, 0.01), (0.0, -0.01), (0.01, -0.01), (-0.01, 0.01)]
                {
                    let (s0, s1) = (s.x * (1.0 + a), s.y * (1.0 + b));
                    let other = Vec3::new(s0, s1, target / (s0 * s1));
                    assert!(
                        other.distance(sigma) > s.distance(sigma) - 1e-5,
                        "{sigma} {target}: {s} {other}"
                    );
                }
            }
        }
    }

    #[test]
    fn inside_the_range_nothing_is_projected() {
        let tet = TetVolume::rest(REST, 6.0, [0.5, 2.0]).unwrap();
        let scaled = |volume: f32| REST.map(|x| x * volume.cbrt());
        assert_eq!(tet.energy(&scaled(1.5)), 0.0);
        assert_eq!(tet.deviation(&scaled(1.5)), (0.0, [Vec3::ZERO; 4]));
        for volume in [0.4_f32, 2.2] {
            let bound = if volume < 1.0 { 0.5_f32 } else { 2.0 };
            let expected = 0.5 * 3.0 * (volume.cbrt() - bound.cbrt()).powi(2);
            assert!((tet.energy(&scaled(volume)) - expected).abs() < 1e-5, "{volume}");
            let (c, _) = tet.deviation(&scaled(volume));
            assert!((c * 3.0_f32.sqrt() - (volume - bound)).abs() < 1e-5, "{volume}");
        }
    }

    #[test]
    fn near_rest_the_deviation_has_the_energy() {
        let tet = TetVolume::rest(REST, 6.0, [1.0, 1.0]).unwrap();
        for stretch in [Vec3::new(1.02, 1.0, 1.01), Vec3::new(0.99, 1.0, 0.98), Vec3::splat(1.01)] {
            let q = REST.map(|x| x * stretch);
            let (energy, (c, _)) = (tet.energy(&q), tet.deviation(&q));
            assert!((energy - 0.5 * tet.weight * c * c).abs() < 0.05 * energy, "{stretch}: {energy} {c}");
        }
    }

    #[test]
    fn finite_at_every_size() {
        let tet = TetVolume::rest(REST, 6.0, [1.0, 1.0]).unwrap();
        for scale in [0.0, 1e-38, 1e-20, 1e-6, 1e6, 1e12, 1e20, 1e36] {
            for f in [
                [Vec3::X, Vec3::Y, Vec3::Z],
                [Vec3::X, Vec3::Y, -Vec3::Z],
                [Vec3::ONE; 3],
                [Vec3::X, Vec3::Y, Vec3::ONE],
            ] {
                let p = tet.project(f.map(|f| f * scale));
                assert!(p.iter().all(|p| p.is_finite()), "{scale} {f:?} {p:?}");
            }
        }
    }

    /// What [`TetVolume::project`] must give, in f64 by bisection, and how far the nearest is from being one of several: 1 at
    /// rest, 0 where it is.
    fn oracle(f: Mat3, target: f64) -> (DMat3, f64, DVec3) {
        let (u, sigma, v) = mat3::tests::oracle(f);
        let larger = |x: f64, sigma: f64, least: f64| {
            0.5 * (sigma + (sigma * sigma + 4.0 * x * (x - least)).max(0.0).sqrt())
        };
        let at = |x: f64| DVec3::new(larger(x, sigma.x, sigma.z), larger(x, sigma.y, sigma.z), x);
        let is_large = sigma.element_product() > target;
        let (mut low, mut high) = if is_large { (0.0, sigma.z) } else { (sigma.z.max(0.0), target.cbrt()) };
        for _ in 0..200 {
            let x = 0.5 * (low + high);
            (low, high) = if at(x).element_product() > target { (low, x) } else { (x, high) };
        }
        let s = at(high);
        let mu = (s.z - sigma.z) / (s.x * s.y);
        (u * DMat3::from_diagonal(s) * v.transpose(), 1.0 - (mu * s.x).abs(), s)
    }

    #[test]
    fn projection_is_nearest() {
        let mut worst = 0.0_f64;
        let largest = |m: DMat3| m.to_cols_array().into_iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        for (what, f, _) in mat3::tests::samples().into_iter().filter(|(what, ..)| *what != "scaled") {
            for (f, t) in [(f, 1.0), (f, 0.3), (1.5 * f, 1.0), (40.0 * f, 2.0)] {
                let tet = TetVolume::rest(REST, 6.0, [t, t]).unwrap();
                let p = tet.project([f.x_axis, f.y_axis, f.z_axis]).map(Vec3::as_dvec3);
                let p = DMat3::from_cols(p[0], p[1], p[2]);
                let (expected, margin, s) = oracle(f, f64::from(t));
                let scale = s.x;
                let longer = distance(p, f) - distance(expected, f);
                assert!(longer < 4e-6 * scale, "{what}: {f} {t} {longer}");
                let off = (p.determinant() - f64::from(t)).abs() / (s.x * s.x * s.y);
                assert!(off < 1e-5, "{what}: {f} {t} {off}");
                let error = largest(p - expected) / scale;
                worst = worst.max(error * margin);
                assert!(error * margin < 4e-6, "{what}: {f} {t} {error} {margin}");
                assert!(margin < 0.2 || error < 5e-6, "{what}: {f} {t} {error} {margin}");
            }
        }
        println!("largest error {worst:e} over the margin");
    }

    fn distance(p: DMat3, f: Mat3) -> f64 {
        (p - f.as_dmat3()).to_cols_array().into_iter().map(|x| x * x).sum::<f64>().sqrt()
    }

    /// The way without singular values settles nearly all that has one nearest matrix.
    #[test]
    fn hardly_anything_needs_singular_values() {
        let (mut n, mut n_left) = (0, 0);
        for (what, f, _) in mat3::tests::samples() {
            if what != "scaled" && oracle(f, 1.0).1 > 0.5 {
                n += 1;
                n_left += usize::from(!nearest(f.to_cols_array(), [1.0; 2], [1.0; 2]).1);
            }
        }
        println!("{n_left} of {n}");
        assert!(n > 5_000 && n_left * 100 < n, "{n_left} of {n}");
    }

    /// Each with a range of its own; many are inside it.
    #[test]
    fn in_bulk_is_bitwise_one_at_a_time() {
        let f: Vec<[Vec3; 3]> =
            mat3::tests::samples().into_iter().map(|(_, f, _)| [f.x_axis, f.y_axis, f.z_axis]).collect();
        let ranges = [[1.0, 1.0], [0.9, 1.2], [0.01, 0.5], [0.3, 0.3], [1e-6, 1e6]];
        let rests = ranges.map(|range| TetVolume::rest(REST, 6.0, range).unwrap());
        let bits = |p: [Vec3; 3]| p.map(|p| p.to_array().map(f32::to_bits));
        for shift in 0..LANES {
            for length in [0, 1, 7, 8, 9, f.len() - shift] {
                let mut p = f[shift..][..length].to_vec();
                TetVolume::project_all(|k| &rests[k % rests.len()], &mut p);
                for (k, p) in p.into_iter().enumerate() {
                    let expected = rests[k % rests.len()].project(f[shift + k]);
                    assert_eq!(bits(p), bits(expected), "{shift} {k}: {:?}", f[shift + k]);
                }
            }
        }
    }
}
