//! Particles and obstacles.

use glam::Vec3;

use crate::contact::Contact;
use crate::obstacle::Obstacle;

/// Cosine between the directions at the way's end and where it meets the solid, above which the end decides: the plane there is
/// the better one for a particle that slides, but not for one that comes out on another side.
const SAME_SIDE: f32 = 0.5;

/// The contact of a particle that goes from `from` to `to` \[m\] in `time_step` \[s\], if it comes within `thickness + margin` \[m\].
pub(crate) fn contact(
    obstacle: &Obstacle,
    particle: u32,
    [from, to]: [Vec3; 2],
    time_step: f32,
    [thickness, margin]: [f32; 2],
) -> Option<Contact> {
    let shape = &obstacle.shape;
    let (a, b) = (obstacle.from.to_local(from), obstacle.to.to_local(to));
    let near = shape.first_within(a, b, thickness + margin, 0.0)?;
    let part = shape.first_within(a, b, thickness, near).unwrap_or(1.0);
    let (mut point, mut seen) = (b, shape.seen_from(b));
    if part < 1.0 {
        let met = a.lerp(b, part);
        let there = shape.seen_from(met);
        if there.normal.dot(seen.normal) < SAME_SIDE {
            (point, seen) = (met, there);
        }
    }
    let foot = point - seen.distance * seen.normal;
    let origin = obstacle.to.to_world(foot);
    Some(Contact {
        particles: [particle; 4],
        weights: [1.0, 0.0, 0.0, 0.0],
        normal: obstacle.to.rotation * seen.normal,
        origin,
        velocity: (origin - obstacle.from.to_world(foot)) / time_step,
        distance: thickness,
        friction: obstacle.friction,
    })
}

/// Where a particle may go that would go from `from` to `to` \[m\] if it has to stay `gap` \[m\] outside; `None` if it may go there. With `slide`,
/// it is put beside the surface at the end of its way where that is the same side; else it stops on its way.
pub(crate) fn keep_out(obstacle: &Obstacle, [from, to]: [Vec3; 2], gap: f32, slide: bool) -> Option<Vec3> {
    let shape = &obstacle.shape;
    let (a, b) = (obstacle.from.to_local(from), obstacle.to.to_local(to));
    let part = shape.first_within(a, b, gap, 0.0)?;
    let met = a.lerp(b, part);
    let (there, end) = (shape.seen_from(met), shape.seen_from(b));
    let place = if slide && there.normal.dot(end.normal) >= SAME_SIDE {
        if end.distance >= gap {
            return None;
        }
        b + (gap - end.distance) * end.normal
    } else {
        met
    };
    Some(obstacle.to.to_world(place))
}
