//! Which pairs of primitives may come near each other.

use glam::Vec3;

use crate::boxes::Aabb;
use crate::cluster::{Cluster, clusters};
use crate::contact::Contact;
use crate::grid::Grid;
use crate::parallel::{for_each, piece};
use crate::proximity::Pair;
use crate::surface::Surface;

/// Pieces of the work: their number shows in no result.
const N_PIECES: usize = 64;
/// Clusters that are not worth a second thread.
const GRAIN: usize = 128;
/// Clusters that are looked at for the drift.
const N_SAMPLES: usize = 256;

/// What a search is for.
#[derive(Clone, Copy)]
pub(crate) enum Scope<'a> {
    /// All pairs.
    All,
    /// Pairs of the clusters that have these particles, whose ways alone have changed since the last search.
    Changed(&'a [bool]),
    /// Besides the candidates that are listed, those of a search for all pairs on the way to other ends: pairs of clusters that go so
    /// differently that what was farther apart than `slack` \[m\] beyond the reach may come near.
    Since {
        /// The other ends \[m\].
        ends: &'a [Vec3],
        slack: f32,
    },
}

/// Candidates of one piece, and what becomes of them.
#[derive(Default)]
pub(crate) struct Piece {
    /// A point, and the corners of a triangle.
    pub(crate) points: Vec<[u32; 4]>,
    /// The ends of two edges.
    pub(crate) edges: Vec<[u32; 4]>,
    /// Contacts of these, then of those.
    pub(crate) contacts: Vec<Contact>,
    /// Pairs that hit, and when.
    pub(crate) hits: Vec<([u32; 4], f32)>,
}

/// Clusters, their boxes and candidates, kept so that a frame allocates nothing.
#[derive(Default)]
pub(crate) struct Broad {
    clusters: Vec<Cluster>,
    boxes: Vec<Aabb>,
    grid: Grid,
    pub(crate) pieces: Vec<Piece>,
    /// Whether the clusters' boxes are around other ways than those of the last search, which needed none.
    is_behind: bool,
}

impl Broad {
    /// For `surface`, whose particles are at `rest` \[m\] at rest.
    pub(crate) fn new(surface: &Surface, rest: &[Vec3]) -> Self {
        let mut pieces = Vec::new();
        pieces.resize_with(N_PIECES, Piece::default);
        Self {
            clusters: clusters(surface, rest),
            boxes: Vec::new(),
            grid: Grid::default(),
            pieces,
            is_behind: false,
        }
    }

    /// Lists in `pieces` all pairs without a common particle that come within `reach` \[m\] of each other on the way from `from` to
    /// `to`, and some that do not; counts them. Only those of `scope`.
    pub(crate) fn find(&mut self, from: &[Vec3], to: &[Vec3], reach: f32, scope: Scope<'_>) -> usize {
        if let Scope::Since { ends, slack } = scope {
            for_each(&mut self.clusters, GRAIN, &|_, cluster: &mut Cluster| cluster.stray(to, ends));
            self.is_behind = !Cluster::stray_apart(&self.clusters, slack);
            if self.is_behind {
                return self.n_candidates();
            }
        }
        let is_behind = std::mem::take(&mut self.is_behind);
        for_each(&mut self.clusters, GRAIN, &|_, cluster: &mut Cluster| {
            cluster.is_stale = !matches!(scope, Scope::Changed(changed) if !cluster.has(changed));
            if cluster.is_stale || is_behind {
                cluster.follow(from, to, 0.5 * reach);
            }
        });
        let is_wanted = |one: &Cluster, other: &Cluster| match scope {
            Scope::All => true,
            Scope::Changed(_) => one.is_stale || other.is_stale,
            Scope::Since { slack, .. } => one.strays(other) >= slack,
        };
        let drift = self.drift();
        self.boxes.clear();
        self.boxes.extend(self.clusters.iter().map(|cluster| cluster.seen(drift)));
        self.grid.build(&self.boxes);

        let (clusters, grid) = (&self.clusters, &self.grid);
        for_each(&mut self.pieces, 1, &|k, out: &mut Piece| {
            let Piece { points, edges, .. } = out;
            if !matches!(scope, Scope::Since { .. }) {
                points.clear();
                edges.clear();
            }
            let mut of_point = |v: u32, [a, b, c]: [u32; 3]| {
                let is_apart = v != a && v != b && v != c;
                if is_apart && !Pair::PointTriangle.is_clear([v, a, b, c], from, to, reach) {
                    points.push([v, a, b, c]);
                }
            };
            let mut of_edge = |[a, b]: [u32; 2], [c, d]: [u32; 2]| {
                let is_apart = a != c && a != d && b != c && b != d;
                if is_apart && !Pair::EdgeEdge.is_clear([a, b, c, d], from, to, reach) {
                    edges.push([a, b, c, d]);
                }
            };
            for place in piece(grid.len(), k, N_PIECES) {
                let one = &clusters[grid.at(place)];
                if is_wanted(one, one) {
                    one.meet_itself(&mut of_point, &mut of_edge);
                }
                grid.later_ones(place, |_, other| {
                    let other = &clusters[other as usize];
                    if is_wanted(one, other) {
                        one.meet(other, &mut of_point, &mut of_edge);
                    }
                });
            }
        });
        self.n_candidates()
    }

