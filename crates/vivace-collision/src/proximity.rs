//! How near two primitives are: a point and a triangle, or two edges. In `f64`, so that positions in `f32` have exact
//! differences and a nearly parallel pair of edges is none that needs a choice.

use glam::{DVec3, Vec3, Vec3A};

/// Four points, and which two primitives they are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Pair {
    /// A point, then the corners of a triangle.
    PointTriangle,
    /// The ends of one edge, then those of another.
    EdgeEdge,
}

/// The nearest points of two primitives: `separation` = Σ `weights[k]` · x\[k\], from the second primitive to the first.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Nearest {
    pub(crate) weights: [f64; 4],
    pub(crate) separation: DVec3,
}

impl Nearest {
    fn of(weights: [f64; 4], x: &[DVec3; 4]) -> Self {
        // Weights add up to 0: differences alone count.
        let separation = (1..4).map(|k| weights[k] * (x[k] - x[0])).sum();
        Self { weights, separation }
    }

    pub(crate) fn distance(&self) -> f64 {
        self.separation.length()
    }
}

impl Pair {
    /// The nearest points. An upper bound of the distance whatever the rounding: they are points of the primitives.
    pub(crate) fn nearest(self, x: &[DVec3; 4]) -> Nearest {
        match self {
            Self::PointTriangle => point_triangle(x),
            Self::EdgeEdge => edge_edge(x),
        }
    }

    /// How many of the four points are of the first primitive.
    pub(crate) fn first_side(self) -> usize {
        match self {
            Self::PointTriangle => 1,
            Self::EdgeEdge => 2,
        }
    }

    /// The gap between the primitives along an axis that leads from the second to the first \[m\], times the axis' length.
    #[inline]
    pub(crate) fn gap(self, axis: DVec3, x: &[DVec3; 4]) -> f64 {
        let [a, b, c] = [axis.dot(x[1] - x[0]), axis.dot(x[2] - x[0]), axis.dot(x[3] - x[0])];
        match self {
            Self::PointTriangle => -a.max(b).max(c),
            Self::EdgeEdge => a.min(0.0) - b.max(c),
        }
    }

    /// Whether two primitives stay more than `reach` \[m\] apart on their straight ways, told by one of a few axes: that from center to
    /// center at the start, and what is of it across an edge. Along an axis, the gap between them is a concave function of time, so its
    /// ends are enough. In `f32`, and sure: any axis would do, and dot products are wrong by less than [`DOT_ERROR`] of the longest side.
    #[inline]
    pub(crate) fn is_clear(self, ids: [u32; 4], from: &[Vec3], to: &[Vec3], reach: f32) -> bool {
        let [x, a, b, c] = ids;
        let sides = |all: &[Vec3]| {
            let at = |v: u32| Vec3A::from(all[v as usize]);
            let x = at(x);
            [at(a) - x, at(b) - x, at(c) - x]
        };
        let ways = [sides(from), sides(to)];
        let longest =
            ways.as_flattened().iter().fold(Vec3A::ZERO, |most, side| most.max(side.abs())).element_sum();
        let reach = reach + DOT_ERROR * longest;
        let tells = |axis: Vec3A| {
            let gap = |sides: [Vec3A; 3]| {
                let [a, b, c] = sides.map(|side| axis.dot(side));
                match self {
                    Self::PointTriangle => a.min(b).min(c),
                    Self::EdgeEdge => b.min(c) - a.max(0.0),
                }
            };
            gap(ways[0]).min(gap(ways[1])) > reach * axis.length() + f32::MIN_POSITIVE
        };
        let [a, b, c] = ways[0];
        match self {
            Self::PointTriangle => tells(a + b + c),
            Self::EdgeEdge => {
                let axis = b + c - a;
                let across = |edge: Vec3A| axis - edge * (axis.dot(edge) / edge.length_squared());
                tells(axis) || tells(across(a)) || tells(across(c - b))
            }
        }
    }
}

/// Of a dot product in `f32`, more than its roundings add up to, with those of the vectors' differences.
const DOT_ERROR: f32 = 16.0 * f32::EPSILON;

/// The squared sine below which three points are taken as on one line.
const FLAT: f64 = 1e-20;

