//! What a tetrahedral mesh is made of: edges, boundary, components; volumes, qualities, dihedral angles.

use glam::DVec3;

use crate::mesh::{index32, quality, volume};
use crate::topology::{self, edge_key};
use crate::{MeshError, TetMesh, TriMesh};

/// The faces of `[a, b, c, d]` as corner numbers, counter-clockwise seen from outside; face k is opposite to corner k.
const FACES: [[usize; 3]; 4] = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];

/// The edges of a tetrahedron as corner numbers, and the two other corners.
const EDGES: [[usize; 4]; 6] =
    [[0, 1, 2, 3], [0, 2, 3, 1], [0, 3, 1, 2], [1, 2, 3, 0], [1, 3, 0, 2], [2, 3, 1, 0]];

impl TetMesh {
    /// Each edge once, lower vertex first, ascending.
    pub fn edges(&self) -> Vec<[u32; 2]> {
        topology::distinct_edges(self.edge_keys().collect())
    }

    /// The triangles that bound exactly one tetrahedron, counter-clockwise seen from outside, in the order of the tetrahedra.
    ///
    /// Where three or more tetrahedra meet in one triangle, it is no boundary.
    pub fn boundary(&self) -> Vec<[u32; 3]> {
        let faces = self.sorted_faces();
        let mut alone: Vec<usize> =
            faces.chunk_by(|a, b| a.0 == b.0).filter(|f| f.len() == 1).map(|f| f[0].1).collect();
        alone.sort_unstable();
        alone.into_iter().map(|face| FACES[face % 4].map(|k| self.tets()[face / 4][k])).collect()
    }

    /// The boundary as a mesh of its own, without inner vertices, and for each of its vertices the vertex here. Vertices keep
    /// their order.
    ///
    /// # Errors
    /// None for a mesh of fewer than 2^30 tetrahedra; else [`MeshError::TooLarge`] may come.
    pub fn boundary_mesh(&self) -> Result<(TriMesh, Vec<u32>), MeshError> {
        let mut triangles = self.boundary();
        let mut vertices: Vec<u32> = triangles.as_flattened().to_vec();
        vertices.sort_unstable();
        vertices.dedup();
        let mut new_index = vec![0; self.positions().len()];
        for (new, &old) in vertices.iter().enumerate() {
            new_index[old as usize] = index32(new);
        }
        for vertex in triangles.as_flattened_mut() {
            *vertex = new_index[*vertex as usize];
        }
        let positions = vertices.iter().map(|&v| self.positions()[v as usize]).collect();
        Ok((TriMesh::new(positions, triangles)?, vertices))
    }

    /// How many edges end at each vertex; 0 for an isolated one.
    pub fn degrees(&self) -> Vec<u32> {
        topology::degrees(self.positions().len(), &self.edges())
    }

    /// The component of each vertex (two are together if a chain of edges joins them), numbered from 0 in the order of their
    /// lowest vertices. An isolated vertex is one by itself.
    pub fn components(&self) -> Vec<u32> {
        topology::components(self.positions().len(), self.edge_keys().map(topology::edge_ends))
    }

    /// Volume of each tetrahedron \[m^3\].
    pub fn volumes(&self) -> Vec<f64> {
        (0..self.tets().len()).map(|t| volume(self.corners(t))).collect()
    }

    /// Quality of each tetrahedron \[1\]: 6√2·volume / (root-mean-square edge length)³, 1 for the regular tetrahedron.
    pub fn qualities(&self) -> Vec<f64> {
        (0..self.tets().len()).map(|t| quality(self.corners(t))).collect()
    }

    /// The smallest and the largest of the six dihedral angles of each tetrahedron \[deg\].
    pub fn dihedral_angles(&self) -> Vec<[f64; 2]> {
        (0..self.tets().len()).map(|t| dihedral_range(self.corners(t))).collect()
    }

