//! Contacts that say nothing new are left out.
//!
//! A point above a surface is near to many of its triangles, but only where its distance to the surface has a minimum is there
//! anything to hold: elsewhere the nearest place of a triangle is on a side of it, or at a corner, which is a nearer triangle's too. Of
//! two edges whose nearest points are not inside of both, an end is such a point. And edges that cross between two layers are held
//! apart by their ends, where all of these are held already.

use glam::Vec3;

use crate::contact::Contact;

/// Cosine between directions, above which contacts hold in the same one.
const SAME_DIRECTION: f32 = 0.9;

/// Scratch, kept so that a frame allocates nothing.
#[derive(Default)]
pub(crate) struct Thinner {
    /// Point, distance \[m\], number of its contact.
    near: Vec<(u32, f32, usize)>,
    is_kept: Vec<bool>,
    /// By particle: the direction in which its nearest contact holds it; 0 without one.
    held: Vec<Vec3>,
}

impl Thinner {
    /// Leaves out of the contacts of points and triangles what others of them imply where particles go `to` \[m\].
    pub(crate) fn thin(&mut self, contacts: &mut Vec<Contact>, to: &[Vec3]) {
        self.near.clear();
        let apart = |contact: &Contact| contact.gap(to) + contact.distance;
        self.near.extend((0..).zip(&*contacts).map(|(k, contact)| (contact.particles[0], apart(contact), k)));
        self.near.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
        self.is_kept.clear();
        self.is_kept.resize(contacts.len(), true);
        self.held.clear();
        self.held.resize(to.len(), Vec3::ZERO);
        for of_point in self.near.chunk_by(|a, b| a.0 == b.0) {
            self.held[of_point[0].0 as usize] = contacts[of_point[0].2].normal;
            for (k, &(_, _, contact)) in of_point.iter().enumerate() {
                let feature = feature(&contacts[contact]);
                let is_of = |&(_, _, nearer): &(u32, f32, usize)| {
                    let triangle = &contacts[nearer].particles[1..];
                    feature.iter().flatten().all(|p| triangle.contains(p))
                };
                self.is_kept[contact] = !of_point[..k].iter().any(is_of);
            }
        }
        let mut is_kept = self.is_kept.iter();
        contacts.retain(|_| is_kept.next().is_none_or(|&is_kept| is_kept));
    }

    /// Whether points of both edges hold them apart already.
    pub(crate) fn holds(&self, edges: [u32; 4]) -> bool {
        let [a, b, c, d] = edges.map(|v| self.held[v as usize]);
        let is_against = |one: Vec3, other: Vec3| one.dot(other) < -SAME_DIRECTION;
        is_against(a, c) && is_against(a, d) && is_against(b, c) && is_against(b, d)
    }
}

/// Whether the nearest points of two edges are inside of both.
pub(crate) fn is_inside(edges: &Contact) -> bool {
    edges.weights.iter().all(|&weight| weight != 0.0)
}

/// The corners of the triangle between which the point's nearest place is.
fn feature(contact: &Contact) -> [Option<u32>; 3] {
    [1, 2, 3].map(|k| (contact.weights[k] != 0.0).then_some(contact.particles[k]))
}
