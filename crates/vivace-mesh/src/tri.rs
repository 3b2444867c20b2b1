//! What a triangle mesh is made of: edges, hinges, boundary, components; area, volume, and whether it bounds a volume.

use glam::DVec3;

use crate::topology::{self, Side, Sides, edge_key};
use crate::{MeshError, TriMesh};

/// A triangle is flat if twice its area is not above this times the square of its longest edge \[1\].
pub(crate) const FLAT_TRIANGLE: f64 = 1e-6;

/// Triangles that name a vertex twice have no edges: in none of these is there a self edge, nor any edge of such a triangle.
impl TriMesh {
    /// Each edge once, lower vertex first, ascending.
    pub fn edges(&self) -> Vec<[u32; 2]> {
        let proper = self.triangles().iter().filter(|t| crate::mesh::repeated(*t).is_none());
        let keys = proper.flat_map(|&[a, b, c]| [edge_key(a, b), edge_key(b, c), edge_key(c, a)]);
        topology::distinct_edges(keys.collect())
    }

    /// `[e0, e1, o0, o1]` for each edge of exactly two triangles, in the order of [`TriMesh::edges`].
    ///
    /// ```text
    ///         o0           (e0, e1, o0) runs as the first of the two triangles does, so its normal is
    ///        /  \          (e1 - e0) × (o0 - e0); the second runs (e1, e0, o1) where the two are
    ///      e0 -> e1        oriented alike
    ///        \  /
    ///         o1
    /// ```
    ///
    /// No hinge: edges of more than two triangles, and two triangles with the same three vertices. Both are counted in
    /// [`TriReport`](crate::TriReport).
    pub fn hinges(&self) -> Vec<[u32; 4]> {
        let triangles = self.triangles();
        let hinge = |edge: &[Side]| match *edge {
            [first, second] => {
                let ([e0, e1, o0], [_, _, o1]) = (first.vertices(triangles), second.vertices(triangles));
                (o0 != o1).then_some([e0, e1, o0, o1])
            }
            _ => None,
        };
        Sides::of(triangles).edges().filter_map(hinge).collect()
    }

    /// The edges of exactly one triangle, `[from, to]` as that triangle runs, in the order of [`TriMesh::edges`].
    pub fn boundary_edges(&self) -> Vec<[u32; 2]> {
        let triangles = self.triangles();
        let boundary = |edge: &[Side]| match *edge {
            [side] => Some([side.vertices(triangles)[0], side.vertices(triangles)[1]]),
            _ => None,
        };
        Sides::of(triangles).edges().filter_map(boundary).collect()
    }

    /// How many edges end at each vertex; 0 for an isolated one.
    pub fn degrees(&self) -> Vec<u32> {
        topology::degrees(self.positions().len(), &self.edges())
    }

    /// The component of each vertex, numbered from 0 in the order of their lowest vertices. An isolated vertex is one by
    /// itself.
    pub fn components(&self) -> Vec<u32> {
        topology::components(self.positions().len(), self.edges())
    }

    /// Area of each triangle \[m^2\].
    pub fn areas(&self) -> Vec<f64> {
        (0..self.triangles().len()).map(|t| area(self.triangle_corners(t))).collect()
    }

    /// The volume enclosed [m^3]: positive if the triangles run counter-clockwise seen from outside.
    ///
    /// Of an open mesh it is what the cone from the middle of its bounding box encloses.
    pub fn signed_volume(&self) -> f64 {
        let [low, high] = bounds(self.positions());
        let middle = (low + high) * 0.5;
        let cone = |t| {
            let [a, b, c] = self.triangle_corners(t).map(|p| p - middle);
            a.dot(b.cross(c)) / 6.0
        };
        (0..self.triangles().len()).map(cone).sum()
    }

    /// Whether this surface bounds a volume: closed, each edge in two triangles that run along it in opposite directions, one
    /// fan of triangles about each vertex, and a positive volume inside. Several components, and cavities, are allowed.
    ///
    /// # Errors
    /// [`MeshError::NotAVolumeBoundary`] names the first fault found.
    pub fn check_volume_boundary(&self) -> Result<(), MeshError> {
        match self.boundary_fault() {
            Some(fault) => Err(MeshError::NotAVolumeBoundary { fault }),
            None => Ok(()),
        }
    }

