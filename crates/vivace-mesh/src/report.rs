//! What a mesh is like, in numbers: one plain struct for each type of mesh. No field is ever NaN.

use glam::DVec3;

use crate::mesh::repeated;
use crate::topology::{EdgeCounts, Sides, nonmanifold_vertices};
use crate::tri::{bounds, is_flat, min_angle};
use crate::{TetMesh, TriMesh};

/// A list of counts in four numbers; all zero for an empty list.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct DegreeSummary {
    /// The smallest degree.
    pub min: u32,
    /// The mean degree.
    pub mean: f64,
    /// The largest degree.
    pub max: u32,
    /// Standard deviation over all vertices (divided by n).
    pub deviation: f64,
}

/// What a triangle mesh is like. Made by [`TriMesh::report`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TriReport {
    /// Vertices, isolated ones too.
    pub n_vertices: usize,
    /// Triangles, degenerate ones too.
    pub n_triangles: usize,
    /// Distinct edges; triangles with a repeated vertex have none.
    pub n_edges: usize,
    /// Edges of exactly two triangles with different opposite vertices: see [`TriMesh::hinges`].
    pub n_hinges: usize,
    /// Edges of one triangle.
    pub n_boundary_edges: usize,
    /// Edges of more than two triangles; they have no hinge.
    pub n_nonmanifold_edges: usize,
    /// Edges of two triangles with the same three vertices; they have no hinge.
    pub n_folded_edges: usize,
    /// Edges along which two triangles run in the same direction.
    pub n_misoriented_edges: usize,
    /// Vertices where separate fans of triangles touch.
    pub n_nonmanifold_vertices: usize,
    /// Vertices without an edge.
    pub n_isolated_vertices: usize,
    /// Triangles that name a vertex twice.
    pub n_repeated_triangles: usize,
    /// Other triangles without area: twice the area is at most 10⁻⁶ of the longest edge squared.
    pub n_flat_triangles: usize,
    /// Connected parts, isolated vertices not counted.
    pub n_components: usize,
    /// Vertices with an edge − edges + triangles without repeated vertices: 2 for a sphere, 1 for a disc.
    pub euler_characteristic: i64,
    /// Degrees of all vertices.
    pub degrees: DegreeSummary,
    /// Smallest angle of any triangle that is neither flat nor names a vertex twice \[deg\]; `None` if there is none.
    pub min_angle: Option<f64>,
    /// Area of all triangles \[m^2\].
    pub area: f64,
    /// Enclosed volume \[m^3\]; `None` if the mesh is not closed.
    pub volume: Option<f64>,
    /// Lowest and highest corner of the bounding box \[m\].
    pub bounds: [DVec3; 2],
}

impl TriReport {
    /// No edge has more than two triangles and no vertex more than one fan.
    pub fn is_manifold(&self) -> bool {
        self.n_nonmanifold_edges == 0 && self.n_nonmanifold_vertices == 0
    }

    /// There are edges, and none has only one triangle.
    pub fn is_closed(&self) -> bool {
        self.n_edges > 0 && self.n_boundary_edges == 0
    }

    /// Wherever two triangles meet, they run along their edge in opposite directions.
    pub fn is_oriented(&self) -> bool {
        self.n_misoriented_edges == 0
    }
}

/// What a tetrahedral mesh is like. Made by [`TetMesh::report`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TetReport {
    /// Vertices, isolated ones too.
    pub n_vertices: usize,
    /// Tetrahedra.
    pub n_tets: usize,
    /// Distinct edges.
    pub n_edges: usize,
    /// Triangles of one tetrahedron.
    pub n_boundary_triangles: usize,
    /// Triangles of more than two tetrahedra.
    pub n_nonmanifold_faces: usize,
    /// Edges of more than two boundary triangles.
    pub n_nonmanifold_boundary_edges: usize,
    /// Vertices where separate fans of boundary triangles touch.
    pub n_nonmanifold_boundary_vertices: usize,
    /// Edges of one boundary triangle (only where three tetrahedra share a face).
    pub n_open_boundary_edges: usize,
    /// Vertices in no tetrahedron.
    pub n_isolated_vertices: usize,
    /// Connected parts, isolated vertices not counted.
    pub n_components: usize,
    /// Degrees of all vertices.
    pub degrees: DegreeSummary,
    /// Smallest and largest dihedral angle \[deg\]; `None` without tetrahedra.
    pub dihedral_angles: Option<[f64; 2]>,
    /// Smallest and mean quality \[1\]: see [`TetMesh::qualities`]; `None` without tetrahedra.
    pub quality: Option<[f64; 2]>,
    /// Volume of all tetrahedra \[m^3\].
    pub volume: f64,
    /// Smallest and largest volume of a tetrahedron \[m^3\]; `None` without tetrahedra.
    pub volumes: Option<[f64; 2]>,
    /// Lowest and highest corner of the bounding box \[m\].
    pub bounds: [DVec3; 2],
}

