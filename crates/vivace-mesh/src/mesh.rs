//! The two mesh types. Both are checked once, at construction, and immutable after.

use glam::{DVec3, Vec3};

use crate::MeshError;

/// The largest |coordinate| of a mesh \[m\].
///
/// Two corners are then at most 2·√3·10¹² m apart, and the determinant of three such edges (a tetrahedron's rest shape), at
/// most 4.2·10³⁷, is still finite in `f32` (3.4·10³⁸), with room for the partial sums. At 10¹³ it would overflow.
pub const MAX_COORDINATE: f32 = 1e12;

/// A tetrahedron whose quality \[1\] is not above this is refused as flat.
///
/// Corners rounded to `f32` make a flat tetrahedron's quality about 10⁻⁷; the slivers of real meshes have 10⁻² and more.
pub const FLAT_QUALITY: f64 = 1e-6;

/// A triangle mesh: positions \[m\] and triangles, counter-clockwise seen from outside.
///
/// Indices are in range, positions finite and within [`MAX_COORDINATE`]; triangles may be degenerate, non-manifold or
/// unconnected, and vertices may be isolated: all of that is legal cloth. What a volume needs is asked for by
/// [`TriMesh::check_volume_boundary`].
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TriMesh {
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

/// A tetrahedral mesh: positions \[m\] and tetrahedra `[a, b, c, d]` with `(b - a) · ((c - a) × (d - a)) > 0`.
///
/// No tetrahedron is flat or inverted, and no volume is lost to the range of `f32`. Vertices may be isolated.
///
/// ```text
///         d
///        /|\        seen from d, the corners a, b, c run counter-clockwise:
///       / | \       (b-a) × (c-a) points towards d
///      a--|--c
///       \ | /
///         b
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TetMesh {
    positions: Vec<Vec3>,
    tets: Vec<[u32; 4]>,
}

impl TriMesh {
    /// Checks the parts and makes them a mesh.
    ///
    /// # Errors
    /// A coordinate that is not finite or beyond [`MAX_COORDINATE`], an index out of range, more elements than 32 bits can
    /// number.
    pub fn new(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Result<Self, MeshError> {
        check_positions(&positions)?;
        check_indices("triangle", &triangles, positions.len())?;
        Ok(Self { positions, triangles })
    }

    /// Positions \[m\], one per vertex.
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// Vertex indices, three per triangle.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }
}

impl TetMesh {
    /// Checks the parts and makes them a mesh.
    ///
    /// # Errors
    /// A coordinate that is not finite or beyond [`MAX_COORDINATE`], an index out of range, a corner named twice, a flat
    /// tetrahedron ([`FLAT_QUALITY`]), one too small for `f32`, an inverted one, more elements than 32 bits can number.
    pub fn new(positions: Vec<Vec3>, tets: Vec<[u32; 4]>) -> Result<Self, MeshError> {
        let (mesh, reordered) = Self::oriented(positions, tets)?;
        match reordered.first() {
            None => Ok(mesh),
            Some(&index) => Err(MeshError::InvertedTet { index, volume: -mesh.volume(index) }),
        }
    }

    /// As [`TetMesh::new`], but the last two corners of inverted tetrahedra are swapped; gives the mesh and the indices of
    /// those tetrahedra, ascending.
    ///
    /// # Errors
    /// Those of [`TetMesh::new`], except for inverted tetrahedra.
    pub fn oriented(positions: Vec<Vec3>, mut tets: Vec<[u32; 4]>) -> Result<(Self, Vec<usize>), MeshError> {
        check_positions(&positions)?;
        check_indices("tetrahedron", &tets, positions.len())?;
        let mut reordered = Vec::new();
        for (index, tet) in tets.iter_mut().enumerate() {
            if let Some(vertex) = repeated(tet) {
                return Err(MeshError::RepeatedVertex { element: "tetrahedron", index, vertex });
            }
            let corners = tet.map(|v| positions[v as usize].as_dvec3());
            let (volume, quality) = (volume(corners), quality(corners));
            if quality.abs() <= FLAT_QUALITY {
                return Err(MeshError::FlatTet { index, quality: quality.abs() });
            }
            if volume.abs() < f64::from(f32::MIN_POSITIVE) {
                return Err(MeshError::TinyTet { index, volume });
            }
            if volume < 0.0 {
                tet.swap(2, 3);
                reordered.push(index);
            }
        }
        Ok((Self { positions, tets }, reordered))
    }

    /// Positions \[m\], one per vertex.
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// Vertex indices, four per tetrahedron.
    pub fn tets(&self) -> &[[u32; 4]] {
        &self.tets
    }

    /// The corners of one tetrahedron \[m\].
    pub(crate) fn corners(&self, tet: usize) -> [DVec3; 4] {
        self.tets[tet].map(|v| self.positions[v as usize].as_dvec3())
    }

    fn volume(&self, tet: usize) -> f64 {
        volume(self.corners(tet))
    }
}

/// Signed volume of a tetrahedron \[m^3\].
pub(crate) fn volume([a, b, c, d]: [DVec3; 4]) -> f64 {
    (b - a).dot((c - a).cross(d - a)) / 6.0
}

/// 6√2·volume / (root-mean-square edge)³ \[1\]: 1 for the regular tetrahedron, 0 if flat, negative if inverted.
pub(crate) fn quality(corners: [DVec3; 4]) -> f64 {
    let [a, b, c, d] = corners;
    let squares = [b - a, c - a, d - a, c - b, d - b, d - c].map(DVec3::length_squared);
    let mean_square = squares.iter().sum::<f64>() / 6.0;
    if mean_square > 0.0 {
        6.0 * std::f64::consts::SQRT_2 * volume(corners) / (mean_square * mean_square.sqrt())
    } else {
        0.0
    }
}

/// The first corner that an element names twice.
pub(crate) fn repeated(corners: &[u32]) -> Option<u32> {
    (1..corners.len()).find(|&k| corners[..k].contains(&corners[k])).map(|k| corners[k])
}

/// An index as the 32 bits in which meshes hold it.
pub(crate) fn index32(index: usize) -> u32 {
    debug_assert!(index < u32::MAX as usize, "a mesh holds fewer than 2^32 - 1 elements");
    #[expect(
        clippy::cast_possible_truncation,
        reason = "every mesh is checked to hold fewer than 2^32 - 1 elements"
    )]
    let index = index as u32;
    index
}