/// Barycentric coordinates where the foot of the point is inside, else the nearest of the sides that the point is beyond.
fn point_triangle(x: &[DVec3; 4]) -> Nearest {
    let &[p, a, b, c] = x;
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let normal = ab.cross(ac);
    let area = normal.length_squared();
    let flat = area <= FLAT * ab.length_squared() * ac.length_squared();
    let v = ap.cross(ac).dot(normal);
    let w = ab.cross(ap).dot(normal);
    let u = area - v - w;
    if !flat && u >= 0.0 && v >= 0.0 && w >= 0.0 {
        return Nearest::of([1.0, -u / area, -v / area, -w / area], x);
    }
    let mut best: Option<(f64, Nearest)> = None;
    for (beyond, from, to) in [(w, 1, 2), (u, 2, 3), (v, 3, 1)] {
        if !flat && beyond >= 0.0 {
            continue;
        }
        let t = foot(p, x[from], x[to]);
        let mut weights = [1.0, 0.0, 0.0, 0.0];
        weights[from] = t - 1.0;
        weights[to] = -t;
        let side = Nearest::of(weights, x);
        let squared = side.separation.length_squared();
        if best.is_none_or(|(least, _)| squared < least) {
            best = Some((squared, side));
        }
    }
    // One coordinate is negative, so there is a side, but for what is not a number.
    best.map_or_else(|| Nearest::of([1.0, -1.0, 0.0, 0.0], x), |(_, side)| side)
}

/// Where on the segment from `a` to `b` the point nearest to `p` lies, from 0 to 1.
fn foot(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    let ab = b - a;
    ratio((p - a).dot(ab), ab.length_squared())
}

/// A quotient between 0 and 1; 0 where there is none.
fn ratio(numerator: f64, denominator: f64) -> f64 {
    if denominator > 0.0 { (numerator / denominator).clamp(0.0, 1.0) } else { 0.0 }
}

/// The nearest points of the lines, brought back into the segments one after the other (Ericson 2005, 5.1.9). However nearly
/// parallel, the second is the nearest to the first, so an error of the first costs its product with the angle.
fn edge_edge(x: &[DVec3; 4]) -> Nearest {
    let [uu, vv, uv, ur, vr] = products(x);
    let mut s = ratio(uv * vr - ur * vv, uu * vv - uv * uv);
    let mut t = if vv > 0.0 { (uv * s + vr) / vv } else { 0.0 };
    if vv <= 0.0 || !(0.0..=1.0).contains(&t) {
        t = t.clamp(0.0, 1.0);
        s = ratio(t * uv - ur, uu);
    }
    Nearest::of([1.0 - s, s, t - 1.0, -t], x)
}

/// Dot products of two edges u and v, and of each with what leads from the start of v to that of u: uu, vv, uv, ur, vr.
fn products(x: &[DVec3; 4]) -> [f64; 5] {
    let &[a, b, c, d] = x;
    let (u, v, r) = (b - a, d - c, a - c);
    [u.length_squared(), v.length_squared(), u.dot(v), u.dot(r), v.dot(r)]
}

/// Where on the lines through two edges their nearest points are, from 0 to 1 inside of the edge; not a number for parallel ones.
pub(crate) fn nearest_of_lines(x: &[DVec3; 4]) -> [f64; 2] {
    let [uu, vv, uv, ur, vr] = products(x);
    let inverse = (uu * vv - uv * uv).recip();
    [(uv * vr - ur * vv) * inverse, (uu * vr - uv * ur) * inverse]
}

#[cfg(test)]
mod tests {
    #![expect(clippy::cast_possible_truncation, reason = "rounded")]

    use super::*;

    fn check(pair: Pair, x: [[f64; 3]; 4], distance: f64) {
        let x = x.map(DVec3::from);
        let nearest = pair.nearest(&x);
        assert!((nearest.distance() - distance).abs() < 1e-12, "{pair:?} {x:?}: {nearest:?}");
        let still = x.map(DVec3::as_vec3);
        assert!(!pair.is_clear([0, 1, 2, 3], &still, &still, distance as f32), "{pair:?} {x:?}");
        let sum: f64 = nearest.weights.iter().sum();
        assert!(sum.abs() < 1e-12);
    }

