//! How near two primitives are, and when: a point and a triangle, or two edges. What `vivace-collision` does in `f64`, in what a device has.
//!
//! All points are taken relative to the first, so that nothing cancels far from the origin. A distance is then wrong by some 10⁻⁶ of the
//! primitives' size, for two edges at an angle of less than a thousandth up to 10⁻⁴ of it.

use glam::{Vec3, Vec4};

/// The same in WGSL.
pub(super) const WGSL: &str = include_str!("proximity.wgsl");

/// Set in the first particle of a pair of edges.
pub const EDGES: u32 = 1 << 31;

/// The squared sine below which three points are taken as on one line.
const FLAT: f32 = 1e-12;
/// Steps after which a pair counts as met where it is: safe, if early.
const MAX_STEPS: u32 = 256;
/// Part of the distance sought that one step may undercut, so that a pair that grazes it ends.
const UNDERCUT: f32 = 0.05;

/// The nearest points of two primitives: `separation` = Σ `weights[k]` · x\[k\], from the second primitive to the first.
#[derive(Debug, Clone, Copy)]
pub(super) struct Nearest {
    pub(super) weights: Vec4,
    pub(super) separation: Vec3,
}

impl Nearest {
    fn of(weights: Vec4, x: &[Vec3; 4]) -> Self {
        let separation = weights.y * x[1] + weights.z * x[2] + weights.w * x[3];
        Self { weights, separation }
    }
}

/// The nearest points of a pair, the first of which lies at the origin \[m\].
pub(super) fn nearest(is_edges: bool, x: &[Vec3; 4]) -> Nearest {
    if is_edges { edge_edge(x) } else { point_triangle(x) }
}

/// A quotient between 0 and 1; 0 where there is none.
fn ratio(numerator: f32, denominator: f32) -> f32 {
    if denominator > 0.0 { (numerator / denominator).clamp(0.0, 1.0) } else { 0.0 }
}

/// Where on the segment from `a` to `b` the point nearest to the origin lies, from 0 to 1.
fn foot(a: Vec3, b: Vec3) -> f32 {
    let ab = b - a;
    ratio(-a.dot(ab), ab.dot(ab))
}

/// Barycentric coordinates where the foot of the point is inside, else the nearest of the sides that the point is beyond.
fn point_triangle(x: &[Vec3; 4]) -> Nearest {
    let &[_, a, b, c] = x;
    let (ab, ac) = (b - a, c - a);
    let normal = ab.cross(ac);
    let area = normal.dot(normal);
    let is_flat = area <= FLAT * ab.dot(ab) * ac.dot(ac);
    let v = ac.cross(a).dot(normal);
    let w = a.cross(ab).dot(normal);
    let u = area - v - w;
    if !is_flat && u >= 0.0 && v >= 0.0 && w >= 0.0 {
        return Nearest::of(Vec4::new(1.0, -u / area, -v / area, -w / area), x);
    }
    let mut best = Nearest::of(Vec4::new(1.0, -1.0, 0.0, 0.0), x);
    let mut least = f32::MAX;
    if is_flat || w < 0.0 {
        let t = foot(a, b);
        let side = Nearest::of(Vec4::new(1.0, t - 1.0, -t, 0.0), x);
        let squared = side.separation.dot(side.separation);
        if squared < least {
            (best, least) = (side, squared);
        }
    }
    if is_flat || u < 0.0 {
        let t = foot(b, c);
        let side = Nearest::of(Vec4::new(1.0, 0.0, t - 1.0, -t), x);
        let squared = side.separation.dot(side.separation);
        if squared < least {
            (best, least) = (side, squared);
        }
    }
    if is_flat || v < 0.0 {
        let t = foot(c, a);
        let side = Nearest::of(Vec4::new(1.0, -t, 0.0, t - 1.0), x);
        if side.separation.dot(side.separation) < least {
            best = side;
        }
    }
    best
}

