//! From candidates to contacts.

use glam::{DVec3, Vec3};

use crate::contact::Contact;
use crate::detector::Options;
use crate::motion::Motion;
use crate::proximity::{Nearest, Pair};

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
        let mut reach = thickness + margin;
        let (start, end) = (points(self.from, ids), points(self.to, ids));
        let motion = Motion::new(pair, start, end);
        let mut met = motion.first_within(pair, reach, (0.0, pair.nearest(&start)))?;

        let at_rest = pair.nearest(&points(self.rest, ids)).distance();
        let distance = thickness.min(KEPT_AT_REST * at_rest);
        let near = distance + margin.min(MARGIN_AT_REST * at_rest);
        if near < reach {
            reach = near;
            met = motion.first_within(pair, reach, met)?;
        }
        met = motion.first_within(pair, distance, met).unwrap_or_else(|| {
            let end = pair.nearest(&motion.at(1.0));
            if end.distance() <= reach { (1.0, end) } else { met }
        });
        let nearest = met.1;
        (nearest.distance() > TOUCHING * thickness)
            .then(|| contact(ids, &nearest, distance, options.friction))
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
