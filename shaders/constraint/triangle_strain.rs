//! A triangle whose strain is limited (Bouaziz et al. 2014, Sec. 5.2).
//!
//! A q = F, the 3 × 2 deformation gradient from the plane of the triangle at rest (row r of A gives its column r), p = F with
//! singular values clamped to \[1 − limit, 1 + limit\]: W = w/2 ‖F − p‖², w = stiffness × area at rest. A limit of 0 asks for
//! an isometry.

use bytemuck::{Pod, Zeroable};
use glam::{DVec2, Vec3};

use super::{APPLY, BLOCK, Constraint, DEVIATION};
use crate::mat3::{self, frame, jacobi};

/// The rest data of a triangle.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct TriangleStrain {
    /// Columns of A \[1/m\], by particle.
    pub columns: [[f32; 2]; 3],
    /// w \[J\]: stiffness \[N/m\] × area at rest \[m²\].
    pub weight: f32,
    /// The strain that costs nothing \[1\], at least 0.
    pub limit: f32,
}

impl TriangleStrain {
    /// A triangle of `stiffness` \[N/m\] that is at rest at `x` \[m\] and may stretch or shrink by the fraction `limit`.
    /// `None` if it has no area.
    #[must_use]
    pub fn rest(x: [Vec3; 3], stiffness: f32, limit: f32) -> Option<Self> {
        let x = x.map(Vec3::as_dvec3);
        let (e1, e2) = (x[1] - x[0], x[2] - x[0]);
        let twice = e1.cross(e2).length();
        let has_area = twice > 1e-7 * e1.length_squared().max(e2.length_squared());
        if !has_area {
            return None;
        }
        // With the first edge along the x axis: X_1 = (l, 0), X_2 = (a, twice/l).
        let length = e1.length();
        let d1 = DVec2::new(1.0 / length, -e1.dot(e2) / (length * twice));
        let d2 = DVec2::new(0.0, length / twice);
        let columns = [-(d1 + d2), d1, d2].map(DVec2::as_vec2);
        let weight = DVec2::new(f64::from(stiffness) * 0.5 * twice, 0.0).as_vec2().x;
        let is_finite = columns.iter().all(|d| d.is_finite()) && weight.is_finite();
        is_finite.then(|| Self { columns: columns.map(|d| d.to_array()), weight, limit })
    }
}

impl Constraint<3, 2> for TriangleStrain {
    const NAME: &'static str = "triangle_strain";
    const WGSL: &'static [&'static str] =
        &[mat3::WGSL, APPLY, BLOCK, DEVIATION, include_str!("triangle_strain.wgsl")];
    type Multiplier = f32;

    #[inline]
    fn weight(&self) -> f32 {
        self.weight
    }

    #[inline]
    fn column(&self, slot: usize) -> [f32; 2] {
        self.columns[slot]
    }

    /// Two columns are made orthogonal by one Jacobi rotation; they are then u_i σ_i.
    #[inline]
    fn project(&self, [a, b]: [Vec3; 2]) -> [Vec3; 2] {
        let clamp = |sigma: f32| sigma.min(1.0 + self.limit).max(1.0 - self.limit);
        let given = [a, b];
        let (c, s) = jacobi(a, b).unwrap_or((1.0, 0.0));
        let (a, b) = (c * a - s * b, s * a + c * b);
        if [a.length(), b.length()].iter().all(|&sigma| clamp(sigma) == sigma) {
            // Within the limit nothing is projected, not even by rounding.
            return given;
        }
        let (u, v) = if a.length_squared() >= b.length_squared() {
            frame(a, b).into()
        } else {
            let [v, u] = frame(b, a);
            (u, v)
        };
        let (a, b) = (u * clamp(a.length()), v * clamp(b.length()));
        [c * a + s * b, c * b - s * a]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const REST: [Vec3; 3] = [Vec3::ONE, Vec3::new(2.0, 1.0, 1.0), Vec3::new(1.3, 2.0, 1.0)];

    #[test]
    fn strain_beyond_the_limit_costs() {
        let triangle = TriangleStrain::rest(REST, 4.0, 0.1).unwrap();
        assert!((triangle.weight - 2.0).abs() < 1e-6);
        for (stretch, excess) in [(1.05, 0.0), (0.95, 0.0), (1.3, 0.2), (0.7, -0.2)] {
            let q = REST.map(|x| x * Vec3::new(stretch, 1.0, 1.0));
            assert!((triangle.energy(&q) - excess * excess).abs() < 1e-6, "{stretch}");
        }
    }

    #[test]
    fn isometry_is_orthonormal_whatever_the_triangle() {
        let triangle = TriangleStrain::rest(REST, 4.0, 0.0).unwrap();
        for scale in [0.0, 1e-38, 1e-20, 1e-3, 1.0, 1e3, 1e15, 1e30] {
            for [a, b] in
                [[Vec3::X, Vec3::Y], [Vec3::ONE, Vec3::ONE], [Vec3::ONE, Vec3::ZERO], [Vec3::X, Vec3::ONE]]
            {
                let [p, q] = triangle.project([a * scale, b * scale]);
                let error = (p.length() - 1.0).abs() + (q.length() - 1.0).abs() + p.dot(q).abs();
                assert!(error < 3e-6, "{scale} {a} {b}: {p} {q}");
            }
        }
    }

    #[test]
    fn without_area_there_is_no_gradient() {
        assert_eq!(TriangleStrain::rest([Vec3::ZERO, Vec3::X, 2.0 * Vec3::X], 1.0, 0.0), None);
        assert_eq!(TriangleStrain::rest([Vec3::ONE; 3], 1.0, 0.0), None);
    }
}
