//! Contacts that say nothing new are left out, as `vivace-collision` has it.
//!
//! A point above a surface is near to many of its triangles, but only where its distance to the surface has a minimum is there anything to
//! hold: elsewhere the nearest place of a triangle is on a side of it, or at a corner, which is a nearer triangle's too. Edges that cross
//! between two layers are held apart by their ends, where all of these are held already.
//!
//! Contacts of one point stand side by side, as [`Touch`](super::Touch) has found them.

use glam::{Vec3, Vec4};

use super::{BETWEEN_EDGES, Contact};
use crate::{HostViews, Kernel, Scatter, Select};

/// Cosine between directions, above which contacts hold in the same one.
const SAME_DIRECTION: f32 = 0.9;

/// Whether contact `i` says something new: 1 in its own element, else 0. Of a point's nearest contact, writes the direction in which it holds
/// the point. Reads (contacts, positions where particles go \[m\], how many contacts there are).
///
/// Contacts that are as near as one another, but for roundings, may be kept on one device and not on another.
#[derive(Debug)]
pub struct Thin;

/// Selects contact `i` if it was kept, and if its edges are not held by their ends; reads (directions in which points are held).
#[derive(Debug)]
pub struct KeepThin;

impl Kernel for Thin {
    const NAME: &'static str = "thin";
    const WGSL: &'static [&'static str] = &[super::WGSL, include_str!("thin.wgsl")];
    type Uniform = ();
    type Inputs = (Contact, Vec4, u32);
}

/// How far apart the two sides are where particles go, along the normal \[m\].
fn apart(contact: &Contact, to: &[Vec4]) -> f32 {
    contact.normal.dot(contact.apply(to))
}

/// Whether the place nearest to the point is on the triangle of another contact.
fn is_on(contact: &Contact, other: &Contact) -> bool {
    (1..4).all(|k| contact.weights[k] == 0.0 || other.particles[1..].contains(&contact.particles[k]))
}

impl Scatter<1> for Thin {
    type State = Vec4;
    type Own = u32;

    fn scatter(
        i: u32,
        (): &(),
        (contacts, to, counts): HostViews<'_, Self>,
        _: &[Vec4],
        own: &mut u32,
    ) -> [Option<(u32, Vec4)>; 1] {
        let (i, contact) = (i as usize, &contacts[i as usize]);
        *own = 1;
        if contact.free & BETWEEN_EDGES != 0 {
            return [None];
        }
        let point = contact.particles[0];
        let (here, n) = (apart(contact, to), (counts[0] as usize).min(contacts.len()));
        let is_of = |other: &Contact| other.particles[0] == point && other.free & BETWEEN_EDGES == 0;
        let mut is_nearest = true;
        let mut look = |k: usize| {
            let (other, there) = (&contacts[k], apart(&contacts[k], to));
            if there < here || (there == here && k < i) {
                is_nearest = false;
                if is_on(contact, other) {
                    *own = 0;
                }
            }
        };
        (0..i).rev().take_while(|&k| is_of(&contacts[k])).for_each(&mut look);
        (i + 1..n).take_while(|&k| is_of(&contacts[k])).for_each(&mut look);
        [is_nearest.then(|| (point, contact.normal.extend(0.0)))]
    }
}

impl Kernel for KeepThin {
    const NAME: &'static str = "keep_thin";
    const WGSL: &'static [&'static str] = &[super::WGSL, include_str!("keep_thin.wgsl")];
    type Uniform = ();
    type Inputs = (Contact, Vec4);
}

impl Select for KeepThin {
    type Output = u32;

    fn select(i: u32, (): &(), (contacts, held): HostViews<'_, Self>, own: &mut u32) -> bool {
        let contact = &contacts[i as usize];
        if *own == 0 || contact.free & BETWEEN_EDGES == 0 {
            return *own != 0;
        }
        let [a, b, c, d]: [Vec3; 4] = contact.particles.map(|v| held[v as usize].truncate());
        let is_against = |one: Vec3, other: Vec3| one.dot(other) < -SAME_DIRECTION;
        !(is_against(a, c) && is_against(a, d) && is_against(b, c) && is_against(b, d))
    }
}
