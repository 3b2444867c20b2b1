//! Which pairs of primitives have ways whose boxes meet.

use glam::Vec3;

use crate::boxes::Aabb;
use crate::contact::Contact;
use crate::grid::Grid;
use crate::parallel::{for_each, piece};
use crate::surface::Surface;

/// Pieces of the work: their number shows in no result.
const N_PIECES: usize = 64;
/// Elements that are not worth a second thread.
const GRAIN: usize = 1024;
/// Particles that are looked at for the drift.
const N_SAMPLES: usize = 256;

/// Candidates of one piece, and what becomes of them.
#[derive(Default)]
pub(crate) struct Piece {
    /// A point, and the corners of a triangle.
    pub(crate) points: Vec<[u32; 4]>,
    /// The ends of two edges.
    pub(crate) edges: Vec<[u32; 4]>,
    pub(crate) contacts: Vec<Contact>,
    /// Pairs that hit, and when.
    pub(crate) hits: Vec<([u32; 4], f32)>,
}

/// Boxes, grids and candidates, kept so that a frame allocates nothing.
#[derive(Default)]
pub(crate) struct Broad {
    particle_boxes: Vec<Aabb>,
    edge_boxes: Vec<Aabb>,
    triangle_boxes: Vec<Aabb>,
    edge_grid: Grid,
    triangle_grid: Grid,
    pub(crate) pieces: Vec<Piece>,
}

impl Broad {
    /// Lists in `pieces` all pairs without a common particle that may come within `reach` \[m\] of each other on the way from
    /// `from` to `to`, and counts them. `drift` \[m\] is taken off every way: pairs do not see what all have in common.
    pub(crate) fn find(
        &mut self,
        surface: &Surface,
        from: &[Vec3],
        to: &[Vec3],
        drift: Vec3,
        reach: f32,
    ) -> usize {
        self.pieces.resize_with(N_PIECES, Piece::default);
        let around = |v: usize| Aabb::around(from[v], to[v] - drift, 0.5 * reach);
        fill(&mut self.particle_boxes, from.len(), &around);
        let particles = &self.particle_boxes;
        let of = |ids: &[u32]| ids.iter().fold(Aabb::EMPTY, |b, &v| b.union(particles[v as usize]));
        fill(&mut self.edge_boxes, surface.edges.len(), &|e| of(&surface.edges[e]));
        fill(&mut self.triangle_boxes, surface.triangles.len(), &|t| of(&surface.triangles[t]));
        let (edges, triangles) = (&mut self.edge_grid, &mut self.triangle_grid);
        if rayon::current_num_threads() == 1 {
            edges.build(&self.edge_boxes);
            triangles.build(&self.triangle_boxes);
        } else {
            rayon::join(|| edges.build(&self.edge_boxes), || triangles.build(&self.triangle_boxes));
        }

        let (edges, triangles) = (&self.edge_grid, &self.triangle_grid);
        for_each(&mut self.pieces, 1, &|k, out: &mut Piece| {
            out.points.clear();
            out.edges.clear();
            for &v in &surface.vertices[piece(surface.vertices.len(), k, N_PIECES)] {
                triangles.meeting(particles[v as usize], |t| {
                    let [a, b, c] = surface.triangles[t as usize];
                    if v != a && v != b && v != c {
                        out.points.push([v, a, b, c]);
                    }
                });
            }
            for place in piece(edges.len(), k, N_PIECES) {
                edges.later_ones(place, |one, other| {
                    let [[a, b], [c, d]] = [one, other].map(|e| surface.edges[e as usize]);
                    if a != c && a != d && b != c && b != d {
                        out.edges.push([a, b, c, d]);
                    }
                });
            }
        });
        self.pieces.iter().map(|piece| piece.points.len() + piece.edges.len()).sum()
    }
}

/// Makes `out` have `n` elements, `f` of each.
fn fill(out: &mut Vec<Aabb>, n: usize, f: &(impl Fn(usize) -> Aabb + Sync)) {
    out.resize(n, Aabb::EMPTY);
    for_each(out, GRAIN, &|k, b: &mut Aabb| *b = f(k));
}

