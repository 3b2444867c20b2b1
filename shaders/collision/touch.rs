//! From pairs to contacts.

use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec4};

use super::proximity::{self, EDGES, Motion, Nearest, is_clear, nearest, relative};
use super::{BETWEEN_EDGES, Contact};
use crate::{Expand, HostViews, Kernel};

/// The contact of pair `i` if it comes near enough; its direction is from the time before it does, so from the side of the start. Reads
/// (pairs, positions at rest \[m\], from \[m\] and the inverse mass \[1/kg\], to \[m\]).
///
/// Where and when it is found in steps; a device may round otherwise, and what is near the limit may be a contact on one and not on
/// another.
#[derive(Debug)]
pub struct Touch;

/// Parameters of [`Touch`].
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct TouchUniform {
    /// The distance that contacts keep \[m\].
    pub thickness: f32,
    /// By how much more pairs may be apart \[m\].
    pub margin: f32,
    /// Coulomb's coefficient \[1\].
    pub friction: f32,
    /// Whether edges whose nearest points are not inside of both have a contact, too: an end is a point that has its own.
    pub every_pair: u32,
}

/// Of the distance that a pair has at rest, what it has to keep if that is less than the thickness.
const KEPT_AT_REST: f32 = 0.5;
/// Of the distance at rest, how much nearer than that margin may reach: so that a surface at rest has no contacts with itself.
const MARGIN_AT_REST: f32 = 0.25;
/// Of the thickness: nearer pairs have no side on which they are, so those that touch at rest are left alone.
const TOUCHING: f32 = 1e-4;

impl Kernel for Touch {
    const NAME: &'static str = "touch";
    const WGSL: &'static [&'static str] = &[super::WGSL, proximity::WGSL, include_str!("touch.wgsl")];
    type Uniform = TouchUniform;
    type Inputs = ([u32; 4], Vec4, Vec4, Vec4);
}

/// How a pair lies when it comes near, and the distance that it has to keep \[m\].
fn met(uniform: &TouchUniform, motion: &Motion, rest: &[Vec3; 4]) -> Option<(Nearest, f32)> {
    let mut reach = uniform.thickness + uniform.margin;
    if is_clear(motion.is_edges, &motion.start, &motion.end, reach) {
        return None;
    }
    let mut met = motion.first_within(reach, 0.0)?;
    let at_rest = nearest(motion.is_edges, rest).separation.length();
    let distance = uniform.thickness.min(KEPT_AT_REST * at_rest);
    let near = distance + uniform.margin.min(MARGIN_AT_REST * at_rest);
    if near < reach {
        reach = near;
        met = motion.first_within(reach, met.0)?;
    }
    if let Some(within) = motion.first_within(distance, met.0) {
        met = within;
    } else {
        let end = motion.at(1.0);
        if end.separation.length() <= reach {
            met = (1.0, end);
        }
    }
    (met.1.separation.length() > TOUCHING * uniform.thickness).then_some((met.1, distance))
}

impl Expand for Touch {
    type Item = Contact;

    fn expand(
        i: u32,
        uniform: &TouchUniform,
        (pairs, rest, from, to): HostViews<'_, Self>,
        emit: &mut impl FnMut(Contact),
    ) {
        let pair = pairs[i as usize];
        let particles = [pair[0] & !EDGES, pair[1], pair[2], pair[3]];
        let weight = |slot: usize| from[particles[slot] as usize].w;
        let free = (0..4).filter(|&slot| weight(slot) > 0.0).fold(0, |free, slot| free | 1 << slot);
        if free == 0 {
            return;
        }
        let motion = Motion::new(pair, from, to);
        let Some((nearest, distance)) = met(uniform, &motion, &relative(pair, rest)) else { return };
        let is_inside = nearest.weights.cmpne(Vec4::ZERO).all();
        if motion.is_edges && uniform.every_pair == 0 && !is_inside {
            return;
        }
        let mut contact = Contact {
            particles,
            weights: nearest.weights,
            normal: nearest.separation / nearest.separation.length(),
            distance,
            start: Vec3::ZERO,
            friction: uniform.friction,
            origin: Vec3::ZERO,
            free: if motion.is_edges { free | BETWEEN_EDGES } else { free },
        };
        contact.start = contact.apply(from);
        emit(contact);
    }
}
