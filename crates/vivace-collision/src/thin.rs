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

#[cfg(test)]
mod tests {
    use super::*;

    /// A point and a triangle of these corners, whose nearest place has these weights.
    fn contact(point: u32, [a, b, c]: [u32; 3], [wa, wb, wc]: [f32; 3], normal: Vec3) -> Contact {
        let (particles, weights) = ([point, a, b, c], [1.0, -wa, -wb, -wc]);
        let [origin, velocity] = [Vec3::ZERO; 2];
        Contact { particles, weights, normal, origin, velocity, distance: 0.01, friction: 0.0 }
    }

    /// Between floor and wall both hold the point. The floor's next triangle is nearest to it on the side that both have.
    #[test]
    fn what_a_nearer_triangle_implies_goes() {
        let to = [
            [0.0, 0.0, 0.0],
            [-1.0, -0.01, -1.0],
            [1.0, -0.01, -1.0],
            [0.0, -0.01, 1.0],
            [-0.02, -1.0, -1.0],
            [-0.02, 1.0, -1.0],
            [-0.02, 0.0, 1.0],
            [0.0, -0.01, -2.0],
        ]
        .map(Vec3::from_array);
        let floor = contact(0, [1, 2, 3], [0.25, 0.25, 0.5], Vec3::Y);
        let wall = contact(0, [4, 5, 6], [0.25, 0.25, 0.5], Vec3::X);
        let next = contact(0, [1, 2, 7], [0.5, 0.5, 0.0], Vec3::new(0.0, 0.01, 1.0).normalize());
        let mut contacts = vec![next, wall, floor];
        Thinner::default().thin(&mut contacts, &to);
        assert_eq!(contacts, [wall, floor]);
        // Alone it says something.
        let mut contacts = vec![next, wall];
        Thinner::default().thin(&mut contacts, &to);
        assert_eq!(contacts, [next, wall]);
    }

    /// Edges are held apart by their ends only where each end of one is held against each of the other.
    #[test]
    fn edges_are_held_by_all_their_ends() {
        let held = |normals: [Vec3; 4]| {
            let of = |(p, normal): (u32, Vec3)| contact(p, [4, 4, 4], [0.0, 0.0, 1.0], normal);
            let mut contacts = (0..).zip(normals).map(of).collect();
            let mut thinner = Thinner::default();
            thinner.thin(&mut contacts, &[Vec3::ZERO; 5]);
            thinner.holds([0, 1, 2, 3])
        };
        let up = Vec3::Y;
        assert!(held([up, up, -up, -up]));
        assert!(!held([up, up, up, -up]) && !held([up, -up, -up, -up]));
        // a and d are the only ones that do not face each other.
        let [b, c, d] = [[0.4, 0.917], [-0.2, -0.98], [-0.5, -0.866]].map(|[x, y]| Vec3::new(x, y, 0.0));
        for turned in [[up, b, c, d], [b, up, c, d], [c, d, up, b], [c, d, b, up]] {
            assert!(!held(turned), "{turned:?}");
        }
    }
}