/// The nearest points of the lines, brought back into the segments one after the other (Ericson 2005, 5.1.9). However nearly
/// parallel, the second is the nearest to the first.
fn edge_edge(x: &[Vec3; 4]) -> Nearest {
    let &[_, b, c, d] = x;
    let v = d - c;
    let (uu, vv, uv) = (b.dot(b), v.dot(v), b.dot(v));
    let (ur, vr) = (-b.dot(c), -v.dot(c));
    let mut s = ratio(uv * vr - ur * vv, uu * vv - uv * uv);
    let mut t = if vv > 0.0 { (uv * s + vr) / vv } else { 0.0 };
    if vv <= 0.0 || !(0.0..=1.0).contains(&t) {
        t = t.clamp(0.0, 1.0);
        s = ratio(t * uv - ur, uu);
    }
    Nearest::of(Vec4::new(1.0 - s, s, t - 1.0, -t), x)
}

/// Whether two primitives stay more than `reach` \[m\] apart on their straight ways from `start` to `end`, told by one axis, that from
/// center to center: along it, the gap between them is a concave function of time, so its ends are enough.
pub(super) fn is_clear(is_edges: bool, start: &[Vec3; 4], end: &[Vec3; 4], reach: f32) -> bool {
    let axis = if is_edges { start[1] - (start[2] + start[3]) } else { -(start[1] + start[2] + start[3]) };
    let least = reach * axis.length();
    gap(is_edges, axis, start) > least && gap(is_edges, axis, end) > least
}

/// How far apart two primitives are along an axis, times its length \[m\]; the first point lies at the origin.
pub(super) fn gap(is_edges: bool, axis: Vec3, x: &[Vec3; 4]) -> f32 {
    let (a, b, c) = (axis.dot(x[1]), axis.dot(x[2]), axis.dot(x[3]));
    if is_edges { a.min(0.0) - b.max(c) } else { -a.max(b).max(c) }
}

/// Four points relative to the first \[m\], and how far they go, linearly, from time 0 to 1 \[m\].
#[derive(Debug, Clone, Copy)]
pub(super) struct Motion {
    pub(super) is_edges: bool,
    pub(super) start: [Vec3; 4],
    pub(super) end: [Vec3; 4],
    /// What the distance may change in a unit of time, at most \[m\].
    pub(super) speed: f32,
}

/// The corners of a pair relative to the first of them.
pub(super) fn relative(pair: [u32; 4], positions: &[Vec4]) -> [Vec3; 4] {
    let x = |k: usize| positions[(pair[k] & !EDGES) as usize].truncate();
    [Vec3::ZERO, x(1) - x(0), x(2) - x(0), x(3) - x(0)]
}

impl Motion {
    /// The ways of a pair. What all four have in common does not count.
    pub(super) fn new(pair: [u32; 4], from: &[Vec4], to: &[Vec4]) -> Self {
        let is_edges = pair[0] >= EDGES;
        let (start, end) = (relative(pair, from), relative(pair, to));
        let way = [0, 1, 2, 3].map(|k| end[k] - start[k]);
        let common = 0.25 * (way[1] + way[2] + way[3]);
        let squared = way.map(|way| (way - common).dot(way - common));
        let second = squared[2].max(squared[3]);
        let speed = if is_edges {
            squared[0].max(squared[1]).sqrt() + second.sqrt()
        } else {
            squared[0].sqrt() + squared[1].max(second).sqrt()
        };
        Self { is_edges, start, end, speed }
    }

    pub(super) fn at(&self, time: f32) -> Nearest {
        nearest(self.is_edges, &[0, 1, 2, 3].map(|k| self.start[k] + time * (self.end[k] - self.start[k])))
    }

    /// The first time, found in steps, at which the distance is `reach` \[m\] or less, from time `from` on; not less than 0.95
    /// `reach`, if it was not before. `None` if it stays larger until time 1 (additive conservative advancement, Li et al. 2021,
    /// "Codimensional Incremental Potential Contact").
    pub(super) fn first_within(&self, reach: f32, from: f32) -> Option<(f32, Nearest)> {
        let mut time = from;
        for _ in 0..MAX_STEPS {
            let nearest = self.at(time);
            let left = nearest.separation.length() - reach;
            if left <= 0.0 {
                return Some((time, nearest));
            }
            // Written so that a speed of 0 ends.
            let to_go = (1.0 - time) * self.speed;
            if left >= to_go {
                return None;
            }
            let step = left.max(UNDERCUT * reach);
            if step >= to_go {
                let nearest = self.at(1.0);
                return (nearest.separation.length() <= reach).then_some((1.0, nearest));
            }
            time += step / self.speed;
        }
        Some((time, self.at(time)))
    }
}