    #[test]
    fn points_and_triangles_by_hand() {
        let [a, b, c] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        for (p, distance) in [
            ([0.25, 0.25, 2.0], 2.0),
            ([-1.0, 0.5, 0.0], 1.0),
            ([-3.0, -4.0, 0.0], 5.0),
            ([1.0, 1.0, 0.0], 0.5_f64.sqrt()),
            ([0.5, 0.5, 0.0], 0.0),
        ] {
            check(Pair::PointTriangle, [p, a, b, c], distance);
        }
        // Without an area: a needle and a point.
        check(Pair::PointTriangle, [[0.5, 1.0, 0.0], a, b, [0.25, 0.0, 0.0]], 1.0);
        check(Pair::PointTriangle, [[3.0, 0.0, 4.0], a, a, a], 5.0);
    }

    #[test]
    fn edges_by_hand() {
        let [a, b] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]];
        for (c, d, distance) in [
            ([0.5, -1.0, 2.0], [0.5, 1.0, 2.0], 2.0),
            ([0.25, 1.0, 0.0], [0.75, 1.0, 0.0], 1.0),
            ([2.0, 0.0, 0.0], [3.0, 0.0, 0.0], 1.0),
            ([0.5, 3.0, 0.0], [0.5, 1.0, 0.0], 1.0),
            ([4.0, 4.0, 0.0], [4.0, 4.0, 0.0], 5.0),
            ([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], 0.0),
            ([0.0, 1.0, 0.0], [1.0, 1.0 + 1e-9, 0.0], 1.0),
        ] {
            check(Pair::EdgeEdge, [a, b, c, d], distance);
            check(Pair::EdgeEdge, [c, d, a, b], distance);
        }
        check(Pair::EdgeEdge, [a, a, [3.0, 4.0, 0.0], [3.0, 4.0, 0.0]], 5.0);
    }

    mod against_parry {
        use parry3d::math::Vector;
        use parry3d::query::PointQuery;
        use parry3d::shape::{Segment, Triangle};
        use proptest::prelude::*;

        use super::super::*;

        fn vector(size: f32) -> impl Strategy<Value = [f32; 3]> {
            prop::array::uniform3(-size..size)
        }

        proptest! {
            #![proptest_config(ProptestConfig::with_cases(5000))]

            #[test]
            fn distances_are_those_of_parry(x in prop::array::uniform4(vector(1.0))) {
                let p = x.map(Vector::from_array);
                let still = x.map(Vec3::from);
                let x = x.map(|x| DVec3::from(x.map(f64::from)));
                let ours = Pair::PointTriangle.nearest(&x);
                let theirs = Triangle::new(p[1], p[2], p[3]).distance_to_local_point(p[0], false);
                prop_assert!((ours.distance() - f64::from(theirs.abs())).abs() < 1e-4, "{ours:?} {theirs}");
                prop_assert!(!Pair::PointTriangle.is_clear([0, 1, 2, 3], &still, &still, ours.distance() as f32));

                let ours = Pair::EdgeEdge.nearest(&x);
                let (one, other) = (Segment::new(p[0], p[1]), Segment::new(p[2], p[3]));
                let identity = parry3d::math::Pose::IDENTITY;
                let theirs = parry3d::query::distance(&identity, &one, &identity, &other).unwrap();
                prop_assert!((ours.distance() - f64::from(theirs.distance)).abs() < 1e-4, "{ours:?} {theirs:?}");
                prop_assert!(!Pair::EdgeEdge.is_clear([0, 1, 2, 3], &still, &still, ours.distance() as f32));
            }

            /// Nothing on a fine raster of both primitives is nearer, however flat or parallel they are.
            #[test]
            fn nothing_is_nearer(x in prop::array::uniform4(vector(1.0)), flat in 0..12_i32) {
                let mut x = x.map(|x| DVec3::from(x.map(f64::from)));
                let squeeze = 10_f64.powi(-flat);
                x[3] = x[2] + (x[1] - x[0]) + squeeze * x[3];
                let edges = Pair::EdgeEdge.nearest(&x).distance();
                let mut y = [x[3], x[0], x[1], x[2]];
                y[3] = y[1].lerp(y[2], 0.3) + squeeze * y[3];
                let triangle = Pair::PointTriangle.nearest(&y).distance();
                let parts = || (0..=20).map(|k| f64::from(k) / 20.0);
                for s in parts() {
                    for t in parts() {
                        let d = x[0].lerp(x[1], s).distance(x[2].lerp(x[3], t));
                        prop_assert!(edges <= d + 1e-8, "{edges} {d}");
                        let d = y[0].distance(y[1].lerp(y[2], s).lerp(y[3], t));
                        prop_assert!(triangle <= d + 1e-8, "{triangle} {d}");
                    }
                }
            }
        }
    }
}