    fn n_candidates(&self) -> usize {
        self.pieces.iter().map(|piece| piece.points.len() + piece.edges.len()).sum()
    }

    /// How far most go \[m\]: axis by axis, the median of some clusters. Pairs do not see what all have in common.
    fn drift(&self) -> Vec3 {
        let stride = self.clusters.len().div_ceil(N_SAMPLES).max(1);
        let axis = |axis: usize| {
            let (mut ways, mut n) = ([0.0; N_SAMPLES], 0);
            for cluster in self.clusters.iter().step_by(stride) {
                ways[n] = cluster.way[axis];
                n += 1;
            }
            if n == 0 { 0.0 } else { *ways[..n].select_nth_unstable_by(n / 2, f32::total_cmp).1 }
        };
        Vec3::new(axis(0), axis(1), axis(2))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::motion::Motion;
    use crate::narrow::points;

    /// All pairs that come near, by following all pairs in `f64`.
    fn brute(surface: &Surface, from: &[Vec3], to: &[Vec3], reach: f32) -> Vec<(Pair, [u32; 4])> {
        let is_near = |pair: Pair, ids: [u32; 4]| {
            let is_apart = (0..4).all(|k| !ids[..k].contains(&ids[k]));
            let motion = Motion::new(pair, points(from, ids), points(to, ids));
            let met = motion.first_within(pair, reach.into(), (0.0, pair.nearest(&points(from, ids))));
            // After many steps it gives up, and says so of pairs that are not that near.
            is_apart && met.is_some_and(|(_, nearest)| nearest.distance() <= f64::from(reach))
        };
        let mut pairs = Vec::new();
        for &v in &surface.vertices {
            let triangles = surface.triangles.iter().map(|&[a, b, c]| [v, a, b, c]);
            let near = triangles.filter(|&ids| is_near(Pair::PointTriangle, ids));
            pairs.extend(near.map(|ids| (Pair::PointTriangle, ids)));
        }
        for (k, &[a, b]) in surface.edges.iter().enumerate() {
            let others = surface.edges[k + 1..].iter().map(|&[c, d]| [a, b, c, d]);
            let near = others.filter(|&ids| is_near(Pair::EdgeEdge, ids));
            pairs.extend(near.map(|ids| (Pair::EdgeEdge, ids)));
        }
        pairs
    }

    /// Edges in order.
    fn found(pieces: &[Piece]) -> Vec<(Pair, [u32; 4])> {
        let mut pairs = listed(pieces);
        let n = pairs.len();
        pairs.sort_unstable();
        pairs.dedup();
        assert_eq!(pairs.len(), n, "a pair is listed twice");
        pairs
    }

    fn listed(pieces: &[Piece]) -> Vec<(Pair, [u32; 4])> {
        let points = pieces.iter().flat_map(|piece| &piece.points).map(|&ids| (Pair::PointTriangle, ids));
        let edges = pieces.iter().flat_map(|piece| &piece.edges);
        let edges = edges.map(|&[a, b, c, d]| if [a, b] < [c, d] { [a, b, c, d] } else { [c, d, a, b] });
        points.chain(edges.map(|ids| (Pair::EdgeEdge, ids))).collect()
    }

    fn vector(size: f32) -> impl Strategy<Value = Vec3> {
        prop::array::uniform3(-size..size).prop_map(Vec3::from)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(600))]