    /// How many triangles bound more than two tetrahedra.
    pub(crate) fn n_nonmanifold_faces(&self) -> usize {
        self.sorted_faces().chunk_by(|a, b| a.0 == b.0).filter(|f| f.len() > 2).count()
    }

    fn edge_keys(&self) -> impl Iterator<Item = u64> {
        self.tets().iter().flat_map(|tet| EDGES.map(|[i, j, ..]| edge_key(tet[i], tet[j])))
    }

    /// Ascending vertices of each face, and 4 · tetrahedron + face; sorted.
    fn sorted_faces(&self) -> Vec<([u32; 3], usize)> {
        let mut faces = Vec::with_capacity(4 * self.tets().len());
        for (t, tet) in self.tets().iter().enumerate() {
            for (k, face) in FACES.iter().enumerate() {
                let mut vertices = face.map(|corner| tet[corner]);
                vertices.sort_unstable();
                faces.push((vertices, 4 * t + k));
            }
        }
        faces.sort_unstable();
        faces
    }
}

fn dihedral_range(corners: [DVec3; 4]) -> [f64; 2] {
    let angles = EDGES.map(|[i, j, k, l]| {
        let edge = corners[j] - corners[i];
        let (left, right) = (edge.cross(corners[k] - corners[i]), edge.cross(corners[l] - corners[i]));
        left.cross(right).length().atan2(left.dot(right)).to_degrees()
    });
    [angles.into_iter().fold(f64::INFINITY, f64::min), angles.into_iter().fold(0.0, f64::max)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn mesh(tets: &[[u32; 4]]) -> TetMesh {
        let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, -Vec3::Z, Vec3::ONE];
        TetMesh::new(positions, tets.to_vec()).unwrap()
    }

    #[test]
    fn one_tetrahedron() {
        let m = mesh(&[[0, 1, 2, 3]]);
        assert_eq!(m.edges(), [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]]);
        assert_eq!(m.degrees(), [3, 3, 3, 3, 0, 0]);
        assert_eq!(m.components(), [0, 0, 0, 0, 1, 2]);
        assert!((m.volumes()[0] - 1.0 / 6.0).abs() < 1e-12);
        // Three right angles at the axes, three of arctan(√2) at the slanted face.
        let [low, high] = m.dihedral_angles()[0];
        assert!((low - 2f64.sqrt().atan().to_degrees()).abs() < 1e-9 && (high - 90.0).abs() < 1e-9);
    }

    #[test]
    fn the_boundary_looks_outwards() {
        let m = mesh(&[[0, 1, 2, 3], [0, 2, 1, 4]]);
        let boundary = m.boundary();
        assert_eq!(boundary.len(), 6);
        assert!(!boundary.iter().any(|t| t.iter().all(|v| *v < 3)), "the shared face is inside");
        let (surface, vertices) = m.boundary_mesh().unwrap();
        assert_eq!(vertices, [0, 1, 2, 3, 4]);
        assert_eq!(surface.check_volume_boundary(), Ok(()));
        assert!((surface.signed_volume() - 1.0 / 3.0).abs() < 1e-12);
    }

    #[test]
    fn three_tetrahedra_on_one_face_have_a_boundary_without_it() {
        let m = mesh(&[[0, 1, 2, 3], [0, 2, 1, 4], [0, 1, 2, 5]]);
        assert_eq!((m.boundary().len(), m.n_nonmanifold_faces()), (9, 1));
    }

    #[test]
    fn the_regular_tetrahedron_has_equal_angles() {
        let positions = [[1., 1., 1.], [-1., 1., -1.], [1., -1., -1.], [-1., -1., 1.]].map(Vec3::from_array);
        let (m, _) = TetMesh::oriented(positions.to_vec(), vec![[0, 1, 2, 3]]).unwrap();
        let [low, high] = m.dihedral_angles()[0];
        let expected = (1f64 / 3.0).acos().to_degrees();
        assert!((low - expected).abs() < 1e-9 && (high - expected).abs() < 1e-9);
        assert!((m.qualities()[0] - 1.0).abs() < 1e-12);
    }
}
