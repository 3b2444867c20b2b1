//! Bending of two triangles that share an edge (Bergou et al. 2006, quadratic for isometric motion).
//!
//! Of the particles \[e0, e1, o0, o1\] the first two are the shared edge and the others lie opposite to it. A is the row
//! K = \[c₀₃ + c₀₄, c₀₁ + c₀₂, −c₀₁ − c₀₃, −c₀₂ − c₀₄\] of cotangents of the angles at the edge, p = n (A q)/|A q|:
//!
//! ```text
//! W = k/2 · 3/(A₀ + A₁) · (|K q| − n)²
//! ```
//!
//! For triangles that only bend, |K q| is the length of the edge times 2 sin(θ/2), θ the angle between the normals. n is its
//! value at rest: 0 for flat, and then W is quadratic. For a curved rest n > 0 has the length of K q only, not its direction, so
//! W is invariant under rotation; nor does W know which way the hinge is folded.

use bytemuck::{Pod, Zeroable};
use glam::{DVec2, DVec3, DVec4, Mat3, Vec3, Vec4};
use wide::f32x4;

use super::{APPLY, BATCH, Constraint, Residuals};
use crate::lanes::{Lanes3, each};

/// The rest data of a hinge.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Bending {
    /// The row K of cotangents \[1\].
    pub row: [f32; 4],
    /// n = |K q| at rest \[m\].
    pub rest: f32,
    /// w = 3 k/(A₀ + A₁) \[N/m\], where k \[J\] is the stiffness and A₀, A₁ \[m²\] are the areas.
    pub weight: f32,
}

impl Bending {
    /// A hinge of `stiffness` \[J\] that is at rest as bent as it is at `x` \[m\]. `None` if a triangle has no area.
    #[must_use]
    pub fn rest(x: [Vec3; 4], stiffness: f32) -> Option<Self> {
        Self::new(x, stiffness, 1.0)
    }

    /// A hinge of `stiffness` \[J\] whose triangles have the shape of those at `x` \[m\], but lie flat at rest.
    #[must_use]
    pub fn flat(x: [Vec3; 4], stiffness: f32) -> Option<Self> {
        Self::new(x, stiffness, 0.0)
    }

    fn new(x: [Vec3; 4], stiffness: f32, curved: f64) -> Option<Self> {
        let x = x.map(Vec3::as_dvec3);
        let [e0, e1, e2] = [x[1] - x[0], x[2] - x[0], x[3] - x[0]];
        let [e3, e4] = [x[2] - x[1], x[3] - x[1]];
        let (twice0, twice1) = (e0.cross(e1).length(), e0.cross(e2).length());
        let longest = e0.length_squared().max(e1.length_squared()).max(e2.length_squared());
        let has_area = twice0.min(twice1) > 1e-7 * longest;
        if !has_area {
            return None;
        }
        let cot = |a: DVec3, b: DVec3, twice: f64| a.dot(b) / twice;
        let (c01, c02) = (cot(e0, e1, twice0), cot(e0, e2, twice1));
        let (c03, c04) = (cot(-e0, e3, twice0), cot(-e0, e4, twice1));
        let row = DVec4::new(c03 + c04, c01 + c02, -c01 - c03, -c02 - c04);
        // In single precision what is flat is bent by rounding: it shall be linear all the same.
        let bent = row.y * e0 + row.z * e1 + row.w * e2;
        let bent =
            if bent.length() > 1e-6 * longest.sqrt() * row.abs().max_element() { bent.length() } else { 0.0 };
        let weight = f64::from(stiffness) * 6.0 / (twice0 + twice1);
        let [rest, weight] = DVec2::new(curved * bent, weight).as_vec2().to_array();
        let row = row.as_vec4();
        (row.is_finite() && rest.is_finite() && weight.is_finite()).then(|| Self {
            row: row.to_array(),
            rest,
            weight,
        })
    }
}