    fn boundary_fault(&self) -> Option<String> {
        let triangles = self.triangles();
        if triangles.is_empty() {
            return Some("there are no triangles".to_owned());
        }
        if let Some(t) = triangles.iter().position(|t| crate::mesh::repeated(t).is_some()) {
            return Some(format!("triangle {t} names a vertex twice"));
        }
        let sides = Sides::of(triangles);
        if let Some(fault) = sides.edges().find_map(|edge| edge_fault(triangles, edge)) {
            return Some(fault);
        }
        if let Some(vertex) =
            topology::nonmanifold_vertices(self.positions().len(), triangles, &sides).first()
        {
            return Some(format!("at vertex {vertex} separate fans of triangles touch"));
        }
        let volume = self.signed_volume();
        if volume > 0.0 {
            None
        } else {
            Some(format!("its volume is {volume:.3e} m^3; flip the triangles if it is inside out"))
        }
    }

    /// The corners of one triangle \[m\].
    pub(crate) fn triangle_corners(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles()[triangle].map(|v| self.positions()[v as usize].as_dvec3())
    }
}

fn edge_fault(triangles: &[[u32; 3]], edge: &[Side]) -> Option<String> {
    let [start, end, _] = edge.first()?.vertices(triangles);
    let (a, b) = (start.min(end), start.max(end));
    match *edge {
        [side] => {
            Some(format!("edge {a}-{b} has triangle {} on one side and none on the other", side.triangle()))
        }
        [one, other] if one.vertices(triangles)[0] == other.vertices(triangles)[0] => Some(format!(
            "triangles {} and {} run along edge {a}-{b} in the same direction",
            one.triangle(),
            other.triangle()
        )),
        [_, _] => None,
        _ => {
            let named: Vec<String> = edge.iter().take(8).map(|s| s.triangle().to_string()).collect();
            let more = if edge.len() > named.len() { ", ..." } else { "" };
            Some(format!("edge {a}-{b} has {} triangles ({}{more})", edge.len(), named.join(", ")))
        }
    }
}

pub(crate) fn area([a, b, c]: [DVec3; 3]) -> f64 {
    0.5 * (b - a).cross(c - a).length()
}

