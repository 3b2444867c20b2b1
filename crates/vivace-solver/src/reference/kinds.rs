//! Projections of the kinds of constraints in `f64`.

use glam::{DMat3, DVec3};
use vivace_kernels::constraint::{
    Attachment, Bending, Constraint, Spring, TetStrain, TetVolume, TriangleStrain,
};

use super::svd::svd;

/// A kind, projected in `f64`.
pub(crate) trait Exact<const N: usize, const R: usize>: Constraint<N, R> {
    /// p, as [`Constraint::project`].
    fn project_exactly(&self, aq: [DVec3; R]) -> [DVec3; R];
}

/// The point at distance `radius` from 0 nearest to `d`; 0 where d is.
fn on_sphere(d: DVec3, radius: f32) -> DVec3 {
    let length = d.length();
    if length > 0.0 { d * (f64::from(radius) / length) } else { DVec3::ZERO }
}

impl Exact<2, 1> for Spring {
    fn project_exactly(&self, [d]: [DVec3; 1]) -> [DVec3; 1] {
        [on_sphere(d, self.rest)]
    }
}

impl Exact<1, 1> for Attachment {
    fn project_exactly(&self, _aq: [DVec3; 1]) -> [DVec3; 1] {
        [self.target.as_dvec3()]
    }
}

impl Exact<4, 1> for Bending {
    fn project_exactly(&self, [d]: [DVec3; 1]) -> [DVec3; 1] {
        [on_sphere(d, self.rest)]
    }
}

impl Exact<3, 2> for TriangleStrain {
    /// Singular values clamped to 1 ± limit (Bouaziz et al. 2014, section 5.2).
    fn project_exactly(&self, [a, b]: [DVec3; 2]) -> [DVec3; 2] {
        let (u, sigma, v) = svd(DMat3::from_cols(a, b, DVec3::ZERO));
        let limit = f64::from(self.limit);
        let sigma = sigma.clamp(DVec3::splat(1.0 - limit), DVec3::splat(1.0 + limit));
        let p = u * DMat3::from_diagonal(sigma.with_z(0.0)) * v.transpose();
        [p.x_axis, p.y_axis]
    }
}

impl Exact<4, 3> for TetStrain {
    /// The nearest rotation.
    fn project_exactly(&self, [x, y, z]: [DVec3; 3]) -> [DVec3; 3] {
        let r = nearest_rotation(DMat3::from_cols(x, y, z));
        [r.x_axis, r.y_axis, r.z_axis]
    }
}

/// By Newton's iteration for the polar factor (Higham 1986), which is many times faster than singular values and as exact where f is
/// neither inverted nor nearly flat.
fn nearest_rotation(f: DMat3) -> DMat3 {
    const STEPS: usize = 12;
    let mut r = f;
    let n_steps = if f.determinant() > 1e-2 { STEPS } else { 0 };
    for _ in 0..n_steps {
        let DMat3 { x_axis: x, y_axis: y, z_axis: z } = r;
        let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
        let next = 0.5 * (r + cofactors * (1.0 / x.dot(cofactors.x_axis)));
        let change = (next - r).to_cols_array().iter().fold(0.0_f64, |most, d| most.max(d.abs()));
        r = next;
        // Quadratic: the step after this one would change nothing.
        if change < 1e-9 {
            return r;
        }
    }
    let (u, _, v) = svd(f);
    u * v.transpose()
}

impl Exact<4, 3> for TetVolume {
    /// The nearest matrix with a determinant in the range (Bouaziz et al. 2014, section 5.4).
    fn project_exactly(&self, [x, y, z]: [DVec3; 3]) -> [DVec3; 3] {
        let f = DMat3::from_cols(x, y, z);
        let (det, [least, most]) = (f.determinant(), self.range.map(f64::from));
        if det >= least && det <= most {
            return [x, y, z];
        }
        let (u, sigma, v) = svd(f);
        let p = u * DMat3::from_diagonal(with_product(sigma, det.clamp(least, most))) * v.transpose();
        [p.x_axis, p.y_axis, p.z_axis]
    }
}

