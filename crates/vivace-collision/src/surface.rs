//! The primitives of a surface.

use glam::Vec3;
use vivace_graph::DisjointSets;

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

    /// The numbers of a triangle's edges.
    pub(crate) fn edges_of(&self, [a, b, c]: [u32; 3]) -> [usize; 3] {
        [[a, b], [b, c], [c, a]].map(|[a, b]| self.edges.partition_point(|edge| *edge < [a.min(b), a.max(b)]))
    }

    /// The triangles of each body: those that hang together by particles.
    pub(crate) fn bodies(&self) -> Vec<Vec<u32>> {
        let n = self.vertices.last().map_or(0, |&last| last + 1);
        let mut sets = DisjointSets::new(n);
        for &[a, b, c] in &self.triangles {
            sets.unite(a, b);
            sets.unite(b, c);
        }
        let mut place = vec![usize::MAX; n as usize];
        let mut bodies: Vec<Vec<u32>> = Vec::new();
        for (t, corners) in (0..).zip(&self.triangles) {
            let place = &mut place[sets.first(corners[0]) as usize];
            if *place == usize::MAX {
                *place = bodies.len();
                bodies.push(Vec::new());
            }
            bodies[*place].push(t);
        }
        bodies
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

/// Ascending, each once.
pub(crate) fn distinct<T: Ord>(mut items: Vec<T>) -> Vec<T> {
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