/// How far most particles go \[m\]: axis by axis, the median of some of them.
pub(crate) fn drift(vertices: &[u32], from: &[Vec3], to: &[Vec3]) -> Vec3 {
    let stride = vertices.len().div_ceil(N_SAMPLES).max(1);
    let axis = |axis: usize| {
        let (mut ways, mut n) = ([0.0; N_SAMPLES], 0);
        for &v in vertices.iter().step_by(stride) {
            ways[n] = to[v as usize][axis] - from[v as usize][axis];
            n += 1;
        }
        if n == 0 { 0.0 } else { *ways[..n].select_nth_unstable_by(n / 2, f32::total_cmp).1 }
    };
    Vec3::new(axis(0), axis(1), axis(2))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// All pairs, by looking at all pairs.
    fn brute(surface: &Surface, from: &[Vec3], to: &[Vec3], drift: Vec3, reach: f32) -> Vec<[u32; 4]> {
        let of = |ids: &[u32]| {
            ids.iter()
                .map(|&v| v as usize)
                .fold(Aabb::EMPTY, |b, v| b.union(Aabb::around(from[v], to[v] - drift, 0.5 * reach)))
        };
        let meet = |a: &[u32], b: &[u32]| {
            let (one, other) = (of(a), of(b));
            one.min.cmple(other.max).all()
                && other.min.cmple(one.max).all()
                && !a.iter().any(|v| b.contains(v))
        };
        let mut pairs = Vec::new();
        for &v in &surface.vertices {
            for &[a, b, c] in surface.triangles.iter().filter(|triangle| meet(&[v], *triangle)) {
                pairs.push([v, a, b, c]);
            }
        }
        for (k, one) in surface.edges.iter().enumerate() {
            for other in surface.edges[k + 1..].iter().filter(|other| meet(one, *other)) {
                pairs.push([one[0], one[1], other[0], other[1]]);
            }
        }
        pairs.sort_unstable();
        pairs
    }

    /// Edges in either order.
    fn sorted(pieces: &[Piece]) -> Vec<[u32; 4]> {
        let edges = pieces.iter().flat_map(|piece| &piece.edges);
        let edges = edges.map(|&[a, b, c, d]| if [a, b] < [c, d] { [a, b, c, d] } else { [c, d, a, b] });
        let mut pairs: Vec<_> = pieces.iter().flat_map(|piece| &piece.points).copied().chain(edges).collect();
        pairs.sort_unstable();
        pairs
    }

    fn vector(size: f32) -> impl Strategy<Value = Vec3> {
        prop::array::uniform3(-size..size).prop_map(Vec3::from)
    }

    proptest! {
        /// Triangles of all sizes, some gone far in the frame, around the origin and far from it.
        #[test]
        fn the_grid_finds_what_looking_at_all_pairs_finds(
            soup in prop::collection::vec((vector(1.0), prop::array::uniform3(vector(1.0)), -3..3_i32, vector(1.0), -4..5_i32), 1..60),
            far in prop::sample::select(vec![0.0, 1e3, 1e6, 1e11]),
            drift in vector(0.5),
            reach in prop::sample::select(vec![1e-6_f32, 0.02, 0.5]),
        ) {
            let (mut from, mut to) = (Vec::new(), Vec::new());
            for (center, corners, size, way, speed) in soup {
                let way = 10_f32.powi(speed) * way;
                for corner in corners {
                    let p = center + 0.1 * 4_f32.powi(size) * corner + Vec3::splat(far);
                    from.push(p);
                    to.push(p + way);
                }
            }
            let n = u32::try_from(from.len()).unwrap();
            // Neighbors share a corner.
            let triangles: Vec<_> = (0..n - 2).step_by(2).map(|k| [k, k + 1, k + 2]).collect();
            let surface = Surface::new(&triangles, from.len()).unwrap();
            let mut broad = Broad::default();
            let expected = brute(&surface, &from, &to, drift, reach);
            prop_assert_eq!(broad.find(&surface, &from, &to, drift, reach), expected.len());
            prop_assert_eq!(sorted(&broad.pieces), expected);
        }
    }

    #[test]
    fn a_particle_flying_off_does_not_coarsen_the_cells() {
        let n = 40_u32;
        // Across the seam of the table.
        let mut from: Vec<Vec3> =
            (0..n * n).map(|k| Vec3::new((k % n) as f32 - 20.0, 0.0, (k / n) as f32 - 20.0)).collect();
        let triangles: Vec<_> = (0..n * n - n - 1).map(|k| [k, k + 1, k + n]).collect();
        let surface = Surface::new(&triangles, from.len()).unwrap();
        from[77].y = 1e6;
        let mut broad = Broad::default();
        let found = broad.find(&surface, &from, &from, Vec3::ZERO, 0.6);
        assert_eq!(found, brute(&surface, &from, &from, Vec3::ZERO, 0.6).len());
    }
}
