//! From candidates to contacts.

use glam::{DVec3, Vec3};

use crate::contact::Contact;
use crate::detector::Options;
use crate::motion::Motion;
use crate::proximity::{Nearest, Pair, nearest_of_lines};

/// Of the distance that a pair has at rest, what it has to keep if that is less than the thickness.
const KEPT_AT_REST: f64 = 0.5;
/// Of the distance at rest, how much nearer than that margin may reach: so that a surface at rest has no contacts with itself.
const MARGIN_AT_REST: f64 = 0.25;
/// Of the thickness: nearer pairs have no side on which they are, so those that touch at rest are left alone.
const TOUCHING: f64 = 1e-6;

/// What a frame of candidates is looked at with.
#[derive(Clone, Copy)]
pub(crate) struct Frame<'a> {
    pub(crate) rest: &'a [Vec3],
    pub(crate) from: &'a [Vec3],
    pub(crate) to: &'a [Vec3],
}

#[inline]
pub(crate) fn points(all: &[Vec3], [a, b, c, d]: [u32; 4]) -> [DVec3; 4] {
    let at = |v: u32| all[v as usize].as_dvec3();
    [at(a), at(b), at(c), at(d)]
}

impl Frame<'_> {
    /// The contact of a pair if it comes near enough; its direction is from the time before it does, so from the side of the start.
    pub(crate) fn contact(&self, pair: Pair, ids: [u32; 4], options: &Options) -> Option<Contact> {
        let (thickness, margin) = (f64::from(options.thickness), f64::from(options.margin));
        let at_rest = self.at_rest(pair, ids, (thickness / KEPT_AT_REST).max(margin / MARGIN_AT_REST));
        let distance = thickness.min(KEPT_AT_REST * at_rest);
        let reach = distance + margin.min(MARGIN_AT_REST * at_rest);
        let start = points(self.from, ids);
        let mut nearest = pair.nearest(&start);
        if nearest.distance() > distance {
            let motion = Motion::new(pair, start, points(self.to, ids));
            let met = motion.first_within(pair, reach, (0.0, nearest))?;
            nearest = motion.first_within(pair, distance, met).map_or_else(
                || {
                    let end = pair.nearest(&motion.at(1.0));
                    if end.distance() <= reach { end } else { met.1 }
                },
                |(_, nearest)| nearest,
            );
        }
        (nearest.distance() > TOUCHING * thickness)
            .then(|| contact(ids, &nearest, distance, options.friction))
    }

    /// The distance at rest \[m\], if it may be less than `far`; else that or more.
    fn at_rest(&self, pair: Pair, ids: [u32; 4], far: f64) -> f64 {
        let x = points(self.rest, ids);
        // Between two points of the pair, less what either primitive extends from there.
        let extent =
            |side: &[DVec3]| side.iter().map(|p| p.distance_squared(side[0])).fold(0.0, f64::max).sqrt();
        let (one, other) = x.split_at(pair.first_side());
        let bound = one[0].distance(other[0]) - extent(one) - extent(other);
        if bound > far { bound } else { pair.nearest(&x).distance() }
    }

    /// Whether the points where the lines of two edges are nearest lie beyond the same end of one of them both at the start and at
    /// the end: then others' ends are what is near.
    pub(crate) fn is_beside(&self, ids: [u32; 4]) -> bool {
        let [start, end] = [self.from, self.to].map(|all| nearest_of_lines(&points(all, ids)));
        start.iter().zip(end).any(|(&start, end)| start.max(end) <= 0.0 || start.min(end) >= 1.0)
    }
}

#[expect(clippy::cast_possible_truncation, reason = "rounded")]
fn contact(particles: [u32; 4], nearest: &Nearest, distance: f64, friction: f32) -> Contact {
    Contact {
        particles,
        weights: nearest.weights.map(|w| w as f32),
        normal: nearest.separation.normalize().as_vec3(),
        origin: Vec3::ZERO,
        velocity: Vec3::ZERO,
        distance: distance as f32,
        friction,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An edge along x above one along z that crosses x = `start` and then x = `end`.
    #[test]
    fn edges_that_pass_over_each_other_are_not_beside() {
        let edges =
            |x: f32| [[0.0, 0.1, 0.0], [1.0, 0.1, 0.0], [x, 0.0, -1.0], [x, 0.0, 1.0]].map(Vec3::from_array);
        for (start, end, is_beside) in [
            (0.5, 0.5, false),
            (-0.1, -0.1, true),
            (1.1, 1.2, true),
            (-0.1, 0.1, false),
            (0.9, 1.1, false),
            (-0.1, 1.1, false),
        ] {
            let (from, to) = (edges(start), edges(end));
            let frame = Frame { rest: &from, from: &from, to: &to };
            assert_eq!(frame.is_beside([0, 1, 2, 3]), is_beside, "{start} {end}");
            assert_eq!(frame.is_beside([2, 3, 0, 1]), is_beside, "{start} {end}");
        }
        let parallel = [Vec3::ZERO, Vec3::X, 2.0 * Vec3::X, 3.0 * Vec3::X];
        let frame = Frame { rest: &parallel, from: &parallel, to: &parallel };
        assert!(!frame.is_beside([0, 1, 2, 3]));
    }

    /// What is asked for decides between the exact distance and a bound that is less.
    #[test]
    fn the_distance_at_rest_is_exact_unless_it_is_far() {
        let rest = [[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.0, 0.3, 0.0], [0.1, 0.3, 0.0]].map(Vec3::from_array);
        let frame = Frame { rest: &rest, from: &rest, to: &rest };
        let at_rest = |far: f64| frame.at_rest(Pair::EdgeEdge, [0, 1, 2, 3], far);
        assert!((at_rest(0.2) - 0.3).abs() < 1e-6);
        assert!((at_rest(0.05) - 0.1).abs() < 1e-6);
    }
}