impl TetReport {
    /// The boundary is closed, no edge of it has more than two triangles and no vertex more than one fan.
    pub fn has_manifold_boundary(&self) -> bool {
        self.n_nonmanifold_boundary_edges == 0
            && self.n_nonmanifold_boundary_vertices == 0
            && self.n_open_boundary_edges == 0
    }
}

impl DegreeSummary {
    /// The summary of a list of degrees.
    pub fn of(degrees: &[u32]) -> Self {
        let n = degrees.len().max(1) as f64;
        let mean = degrees.iter().map(|&d| f64::from(d)).sum::<f64>() / n;
        let variance = degrees.iter().map(|&d| (f64::from(d) - mean).powi(2)).sum::<f64>() / n;
        Self {
            min: degrees.iter().copied().min().unwrap_or(0),
            mean,
            max: degrees.iter().copied().max().unwrap_or(0),
            deviation: variance.sqrt(),
        }
    }
}

impl TriMesh {
    /// Measures the mesh; n log n in its size.
    pub fn report(&self) -> TriReport {
        let triangles = self.triangles();
        let sides = Sides::of(triangles);
        let counts = EdgeCounts::of(triangles, &sides);
        let degrees = self.degrees();
        let n_isolated = degrees.iter().filter(|&&d| d == 0).count();
        let is_repeated = |t: &usize| repeated(&triangles[*t]).is_some();
        let proper = || (0..triangles.len()).filter(|t| !is_repeated(t));
        let n_flat = proper().filter(|&t| is_flat(self.triangle_corners(t))).count();
        let sound = proper().map(|t| self.triangle_corners(t)).filter(|&c| !is_flat(c));
        let n_proper = proper().count();
        TriReport {
            n_vertices: self.positions().len(),
            n_triangles: triangles.len(),
            n_edges: counts.edges,
            n_hinges: counts.hinges,
            n_boundary_edges: counts.boundary,
            n_nonmanifold_edges: counts.nonmanifold,
            n_folded_edges: counts.folded,
            n_misoriented_edges: counts.misoriented,
            n_nonmanifold_vertices: nonmanifold_vertices(self.positions().len(), triangles, &sides).len(),
            n_isolated_vertices: n_isolated,
            n_repeated_triangles: triangles.len() - n_proper,
            n_flat_triangles: n_flat,
            n_components: count_components(&self.components(), n_isolated),
            euler_characteristic: signed(self.positions().len() - n_isolated) - signed(counts.edges)
                + signed(n_proper),
            degrees: DegreeSummary::of(&degrees),
            min_angle: sound.map(min_angle).reduce(f64::min),
            area: self.areas().iter().sum(),
            volume: (counts.boundary == 0 && counts.edges > 0).then(|| self.signed_volume()),
            bounds: bounds(self.positions()),
        }
    }
}

