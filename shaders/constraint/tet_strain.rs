//! A tetrahedron that keeps its shape (as rigid as possible; Bouaziz et al. 2014, Sec. 5.2, without bounds).
//!
//! A q = F, the deformation gradient (row r of A gives its column r), p = R, the rotation nearest to it:
//! W = w/2 ‖F − R‖², w = stiffness × volume at rest. In linear elasticity that is ‖ε‖² times w/2: a Lamé parameter μ of half
//! the stiffness, and λ = 0.

use bytemuck::{Pod, Zeroable, cast_slice_mut};
use glam::{DMat3, DVec2, DVec3, Mat3, Vec3};

use super::{APPLY, Constraint, DEVIATION};
use crate::mat3::{self, rotation, rotations, svd};

/// The rest data of a tetrahedron.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct TetStrain {
    /// Columns of A \[1/m\], by particle.
    pub columns: [[f32; 3]; 4],
    /// w \[J\]: stiffness \[Pa\] × volume at rest \[m³\].
    pub weight: f32,
}

impl TetStrain {
    /// A tetrahedron of `stiffness` \[Pa\] that is at rest at `x` \[m\], of either orientation. `None` if it is flat.
    #[must_use]
    pub fn rest(x: [Vec3; 4], stiffness: f32) -> Option<Self> {
        let (columns, weight) = gradient(x, stiffness)?;
        Some(Self { columns, weight })
    }
}

/// The columns of the A for which A q is the deformation gradient from `x`, and `stiffness` times the volume. `None` if flat.
pub(super) fn gradient(x: [Vec3; 4], stiffness: f32) -> Option<([[f32; 3]; 4], f32)> {
    let x = x.map(Vec3::as_dvec3);
    let edges = DMat3::from_cols(x[1] - x[0], x[2] - x[0], x[3] - x[0]);
    let det = edges.determinant();
    let longest = edges.x_axis.length().max(edges.y_axis.length()).max(edges.z_axis.length());
    let is_solid = det.abs() > 1e-9 * longest * longest * longest;
    if !is_solid {
        return None;
    }
    // F = Σ_j (q_j − q_0) d_jᵀ, d_j row j of the inverse.
    let d = edges.inverse().transpose();
    let first = -(d.x_axis + d.y_axis + d.z_axis);
    let columns = [first, d.x_axis, d.y_axis, d.z_axis].map(DVec3::as_vec3);
    let [weight, _] = DVec2::new(f64::from(stiffness) * det.abs() / 6.0, 0.0).as_vec2().to_array();
    (columns.iter().all(|d| d.is_finite()) && weight.is_finite())
        .then(|| (columns.map(|d| d.to_array()), weight))
}

impl Constraint<4, 3> for TetStrain {
    const NAME: &'static str = "tet_strain";
    const WGSL: &'static [&'static str] = &[mat3::WGSL, APPLY, DEVIATION, include_str!("tet_strain.wgsl")];
    type Multiplier = f32;

    #[inline]
    fn weight(&self) -> f32 {
        self.weight
    }

    #[inline]
    fn column(&self, slot: usize) -> [f32; 3] {
        self.columns[slot]
    }

    #[inline]
    fn project(&self, [x, y, z]: [Vec3; 3]) -> [Vec3; 3] {
        let r = rotation(Mat3::from_cols(x, y, z));
        [r.x_axis, r.y_axis, r.z_axis]
    }

    fn project_all<'a>(_rest: impl Fn(usize) -> &'a Self, aq: &mut [[Vec3; 3]]) {
        rotations(cast_slice_mut(aq));
    }

    /// w (I − Σ λ_k t_k t_kᵀ) for each direction of motion (Smith, de Goes and Kim 2019): F resists every change but the three
    /// twists t_k, to which the rotation yields at λ_k = 2/(σ_i + σ_j). Under compression λ_k > 1 and W curves down; λ_k ≤ 1
    /// here keeps the block positive semi-definite.
    fn block(&self, q: &[Vec3; 4], slot: usize) -> Mat3 {
        let [x, y, z] = self.apply(q);
        let (u, sigma, v) = svd(Mat3::from_cols(x, y, z));
        let column = Vec3::from_array(self.columns[slot]);
        let along = v.transpose() * column;
        let mut block = Mat3::from_diagonal(Vec3::splat(column.length_squared()));
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            // λ t tᵀ with t = (u_i v_jᵀ − u_j v_iᵀ) column/√2. No pair of σ has a negative sum, since only the least may be < 0.
            let t = u.col(i) * along[j] - u.col(j) * along[i];
            let half = 1.0 / (sigma[i] + sigma[j]).max(2.0);
            block -= Mat3::from_cols(t * (half * t.x), t * (half * t.y), t * (half * t.z));
        }
        block * self.weight
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const REST: [Vec3; 4] =
        [Vec3::ZERO, Vec3::new(1.0, 0.1, 0.0), Vec3::new(0.2, 0.9, 0.1), Vec3::new(-0.1, 0.2, 1.1)];

    #[test]
    fn a_stretch_has_the_energy_of_its_strain() {
        let tet = TetStrain::rest(REST, 12.0).unwrap();
        let volume = (REST[1].cross(REST[2])).dot(REST[3]) / 6.0;
        assert!((tet.weight - 12.0 * volume).abs() < 1e-5);
        let stretch = Vec3::new(1.2, 1.0, 0.7);
        let expected = 0.5 * 12.0 * volume * (0.04 + 0.09);
        assert!((tet.energy(&REST.map(|x| x * stretch)) - expected).abs() < 1e-5);
    }

    #[test]
    fn block_is_the_derivative_of_the_gradient_under_tension() {
        let tet = TetStrain::rest(REST, 6.0).unwrap();
        let turn = Mat3::from_rotation_x(0.7) * Mat3::from_rotation_z(-1.1);
        let q = REST.map(|x| turn * (x * Vec3::new(1.3, 1.6, 1.1)) + Vec3::ONE);
        let step = 1e-2;
        for slot in 0..4 {
            let block = tet.block(&q, slot);
            for axis in 0..3 {
                let at = |e: f32| {
                    let mut q = q;
                    q[slot][axis] += e;
                    tet.pull(slot, &tet.residual(&q))
                };
                let difference = (at(step) - at(-step)) / (2.0 * step);
                assert!(
                    (block.col(axis) - difference).length() < 1e-3,
                    "{slot} {axis}: {block} {difference}"
                );
            }
        }
    }

    #[test]
    fn flat_has_no_gradient() {
        assert_eq!(TetStrain::rest([Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::new(0.3, 0.4, 0.0)], 1.0), None);
        assert_eq!(TetStrain::rest([Vec3::ONE; 4], 1.0), None);
        let [a, b, c, d] = REST;
        assert!(TetStrain::rest([a, c, b, d], 1.0).unwrap().weight > 0.0);
    }
}
