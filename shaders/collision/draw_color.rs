//! The coloring of contacts: each draws a color that its particles have not given away.
//!
//! Contacts of one color share no particle that moves. As in Algorithm 2 all draw at once, the one with the best hash keeps what it drew,
//! and the others draw again; but no graph is built. Particles keep instead, in a table of entries ([`entry`]) by hash of particle and
//! color, who wants the color: 0 if it is given away. Two that fall on one entry by chance cannot have it both, no more.

use bytemuck::{Pod, Zeroable};

use super::{COLORS, Contact, N_COLORS, NO_COLOR, entry};
use crate::{HostViews, Kernel, Map, pcg};

/// A color for contact `i` that none of its free particles has given away, the first after one drawn by hash; none if there is none.
/// Reads (contacts, entries).
#[derive(Debug)]
pub struct DrawColor;

/// Parameters of [`DrawColor`] and [`SettleColor`](super::SettleColor).
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct ClaimUniform {
    /// The round's, see [`pcg::key`].
    pub key: u32,
    /// Entries less one: a power of two less one.
    pub mask: u32,
}

impl Kernel for DrawColor {
    const NAME: &'static str = "draw_color";
    const WGSL: &'static [&'static str] = &[super::WGSL, pcg::WGSL, COLORS, include_str!("draw_color.wgsl")];
    type Uniform = ClaimUniform;
    type Inputs = (Contact, u32);
}

impl Map for DrawColor {
    type Output = u32;

    fn map(i: u32, uniform: &ClaimUniform, (contacts, entries): HostViews<'_, Self>, own: &mut u32) {
        let contact = &contacts[i as usize];
        let first = pcg::hash(i, uniform.key);
        let is_left = |color: &u32| {
            (0..4).all(|slot| {
                let entry = entry(contact.particles[slot], *color, uniform.mask);
                !contact.is_free(slot) || entries[entry as usize] != 0
            })
        };
        let mut colors = (0..N_COLORS).map(|k| first.wrapping_add(k) % N_COLORS);
        *own = colors.find(is_left).unwrap_or(NO_COLOR);
    }
}
