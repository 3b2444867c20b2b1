//! The guard: ways are shortened until nothing passes through anything.

use glam::Vec3;
use vivace_graph::DisjointSets;

use crate::broad::{Broad, Piece, Scope};
use crate::motion::Motion;
use crate::narrow::points;
use crate::parallel::for_each;
use crate::proximity::Pair;

/// Of the thickness, the gap that is left where something would pass.
pub(crate) const GAP: f32 = 0.1;
/// Of the distance at the start, the gap that is left at most.
const GAP_OF_START: f64 = 0.2;
/// Of the thickness: what is pressed together for many frames comes no nearer. In `f32` its side would be lost, and it would hang together for good.
const FLOOR: f64 = 2e-3;
/// Of a gap, what counts as kept.
const KEPT: f64 = 0.8;
/// What each round asks for less than the one before, so that it accepts what that one left.
const LESS: f64 = 0.7;
/// Of the thickness, how far from its way a particle may be put to keep what it has in common with those around it.
const ASIDE: f32 = 0.5;
/// Rounds in which particles that hit keep their common motion.
const COMMON_ROUNDS: usize = 6;
/// Rounds after which particles that hit stay where they are.
const STAY_AFTER: usize = 14;
/// Rounds after which all particles stay where they are.
const GIVE_UP_AFTER: usize = 60;

/// What the guard keeps from frame to frame.
#[derive(Default)]
pub(crate) struct Guard {
    /// Where the ways would end.
    ends: Vec<Vec3>,
    /// The part of its way that each particle may go; 1 if it does not hit.
    parts: Vec<f32>,
    /// Whether the last round changed its way.
    changed: Vec<bool>,
    /// Particles that hit in this round.
    hit: Vec<u32>,
    zones: Zones,
    /// Particles that were held back, ever.
    held: Vec<bool>,
}

impl Guard {
    /// Shortens ways until nothing hits; with `together`, particles keep what they have in common if that is little aside of their ways.
    /// The first round looks at pairs of `scope`, each other one at those of which a particle's way was changed. Returns the candidates, rounds, and how many particles were
    /// held back.
    pub(crate) fn hold(
        &mut self,
        broad: &mut Broad,
        from: &[Vec3],
        to: &mut [Vec3],
        thickness: f32,
        together: bool,
        scope: Scope<'_>,
    ) -> [usize; 3] {
        let n = from.len();
        let mut n_candidates = broad.find(from, to, GAP * thickness, scope);
        reset(&mut self.held, n, false);
        for round in 0..GIVE_UP_AFTER {
            find_hits(&mut broad.pieces, from, to, thickness, round);
            if broad.pieces.iter().all(|piece| piece.hits.is_empty()) {
                return [n_candidates, round + 1, self.n_held()];
            }
            if round == 0 {
                self.ends.clear();
                self.ends.extend_from_slice(to);
                reset(&mut self.parts, n, 1.0);
                reset(&mut self.changed, n, false);
            }
            let aside = if together && round < COMMON_ROUNDS { ASIDE * thickness } else { 0.0 };
            self.shorten(&broad.pieces, from, to, aside, round >= STAY_AFTER);
            n_candidates += broad.find(from, to, GAP * thickness, Scope::Changed(&self.changed));
        }
        to.copy_from_slice(from);
        [n_candidates, GIVE_UP_AFTER, n]
    }

    fn n_held(&self) -> usize {
        self.held.iter().filter(|held| **held).count()
    }

    fn shorten(&mut self, pieces: &[Piece], from: &[Vec3], to: &mut [Vec3], aside: f32, stay: bool) {
        self.changed.fill(false);
        self.hit.clear();
        for (ids, time) in pieces.iter().flat_map(|piece| &piece.hits) {
            for &v in ids {
                if !std::mem::replace(&mut self.changed[v as usize], true) {
                    self.hit.push(v);
                }
                let part = &mut self.parts[v as usize];
                *part = part.min(*time);
            }
        }
        if aside > 0.0 {
            self.zones.gather(pieces, from, to);
        }
        for &v in &self.hit {
            let i = v as usize;
            self.held[i] = true;
            let part = if stay { 0.0 } else { self.parts[i] };
            self.parts[i] = 1.0;
            let way = to[i] - from[i];
            to[i] = from[i] + part * way;
            if aside > 0.0 {
                let common = self.zones.common(v);
                let place = from[i] + common + part * (way - common);
                if distance_to_segment(place, from[i], self.ends[i]) <= aside {
                    to[i] = place;
                }
            }
        }
    }
}