        /// Triangles of all sizes, some gone far in the frame, together or on their own, around the origin and far from it.
        #[test]
        fn no_pair_that_comes_near_is_missed(
            soup in prop::collection::vec((vector(1.0), prop::array::uniform3(vector(1.0)), -3..3_i32, vector(1.0), -4..3_i32), 1..40),
            far in prop::sample::select(vec![0.0, 1e3, 1e6]),
            together in vector(3.0),
            reach in prop::sample::select(vec![1e-6_f32, 0.02, 0.5]),
        ) {
            let (mut from, mut to) = (Vec::new(), Vec::new());
            for (center, corners, size, way, speed) in soup {
                let way = 10_f32.powi(speed) * way + together;
                for corner in corners {
                    let p = center + 0.1 * 4_f32.powi(size) * corner + Vec3::splat(far);
                    from.push(p);
                    to.push(p + way + 0.1 * corner);
                }
            }
            let n = u32::try_from(from.len()).unwrap();
            // Neighbors share a corner.
            let triangles: Vec<_> = (0..n - 2).step_by(2).map(|k| [k, k + 1, k + 2]).collect();
            let surface = Surface::new(&triangles, from.len()).unwrap();
            let mut broad = Broad::new(&surface, &from);
            broad.find(&from, &to, reach, Scope::All);
            let all = found(&broad.pieces);
            for pair in brute(&surface, &from, &to, reach) {
                prop_assert!(all.binary_search(&pair).is_ok(), "{pair:?}");
            }
            // Some stay behind.
            let changed: Vec<bool> = (0..from.len()).map(|k| k % 7 == 3).collect();
            (0..from.len()).filter(|&k| changed[k]).for_each(|k| to[k] = from[k].lerp(to[k], 0.3));
            broad.find(&from, &to, reach, Scope::Changed(&changed));
            let some = found(&broad.pieces);
            for pair in brute(&surface, &from, &to, reach) {
                let is_new = pair.1.iter().any(|&v| changed[v as usize]);
                prop_assert!(!is_new || some.binary_search(&pair).is_ok(), "{pair:?}");
            }
            // All go elsewhere, together and each a little on its own.
            let near = 0.25 * reach;
            broad.find(&from, &to, reach, Scope::All);
            let other: Vec<Vec3> = (0..to.len()).map(|k| to[k] + together + (k % 3) as f32 * near * Vec3::X).collect();
            broad.find(&from, &other, near, Scope::Since { ends: &to, slack: reach - near });
            let pairs = listed(&broad.pieces);
            for pair in brute(&surface, &from, &other, near) {
                prop_assert!(pairs.contains(&pair), "{pair:?}");
            }
            // Then a few stay behind: other clusters are as they were.
            let mut other = other;
            let changed: Vec<bool> = (0..from.len()).map(|k| k < 3).collect();
            (0..3).for_each(|k| other[k] = from[k].lerp(other[k], 0.3));
            broad.find(&from, &other, near, Scope::Changed(&changed));
            let some = found(&broad.pieces);
            for pair in brute(&surface, &from, &other, near) {
                let is_new = pair.1.iter().any(|&v| changed[v as usize]);
                prop_assert!(!is_new || some.binary_search(&pair).is_ok(), "{pair:?}");
            }
        }
    }

    /// Flat cloth that falls and turns as one has no candidates, and one particle that flies off costs no more than itself.
    #[test]
    fn what_stays_apart_is_told_apart() {
        let n = 40_u32;
        let from: Vec<Vec3> =
            (0..n * n).map(|k| Vec3::new((k % n) as f32 - 20.0, 0.0, (k / n) as f32 - 20.0)).collect();
        let mut triangles = Vec::new();
        for k in (0..n * (n - 1)).filter(|k| k % n < n - 1) {
            triangles.extend([[k, k + 1, k + n], [k + n, k + 1, k + n + 1]]);
        }
        let surface = Surface::new(&triangles, from.len()).unwrap();
        let turn = glam::Quat::from_rotation_x(0.2);
        let mut to: Vec<Vec3> = from.iter().map(|p| turn * *p - 30.0 * Vec3::Y).collect();
        let mut broad = Broad::new(&surface, &from);
        assert_eq!(broad.find(&from, &to, 0.6, Scope::All), 0);
        to[777].y = 1e6;
        assert!(broad.find(&from, &to, 0.6, Scope::All) < 1000);
    }
}