impl Constraint<4, 1> for Bending {
    const NAME: &'static str = "bending";
    const WGSL: &'static [&'static str] = &[APPLY, include_str!("bending.wgsl")];
    type Multiplier = Vec4;

    #[inline]
    fn weight(&self) -> f32 {
        self.weight
    }

    #[inline]
    fn column(&self, slot: usize) -> [f32; 1] {
        [self.row[slot]]
    }

    #[inline]
    fn project(&self, [d]: [Vec3; 1]) -> [Vec3; 1] {
        // Flat on a curved rest has no direction to bend in, as the coincident ends of a spring.
        [d.try_normalize().unwrap_or(Vec3::ZERO) * self.rest]
    }

    #[inline]
    fn is_linear(&self) -> bool {
        self.rest == 0.0
    }

    /// As that of a spring of rest length n along K q.
    #[inline]
    fn block(&self, q: &[Vec3; 4], slot: usize) -> Mat3 {
        let [d] = self.apply(q);
        let stiffness = self.entry(slot, slot);
        let (Some(u), true) = (d.try_normalize(), self.rest > 0.0) else {
            return Mat3::from_diagonal(Vec3::splat(stiffness));
        };
        let across = (1.0 - self.rest / d.length()).max(0.0);
        let along = stiffness * (1.0 - across);
        Mat3::from_cols(u * (along * u.x), u * (along * u.y), u * (along * u.z))
            + Mat3::from_diagonal(Vec3::splat(stiffness * across))
    }

    /// C = |K q| − n, signed.
    #[inline]
    fn deviation(&self, q: &[Vec3; 4]) -> (f32, [Vec3; 4]) {
        let [d] = self.apply(q);
        let u = d.try_normalize().unwrap_or(Vec3::ZERO);
        (d.length() - self.rest, self.row.map(|k| k * u))
    }

    #[inline]
    fn residuals(rest: &[Self; BATCH], q: &[Lanes3<f32x4>; 4]) -> Option<Residuals<4>> {
        let k = |slot: usize| each(rest, |rest| rest.row[slot]);
        let row = [k(0), k(1), k(2), k(3)];
        let d = (q[1] - q[0]) * row[1] + (q[2] - q[0]) * row[2] + (q[3] - q[0]) * row[3];
        if rest.iter().all(Self::is_linear) {
            return Some(Residuals { r: d, row });
        }
        let off = f32x4::ONE - each(rest, |rest| rest.rest) / d.length();
        Some(Residuals { r: d * off, row })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two right isosceles triangles of legs 1 on the edge along x, the second folded up by `angle`.
    fn hinge(angle: f32) -> [Vec3; 4] {
        [Vec3::ZERO, Vec3::X, Vec3::NEG_Y, Vec3::new(0.0, angle.cos(), angle.sin())]
    }

    #[test]
    fn energy_is_that_of_the_angle() {
        // cot 45° = 1 and cot 90° = 0: K = [2, 0, −1, −1], K q = (0, 1 − cos θ, −sin θ), |K q| = 2 sin(θ/2), areas 1/2 each.
        let flat = Bending::flat(hinge(1.2), 5.0).unwrap();
        for (k, expected) in flat.row.into_iter().zip([2.0, 0.0, -1.0, -1.0]) {
            assert!((k - expected).abs() < 1e-6, "{flat:?}");
        }
        for angle in [0.0_f32, 0.3, 1.0, -2.0] {
            let expected = 0.5 * 5.0 * 3.0 * (2.0 * (0.5 * angle).sin()).powi(2);
            assert!((flat.energy(&hinge(angle)) - expected).abs() < 1e-5 * (1.0 + expected), "{angle}");
        }
    }

    #[test]
    fn flat_is_linear_and_curved_is_not() {
        assert!(Bending::rest(hinge(0.0), 1.0).unwrap().is_linear());
        assert!(Bending::flat(hinge(0.5), 1.0).unwrap().is_linear());
        let curved = Bending::rest(hinge(0.5), 1.0).unwrap();
        assert!(!curved.is_linear() && (curved.rest - 2.0 * 0.25_f32.sin()).abs() < 1e-6);
    }

    #[test]
    fn triangles_without_area_have_no_hinge() {
        let [a, b, c, _] = hinge(0.0);
        assert_eq!(Bending::rest([a, b, c, 0.5 * b], 1.0), None);
        assert_eq!(Bending::flat([a, a, c, b], 1.0), None);
        assert_eq!(Bending::flat([a; 4], 1.0), None);
    }
}
