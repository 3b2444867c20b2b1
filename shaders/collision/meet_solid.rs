//! Contacts of particles with a solid.

use glam::Vec4;

use super::Contact;
use super::solid::{self, SAME_SIDE, Solid};
use crate::{HostViews, Kernel, Select};

/// Whether particle `i` comes near the solid on its way, and its contact if it does; reads (from \[m\] and the inverse mass \[1/kg\], to \[m\], values of
/// a field \[m\], which other solids do not read).
///
/// A device may round otherwise: what is near the limit may be a contact on one and not on another.
#[derive(Debug)]
pub struct MeetSolid;

impl Kernel for MeetSolid {
    const NAME: &'static str = "meet_solid";
    const WGSL: &'static [&'static str] = &[super::WGSL, solid::WGSL, include_str!("meet_solid.wgsl")];
    type Uniform = Solid;
    type Inputs = (Vec4, Vec4, f32);
}

impl Select for MeetSolid {
    type Output = Contact;

    fn select(i: u32, solid: &Solid, (from, to, values): HostViews<'_, Self>, own: &mut Contact) -> bool {
        let (from, to) = (from[i as usize], to[i as usize]);
        if from.w == 0.0 {
            return false;
        }
        let way = solid.way(from.truncate(), to.truncate());
        let Some(near) = solid.first_within(values, way, solid.distance + solid.margin, 0.0) else {
            return false;
        };
        let (mut point, mut seen) = (way[1], solid.seen_from(values, way[1]));
        let part = solid.first_within(values, way, solid.distance, near).unwrap_or(1.0);
        if part < 1.0 {
            let met = way[0] + part * (way[1] - way[0]);
            let there = solid.seen_from(values, met);
            if there.normal.dot(seen.normal) < SAME_SIDE {
                (point, seen) = (met, there);
            }
        }
        let foot = point - seen.distance * seen.normal;
        let origin = solid.ended(foot);
        let moved = origin - solid.begun(foot);
        *own = Contact {
            particles: [i; 4],
            weights: Vec4::X,
            normal: solid.turned(seen.normal),
            distance: solid.distance,
            start: from.truncate() + moved,
            friction: solid.friction,
            origin,
            free: 1,
        };
        true
    }
}
