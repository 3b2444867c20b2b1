//! The primitives of a surface.

use glam::Vec3;

use crate::CollisionError;

/// Triangles, and their edges and vertices, each once and ascending.
pub(crate) struct Surface {
    pub(crate) triangles: Vec<[u32; 3]>,
    pub(crate) edges: Vec<[u32; 2]>,
    pub(crate) vertices: Vec<u32>,
}

impl Surface {
    pub(crate) fn new(triangles: &[[u32; 3]], n_particles: usize) -> Result<Self, CollisionError> {
        for (triangle, &corners) in triangles.iter().enumerate() {
            let [a, b, c] = corners;
            if a == b || b == c || c == a || corners.iter().any(|&v| v as usize >= n_particles) {
                return Err(CollisionError::Triangle { triangle, corners, n_particles });
            }
        }
        let sides = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        let edges = distinct(sides.map(|[a, b]| [a.min(b), a.max(b)]).collect());
        let vertices = distinct(triangles.as_flattened().to_vec());
        Ok(Self { triangles: triangles.to_vec(), edges, vertices })
    }

    /// The shortest edge and its length \[m\].
    pub(crate) fn shortest_edge(&self, positions: &[Vec3]) -> Option<([u32; 2], f32)> {
        let length = |edge: [u32; 2]| {
            let [a, b] = edge.map(|v| positions[v as usize].as_dvec3());
            #[expect(clippy::cast_possible_truncation, reason = "rounded")]
            let length = a.distance(b) as f32;
            (edge, length)
        };
        self.edges.iter().copied().map(length).min_by(|one, other| one.1.total_cmp(&other.1))
    }
}

fn distinct<T: Ord>(mut items: Vec<T>) -> Vec<T> {
    items.sort_unstable();
    items.dedup();
    items
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_triangles_have_five_edges() {
        let surface = Surface::new(&[[3, 0, 1], [1, 2, 3]], 5).unwrap();
        assert_eq!(surface.edges, [[0, 1], [0, 3], [1, 2], [1, 3], [2, 3]]);
        assert_eq!(surface.vertices, [0, 1, 2, 3]);
    }

    #[test]
    fn corners_have_to_be_there_and_to_differ() {
        for corners in [[0, 1, 5], [0, 1, 1], [0, 1, 0], [2, 2, 1]] {
            let error = Surface::new(&[[0, 1, 2], corners], 5).err();
            assert_eq!(error, Some(CollisionError::Triangle { triangle: 1, corners, n_particles: 5 }));
        }
    }
}
