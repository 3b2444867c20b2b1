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
        let (u, _, v) = svd(DMat3::from_cols(x, y, z));
        let r = u * v.transpose();
        [r.x_axis, r.y_axis, r.z_axis]
    }
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
/// there. With m = x (x − σ₂) from x = s₂ the product is one equation in x, solved by bisection.
fn with_product(sigma: DVec3, target: f64) -> DVec3 {
    let at = |x: f64| {
        let four_m = 4.0 * x * (x - sigma.z);
        let larger = |s: f64| 0.5 * (s + (s * s + four_m).max(0.0).sqrt());
        DVec3::new(larger(sigma.x), larger(sigma.y), x)
    };
    let is_large = sigma.element_product() > target;
    let (mut low, mut high) = if is_large { (0.0, sigma.z) } else { (sigma.z.max(0.0), target.cbrt()) };
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return at(middle);
        }
        if at(middle).element_product() > target {
            high = middle;
        } else {
            low = middle;
        }
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
    fn nearest_product_is_stationary() {
        for (sigma, target) in [(DVec3::new(1.3, 1.0, 0.4), 1.0), (DVec3::new(1.6, 1.2, 0.9), 1.05)] {
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