impl TetMesh {
    /// Measures the mesh; n log n in its size.
    pub fn report(&self) -> TetReport {
        let degrees = self.degrees();
        let n_isolated = degrees.iter().filter(|&&d| d == 0).count();
        let boundary = self.boundary();
        let sides = Sides::of(&boundary);
        let counts = EdgeCounts::of(&boundary, &sides);
        let angles = self.dihedral_angles();
        let (volumes, qualities) = (self.volumes(), self.qualities());
        let volume: f64 = volumes.iter().sum();
        let mean_quality = qualities.iter().sum::<f64>() / qualities.len().max(1) as f64;
        TetReport {
            n_vertices: self.positions().len(),
            n_tets: self.tets().len(),
            n_edges: self.edges().len(),
            n_boundary_triangles: boundary.len(),
            n_nonmanifold_faces: self.n_nonmanifold_faces(),
            n_nonmanifold_boundary_edges: counts.nonmanifold,
            n_nonmanifold_boundary_vertices: nonmanifold_vertices(self.positions().len(), &boundary, &sides)
                .len(),
            n_open_boundary_edges: counts.boundary,
            n_isolated_vertices: n_isolated,
            n_components: count_components(&self.components(), n_isolated),
            degrees: DegreeSummary::of(&degrees),
            dihedral_angles: angles.into_iter().reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]),
            quality: qualities.into_iter().reduce(f64::min).map(|min| [min, mean_quality]),
            volume,
            volumes: volumes.iter().map(|&v| [v, v]).reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]),
            bounds: bounds(self.positions()),
        }
    }
}

/// Components with an edge, from the labels of all vertices.
fn count_components(labels: &[u32], n_isolated: usize) -> usize {
    labels.iter().max().map_or(0, |&last| last as usize + 1 - n_isolated)
}

#[expect(clippy::cast_possible_wrap, reason = "counts of a mesh are far below 2^63")]
fn signed(count: usize) -> i64 {
    count as i64
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn two_triangles_and_an_isolated_vertex() {
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y, Vec3::splat(9.0)];
        let r = TriMesh::new(positions, vec![[0, 1, 2], [0, 2, 3]]).unwrap().report();
        assert_eq!((r.n_vertices, r.n_triangles, r.n_edges, r.n_hinges, r.n_boundary_edges), (5, 2, 5, 1, 4));
        assert_eq!((r.n_components, r.n_isolated_vertices, r.euler_characteristic), (1, 1, 1));
        assert!(r.is_manifold() && r.is_oriented() && !r.is_closed());
        assert_eq!((r.degrees.min, r.degrees.max, r.degrees.mean), (0, 3, 2.0));
        assert!((r.degrees.deviation - (6f64 / 5.0).sqrt()).abs() < 1e-12);
        assert!((r.min_angle.unwrap() - 45.0).abs() < 1e-12);
        assert_eq!((r.area, r.volume), (1.0, None));
        assert_eq!(r.bounds, [DVec3::ZERO, DVec3::splat(9.0)]);
    }

    #[test]
    fn nothing_gives_zeros_and_no_nan() {
        let r = TriMesh::default().report();
        assert_eq!((r.n_components, r.euler_characteristic, r.min_angle, r.degrees.mean), (0, 0, None, 0.0));
        assert!(!r.is_closed());
        let r = TetMesh::default().report();
        assert_eq!((r.n_components, r.quality, r.dihedral_angles, r.volumes), (0, None, None, None));
    }

    #[test]
    fn degenerate_triangles_are_counted_and_give_no_nan() {
        let positions = vec![Vec3::ZERO, Vec3::X, 2.0 * Vec3::X, Vec3::Y];
        let r = TriMesh::new(positions, vec![[0, 1, 3], [0, 1, 2], [1, 1, 3]]).unwrap().report();
        assert_eq!((r.n_repeated_triangles, r.n_flat_triangles), (1, 1));
        assert!((r.min_angle.unwrap() - 45.0).abs() < 1e-12);
        let collinear = TriMesh::new(vec![Vec3::ZERO; 3], vec![[0, 1, 2]]).unwrap().report();
        assert_eq!((collinear.min_angle, collinear.n_flat_triangles), (None, 1));
    }

    #[test]
    fn two_tetrahedra_that_touch_in_an_edge() {
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, -Vec3::Y, -Vec3::Z];
        let (mesh, _) = TetMesh::oriented(positions, vec![[0, 1, 2, 3], [0, 1, 4, 5]]).unwrap();
        let r = mesh.report();
        assert_eq!((r.n_edges, r.n_boundary_triangles, r.n_components), (11, 8, 1));
        assert_eq!((r.n_nonmanifold_boundary_edges, r.has_manifold_boundary()), (1, false));
        assert!((r.volume - 1.0 / 3.0).abs() < 1e-12);
        assert!((r.quality.unwrap()[0] - r.quality.unwrap()[1]).abs() < 1e-12);
    }
}