fn find_hits(pieces: &mut [Piece], from: &[Vec3], to: &[Vec3], thickness: f32, round: usize) {
    let less = LESS.powi(i32::try_from(round.min(STAY_AFTER)).unwrap_or(0));
    for_each(pieces, 1, &|_, Piece { points, edges, hits, .. }: &mut Piece| {
        hits.clear();
        for (pair, list) in [(Pair::PointTriangle, points), (Pair::EdgeEdge, edges)] {
            let hit = |&ids: &[u32; 4]| Some((ids, hit(pair, ids, from, to, thickness, less)?));
            hits.extend(list.iter().filter_map(hit));
        }
    });
}

fn reset<T: Clone>(values: &mut Vec<T>, n: usize, value: T) {
    values.clear();
    values.resize(n, value);
}

/// How far `point` is from the segment between `a` and `b` \[m\].
fn distance_to_segment(point: Vec3, a: Vec3, b: Vec3) -> f32 {
    let ab = b - a;
    let squared = ab.length_squared();
    let t = if squared > 0.0 { ((point - a).dot(ab) / squared).clamp(0.0, 1.0) } else { 0.0 };
    (point - a - t * ab).length()
}

/// When a pair comes nearer than it may.
fn hit(pair: Pair, ids: [u32; 4], from: &[Vec3], to: &[Vec3], thickness: f32, less: f64) -> Option<f32> {
    // Most pairs are candidates for contacts, and far from a hit.
    if pair.is_clear(ids, from, to, GAP * thickness) {
        return None;
    }
    let (start, end) = (points(from, ids), points(to, ids));
    let nearest = pair.nearest(&start);
    let apart = nearest.distance();
    let motion = Motion::new(pair, start, end);
    let floor = FLOOR * f64::from(thickness);
    let gap = (less * f64::from(GAP * thickness).min(GAP_OF_START * apart)).max(floor);
    let least = KEPT * if apart < KEPT * floor { apart } else { gap };
    // What touches at the start has no side to be kept on.
    if apart <= 0.0 || apart > gap + motion.speed || motion.speed == 0.0 {
        return None;
    }
    motion.first_within(pair, least, (0.0, nearest))?;
    #[expect(clippy::cast_possible_truncation, reason = "rounded; the next round looks where that leads")]
    motion.first_within(pair, gap, (0.0, nearest)).map(|(time, _)| time as f32)
}

/// Particles that hit one another in a round, directly or in a chain, and the mean of their ways.
#[derive(Default)]
struct Zones {
    sets: DisjointSets,
    sum: Vec<Vec3>,
    count: Vec<u32>,
}

impl Zones {
    fn gather(&mut self, pieces: &[Piece], from: &[Vec3], to: &[Vec3]) {
        let n = from.len();
        self.sets.reset(u32::try_from(n).unwrap_or(u32::MAX));
        reset(&mut self.sum, n, Vec3::ZERO);
        reset(&mut self.count, n, 0);
        let hits = || pieces.iter().flat_map(|piece| &piece.hits);
        for (ids, _) in hits() {
            ids[1..].iter().for_each(|&v| self.sets.unite(ids[0], v));
        }
        // A particle counts as often as it hits; one that stays makes the zone stay.
        for &v in hits().flat_map(|(ids, _)| ids) {
            let root = self.sets.first(v) as usize;
            let way = to[v as usize] - from[v as usize];
            self.sum[root] += way;
            self.count[root] = if way == Vec3::ZERO { u32::MAX } else { self.count[root].saturating_add(1) };
        }
    }

    /// The mean way of the zone of `v` \[m\]; 0 if one of its particles stays.
    fn common(&mut self, v: u32) -> Vec3 {
        let root = self.sets.first(v) as usize;
        if self.count[root] == u32::MAX { Vec3::ZERO } else { self.sum[root] / self.count[root] as f32 }
    }
}