/// Whether a triangle has no area to speak of: see [`FLAT_TRIANGLE`].
pub(crate) fn is_flat([a, b, c]: [DVec3; 3]) -> bool {
    let longest_squared =
        (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
    2.0 * area([a, b, c]) <= FLAT_TRIANGLE * longest_squared
}

/// The smallest of the three angles \[deg\].
pub(crate) fn min_angle(corners: [DVec3; 3]) -> f64 {
    let angle = |k: usize| {
        let [at, left, right] = [0, 1, 2].map(|i| corners[(k + i) % 3]);
        let (left, right) = (left - at, right - at);
        left.cross(right).length().atan2(left.dot(right)).to_degrees()
    };
    angle(0).min(angle(1)).min(angle(2))
}

/// The lowest and the highest corner of the box around the positions \[m\]; zero for none.
pub(crate) fn bounds(positions: &[glam::Vec3]) -> [DVec3; 2] {
    let start = positions.first().copied().unwrap_or_default();
    let (low, high) = positions.iter().fold((start, start), |(low, high), &p| (low.min(p), high.max(p)));
    [low.as_dvec3(), high.as_dvec3()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// Corners of the unit tetrahedron and more points, under the given triangles.
    fn mesh(triangles: &[[u32; 3]]) -> TriMesh {
        let mut positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, Vec3::ONE, -Vec3::ONE, 2.0 * Vec3::X];
        positions.push(Vec3::new(3.0, 1.0, 0.0));
        TriMesh::new(positions, triangles.to_vec()).unwrap()
    }

    const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];

    fn fault(triangles: &[[u32; 3]]) -> String {
        mesh(triangles).check_volume_boundary().unwrap_err().to_string()
    }

    #[test]
    fn one_triangle() {
        let m = mesh(&[[2, 0, 1]]);
        assert_eq!(m.edges(), [[0, 1], [0, 2], [1, 2]]);
        assert_eq!(m.boundary_edges(), [[0, 1], [2, 0], [1, 2]]);
        assert!(m.hinges().is_empty());
        assert_eq!(m.areas(), [0.5]);
        assert_eq!(m.degrees(), [2, 2, 2, 0, 0, 0, 0, 0]);
        assert_eq!(m.components(), [0, 0, 0, 1, 2, 3, 4, 5]);
    }

    #[test]
    fn two_triangles_make_one_hinge() {
        let m = mesh(&[[1, 2, 0], [4, 2, 1]]);
        assert_eq!(m.edges(), [[0, 1], [0, 2], [1, 2], [1, 4], [2, 4]]);
        assert_eq!(m.hinges(), [[1, 2, 0, 4]]);
        assert_eq!(m.boundary_edges().len(), 4);
    }

    #[test]
    fn a_hinge_of_triangles_oriented_differently_is_kept() {
        assert_eq!(mesh(&[[2, 1, 0], [4, 2, 1]]).hinges(), [[2, 1, 0, 4]]);
    }

    #[test]
    fn degenerate_and_nonmanifold_triangles_give_no_hinge_and_no_self_edge() {
        let fan = mesh(&[[0, 1, 2], [0, 1, 3], [0, 1, 4]]);
        assert!(fan.hinges().is_empty());
        assert_eq!((fan.edges().len(), fan.boundary_edges().len()), (7, 6));
        let degenerate = mesh(&[[1, 1, 3], [0, 0, 0], [0, 1, 2]]);
        assert_eq!(degenerate.edges(), [[0, 1], [0, 2], [1, 2]]);
        let twice = mesh(&[[0, 1, 2], [2, 1, 0]]);
        assert!(twice.hinges().is_empty());
    }

    #[test]
    fn a_tetrahedron_bounds_its_volume() {
        let m = mesh(&TETRAHEDRON);
        assert_eq!(m.check_volume_boundary(), Ok(()));
        assert!((m.signed_volume() - 1.0 / 6.0).abs() < 1e-12);
        assert_eq!((m.hinges().len(), m.boundary_edges().len()), (6, 0));
    }

    #[test]
    fn each_fault_of_a_volume_boundary_is_named() {
        assert!(fault(&[]).contains("no triangles"));
        assert!(fault(&TETRAHEDRON[..3]).contains("edge 0-2 has triangle 0 on one side"));
        let inside_out = TETRAHEDRON.map(|[a, b, c]| [a, c, b]);
        assert!(fault(&inside_out).contains("inside out"));
        let mut one_flipped = TETRAHEDRON;
        one_flipped[3].swap(1, 2);
        assert!(fault(&one_flipped).contains("same direction"));
        let doubled = [TETRAHEDRON.as_slice(), &[[0, 1, 2], [0, 2, 1]]].concat();
        assert!(fault(&doubled).contains("has 4 triangles (0, 1, 4, 5)"), "{}", fault(&doubled));
        assert!(fault(&[[1, 1, 2]]).contains("triangle 0 names a vertex twice"));
        // A second tetrahedron (1, 6, 7, 4) that touches the first in vertex 1 alone.
        let touching = [TETRAHEDRON.as_slice(), &[[1, 7, 6], [1, 6, 4], [6, 7, 4], [1, 4, 7]]].concat();
        assert!(fault(&touching).contains("at vertex 1 separate fans"), "{}", fault(&touching));
    }

    #[test]
    fn the_volume_is_exact_far_from_the_origin() {
        let shifted = mesh(&TETRAHEDRON).positions().iter().map(|p| p + Vec3::splat(1_048_576.0)).collect();
        let volume = TriMesh::new(shifted, TETRAHEDRON.to_vec()).unwrap().signed_volume();
        assert!((volume - 1.0 / 6.0).abs() < 1e-12);
    }

    #[test]
    fn angles_and_flatness() {
        let right = [DVec3::ZERO, DVec3::X, DVec3::Y];
        assert!((min_angle(right) - 45.0).abs() < 1e-12);
        let thin = [DVec3::ZERO, DVec3::X, DVec3::new(3f64.sqrt() / 2.0, 0.5, 0.0)];
        assert!((min_angle(thin) - 30.0).abs() < 1e-12);
        assert!(!is_flat(right));
        assert!(is_flat([DVec3::ZERO, DVec3::splat(0.1), DVec3::splat(0.3)]));
        assert!(is_flat([DVec3::ONE; 3]));
    }
}
