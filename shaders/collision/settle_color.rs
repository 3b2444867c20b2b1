//! The coloring of contacts: who keeps what it has drawn.

use super::claim_color::claim;
use super::{COLORS, ClaimUniform, Contact, NO_COLOR, entry};
use crate::{HostViews, Kernel, Select, pcg};

/// Selects contact `i`, and writes its color, if its claim is the best at all its free particles; reads (contacts, colors drawn,
/// entries).
#[derive(Debug)]
pub struct SettleColor;

impl Kernel for SettleColor {
    const NAME: &'static str = "settle_color";
    const WGSL: &'static [&'static str] =
        &[super::WGSL, pcg::WGSL, COLORS, include_str!("settle_color.wgsl")];
    type Uniform = ClaimUniform;
    type Inputs = (Contact, u32, u32);
}

impl Select for SettleColor {
    type Output = u32;

    fn select(
        i: u32,
        uniform: &ClaimUniform,
        (contacts, drawn, entries): HostViews<'_, Self>,
        own: &mut u32,
    ) -> bool {
        let (contact, color) = (&contacts[i as usize], drawn[i as usize]);
        let Some(claim) = claim(i, uniform.key) else { return false };
        let is_best = |slot: usize| {
            !contact.is_free(slot)
                || entries[entry(contact.particles[slot], color, uniform.mask) as usize] == claim
        };
        let wins = color != NO_COLOR && (0..4).all(is_best);
        if wins {
            *own = color;
        }
        wins
    }
}
