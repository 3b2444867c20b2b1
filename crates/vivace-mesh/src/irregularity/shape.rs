//! Whether a tetrahedron is good enough, by its dihedral angles.

use glam::DVec3;

/// Limits of the dihedral angles, as cosines (which fall as angles rise).
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    cos_of_min: f64,
    cos_of_max: f64,
}

impl Limits {
    /// From the smallest and the largest angle allowed \[deg\]. A hair stricter, so that no other way to compute an angle finds
    /// it beyond them.
    pub(super) fn new(min_dihedral: f64, max_dihedral: f64) -> Self {
        const HAIR: f64 = 1e-12;
        Self {
            cos_of_min: min_dihedral.to_radians().cos() - HAIR,
            cos_of_max: max_dihedral.to_radians().cos() + HAIR,
        }
    }

    /// Whether a tetrahedron is positively oriented and all its dihedral angles are within the limits.
    pub(super) fn hold(self, [a, b, c, d]: [DVec3; 4]) -> bool {
        let (ab, ac, ad) = (b - a, c - a, d - a);
        // Inward normals of the faces opposite to b, c, d and a, as long as twice their areas: they sum to zero.
        let (nb, nc, nd) = (ac.cross(ad), ad.cross(ab), ab.cross(ac));
        let na = -(nb + nc + nd);
        if nb.dot(ab) <= 0.0 {
            return false;
        }
        let [na, nb, nc, nd] = [na, nb, nc, nd].map(|n| n / n.length());
        [(na, nb), (na, nc), (na, nd), (nb, nc), (nb, nd), (nc, nd)].iter().all(|(one, other)| {
            let cosine = -one.dot(*other);
            self.cos_of_max <= cosine && cosine <= self.cos_of_min
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corner_of_a_cube_has_angles_of_55_and_90_degrees() {
        let corner = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        assert!(Limits::new(54.7, 90.1).hold(corner));
        assert!(!Limits::new(54.8, 90.1).hold(corner));
        assert!(!Limits::new(54.7, 89.9).hold(corner));
        let [a, b, c, d] = corner;
        assert!(!Limits::new(0.0, 180.0).hold([a, b, d, c]));
        assert!(!Limits::new(0.0, 180.0).hold([a, b, c, c]));
    }
}