/// The values nearest to `sigma`, sorted as by [`svd`], whose product is `target` > 0: s_i (s_i − σ_i) is the same m for all i
/// there. With m = x (x − σ₂) from x = s₂ the product is one equation in x, which grows; solved by Newton's steps, or by halves where
/// those lead out of the bracket.
fn with_product(sigma: DVec3, target: f64) -> DVec3 {
    let at = |x: f64| {
        let four_m = 4.0 * x * (x - sigma.z);
        let larger = |s: f64| 0.5 * (s + (s * s + four_m).max(0.0).sqrt());
        DVec3::new(larger(sigma.x), larger(sigma.y), x)
    };
    let is_large = sigma.element_product() > target;
    let (mut low, mut high) = if is_large { (0.0, sigma.z) } else { (sigma.z.max(0.0), target.cbrt()) };
    let mut x = if is_large { sigma.z } else { high };
    loop {
        let s = at(x);
        let off = s.element_product() - target;
        if off > 0.0 {
            high = x;
        } else {
            low = x;
        }
        // ds/dm = 1/(2s − σ), dm/dx = 2x − σ₂.
        let others = s.y / (2.0 * s.x - sigma.x) + s.x / (2.0 * s.y - sigma.y);
        let slope = s.x * s.y + x * (2.0 * x - sigma.z) * others;
        let newton = x - off / slope;
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        if (next - x).abs() <= f64::EPSILON * x.abs() || next <= low || next >= high {
            return at(next);
        }
        x = next;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    const REST: [Vec3; 4] =
        [Vec3::ZERO, Vec3::new(1.0, 0.1, 0.0), Vec3::new(0.2, 0.9, 0.1), Vec3::new(-0.1, 0.2, 1.1)];
    const F: [DVec3; 3] = [DVec3::new(1.3, 0.2, -0.1), DVec3::new(0.1, 0.6, 0.4), DVec3::new(-0.2, 0.1, 1.2)];

    /// The kernels' own projections, which are tested on their own, to the digits of `f32`.
    fn agree<C: Exact<N, R>, const N: usize, const R: usize>(rest: &C, aq: [DVec3; R]) {
        let expected = rest.project(aq.map(DVec3::as_vec3));
        for (p, expected) in rest.project_exactly(aq).iter().zip(expected) {
            assert!((p.as_vec3() - expected).length() < 5e-6, "{}: {p} {expected}", C::NAME);
        }
    }

    #[test]
    fn projections_are_those_of_the_kernels() {
        let [x, y, z] = F;
        for aq in [[x, y, z], [y, z, x], [x, y, -z], [0.2 * x, y, 3.0 * z], [x, y, x + y + 1e-3 * z]] {
            let triangle = [REST[0], REST[1], REST[2]];
            agree(&Spring { rest: 1.5, stiffness: 1.0 }, [aq[0]]);
            agree(&Bending::rest(REST, 1.0).unwrap(), [aq[0]]);
            agree(&Bending::flat(REST, 1.0).unwrap(), [aq[0]]);
            agree(&TriangleStrain::rest(triangle, 1.0, 0.1).unwrap(), [aq[0], aq[1]]);
            agree(&TriangleStrain::rest(triangle, 1.0, 0.0).unwrap(), [aq[0], aq[1]]);
            agree(&TetStrain::rest(REST, 1.0).unwrap(), aq);
            agree(&TetVolume::rest(REST, 1.0, [0.95, 1.05]).unwrap(), aq);
            agree(&TetVolume::rest(REST, 1.0, [0.3, 0.5]).unwrap(), aq);
        }
    }

    #[test]
    fn nearest_rotations_are_those_of_singular_values() {
        let f = DMat3::from_cols(F[0], F[1], F[2]);
        let stretched = f * DMat3::from_diagonal(DVec3::new(8.0, 0.3, 1.0));
        for f in [f, stretched, f.transpose() * 40.0, f * 0.3, f * 1e-3, -f, DMat3::IDENTITY] {
            let (u, _, v) = svd(f);
            let (found, expected) = (nearest_rotation(f), u * v.transpose());
            assert!(found.abs_diff_eq(expected, 1e-14), "{f}: {found} {expected}");
        }
    }

    #[test]
    fn nearest_product_is_stationary() {
        for (sigma, target) in [
            (DVec3::new(1.3, 1.0, 0.4), 1.0),
            (DVec3::new(1.6, 1.2, 0.9), 1.05),
            (DVec3::new(1.0, 1.0, 0.94999), 0.95),
            (DVec3::new(2.0, 0.5, -0.7), 0.95),
            (DVec3::new(0.9, 1e-3, 1e-4), 0.95),
        ] {
            let s = with_product(sigma, target);
            let m = s * (s - sigma);
            assert!((s.element_product() - target).abs() < 1e-14, "{s}");
            assert!((m - m.x).abs().max_element() < 1e-14, "{m}");
        }
    }

    #[test]
    fn degenerate_matrices_stay_finite() {
        let zero = [DVec3::ZERO; 3];
        for aq in [zero, [F[0], DVec3::ZERO, DVec3::ZERO], [F[0], F[0], F[0]]] {
            for p in TetStrain::rest(REST, 1.0).unwrap().project_exactly(aq) {
                assert!((p.length() - 1.0).abs() < 1e-12, "{p}");
            }
            let volume = TetVolume::rest(REST, 1.0, [1.0, 1.0]).unwrap().project_exactly(aq);
            assert!((volume[0].cross(volume[1]).dot(volume[2]) - 1.0).abs() < 1e-9, "{volume:?}");
        }
    }
}
