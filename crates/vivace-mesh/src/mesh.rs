//! The two mesh types. Both are checked once, at construction, and immutable after.

use glam::Vec3;

use crate::MeshError;

/// A triangle mesh: positions [m] and triangles, counter-clockwise seen from outside.
///
/// Indices are in range and positions finite; triangles may be degenerate, non-manifold or unconnected, and vertices may be
/// isolated: all of that is legal cloth. What a volume boundary needs is asked for where one is made.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TriMesh {
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

/// A tetrahedral mesh: positions [m] and tetrahedra `[a, b, c, d]` with `(b - a) · ((c - a) × (d - a)) > 0`.
///
/// ```text
///         d
///        /|\        seen from d, the corners a, b, c run counter-clockwise
///       / | \       when looked at from below: (b-a) × (c-a) points towards d
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
    /// A non-finite coordinate, an index out of range, more elements than 32 bits can number.
    pub fn new(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Result<Self, MeshError> {
        check_positions(&positions)?;
        check_indices("triangle", &triangles, positions.len())?;
        Ok(Self { positions, triangles })
    }

    /// Positions [m], one per vertex.
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
    /// A non-finite coordinate, an index out of range, a corner named twice, more elements than 32 bits can number.
    /// (Flat and inverted tetrahedra: see the rest of this crate.)
    pub fn new(positions: Vec<Vec3>, tets: Vec<[u32; 4]>) -> Result<Self, MeshError> {
        check_positions(&positions)?;
        check_indices("tetrahedron", &tets, positions.len())?;
        for (index, tet) in tets.iter().enumerate() {
            for corner in 1..4 {
                if tet[..corner].contains(&tet[corner]) {
                    return Err(MeshError::RepeatedVertex {
                        element: "tetrahedron",
                        index,
                        vertex: tet[corner],
                    });
                }
            }
        }
        Ok(Self { positions, tets })
    }

    /// Positions [m], one per vertex.
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// Vertex indices, four per tetrahedron.
    pub fn tets(&self) -> &[[u32; 4]] {
        &self.tets
    }
}

fn check_positions(positions: &[Vec3]) -> Result<(), MeshError> {
    if positions.len() >= u32::MAX as usize {
        return Err(MeshError::TooLarge { what: "vertices", count: positions.len() });
    }
    for (vertex, position) in positions.iter().enumerate() {
        if let Some(&value) = position.as_ref().iter().find(|x| !x.is_finite()) {
            return Err(MeshError::NonFinite { vertex, value });
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