fn check_positions(positions: &[Vec3]) -> Result<(), MeshError> {
    if positions.len() >= u32::MAX as usize {
        return Err(MeshError::TooLarge { what: "vertices", count: positions.len() });
    }
    for (vertex, position) in positions.iter().enumerate() {
        if let Some(&value) = position.as_ref().iter().find(|x| !x.is_finite()) {
            return Err(MeshError::NonFinite { vertex, value });
        }
        if let Some(&value) = position.as_ref().iter().find(|x| x.abs() > MAX_COORDINATE) {
            return Err(MeshError::TooFar { vertex, value });
        }
    }
    Ok(())
}

fn check_indices<const K: usize>(
    element: &'static str,
    elements: &[[u32; K]],
    n_vertices: usize,
) -> Result<(), MeshError> {
    if elements.len() >= u32::MAX as usize {
        return Err(MeshError::TooLarge { what: "elements", count: elements.len() });
    }
    for (index, corners) in elements.iter().enumerate() {
        if let Some(&vertex) = corners.iter().find(|&&v| v as usize >= n_vertices) {
            return Err(MeshError::IndexOutOfRange { element, index, vertex, n_vertices });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit() -> Vec<Vec3> {
        vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z]
    }

    #[test]
    fn a_tetrahedron_is_taken_in_its_right_order_only() {
        assert!(TetMesh::new(unit(), vec![[0, 1, 2, 3]]).is_ok());
        let error = TetMesh::new(unit(), vec![[0, 1, 2, 3], [0, 2, 1, 3]]).unwrap_err();
        assert!(
            matches!(error, MeshError::InvertedTet { index: 1, volume } if (volume + 1.0 / 6.0).abs() < 1e-12)
        );
        let (mesh, reordered) = TetMesh::oriented(unit(), vec![[0, 1, 2, 3], [0, 2, 1, 3]]).unwrap();
        assert_eq!((mesh.tets()[1], reordered), ([0, 2, 3, 1], vec![1]));
    }

    #[test]
    fn flat_tiny_and_repeated_are_named() {
        let mut flat = unit();
        flat.push(Vec3::new(1.0, 1.0, 0.0));
        let error = TetMesh::new(flat, vec![[0, 1, 2, 3], [0, 1, 2, 4]]).unwrap_err();
        assert_eq!(error, MeshError::FlatTet { index: 1, quality: 0.0 });
        let tiny = unit().into_iter().map(|p| p * 1e-13).collect();
        assert!(matches!(TetMesh::new(tiny, vec![[0, 1, 2, 3]]), Err(MeshError::TinyTet { index: 0, .. })));
        let coincident = vec![Vec3::ONE; 4];
        assert!(matches!(
            TetMesh::new(coincident, vec![[0, 1, 2, 3]]),
            Err(MeshError::FlatTet { index: 0, .. })
        ));
        let error = TetMesh::new(unit(), vec![[0, 1, 1, 2]]).unwrap_err();
        assert_eq!(error, MeshError::RepeatedVertex { element: "tetrahedron", index: 0, vertex: 1 });
    }

    #[test]
    fn slivers_above_the_tolerance_are_kept() {
        let mut sliver = unit();
        sliver[3] = Vec3::new(0.3, 0.3, 1e-4);
        assert!(TetMesh::new(sliver, vec![[0, 1, 2, 3]]).is_ok());
    }

    #[test]
    fn coordinates_are_finite_and_small_enough_for_an_f32_determinant() {
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let error = TriMesh::new(vec![Vec3::ZERO, Vec3::new(0.0, bad, 0.0)], vec![]).unwrap_err();
            assert!(matches!(error, MeshError::NonFinite { vertex: 1, .. }));
        }
        let error = TriMesh::new(vec![Vec3::splat(-1e30)], vec![]).unwrap_err();
        assert_eq!(error, MeshError::TooFar { vertex: 0, value: -1e30 });
        let far = MAX_COORDINATE;
        let edges = [Vec3::new(-far, far, far), Vec3::new(far, -far, far), Vec3::new(far, far, -far)];
        let [x, y, z] = edges.map(|e| e + e);
        assert!(x.dot(y.cross(z)).is_finite());
        assert!(TriMesh::new(edges.to_vec(), vec![[0, 1, 2]]).is_ok());
    }

    #[test]
    fn indices_out_of_range_are_named() {
        let error = TriMesh::new(unit(), vec![[0, 1, 2], [0, 1, 4]]).unwrap_err();
        assert_eq!(
            error,
            MeshError::IndexOutOfRange { element: "triangle", index: 1, vertex: 4, n_vertices: 4 }
        );
    }

    #[test]
    fn the_regular_tetrahedron_has_quality_one() {
        let corners = [[1., 1., 1.], [1., -1., -1.], [-1., 1., -1.], [-1., -1., 1.]].map(DVec3::from_array);
        assert!((quality(corners).abs() - 1.0).abs() < 1e-12);
        assert!((volume(corners).abs() - 8.0 / 3.0).abs() < 1e-12);
    }
}
