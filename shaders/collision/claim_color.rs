//! The coloring of contacts: particles learn who wants a color, and who has it.

use bytemuck::{Pod, Zeroable};

use super::{COLORS, Contact, NO_COLOR, entry};
use crate::{HostViews, Kernel, Lower, pcg};

/// Lowers the entries of what contact `i` has drawn to its hash, or to 0 where it is settled; reads (contacts, colors drawn).
#[derive(Debug)]
pub struct ClaimColor;

/// Parameters of [`ClaimColor`].
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct ClaimColorUniform {
    /// The round's, see [`pcg::key`].
    pub key: u32,
    /// Entries less one: a power of two less one.
    pub mask: u32,
    /// Whether the contact has what it has drawn.
    pub is_settled: u32,
}

/// What contact `i` claims with: not 0, which is settled, and not what nobody has claimed; `None` where it has to wait.
pub(super) fn claim(i: u32, key: u32) -> Option<u32> {
    Some(pcg::hash(i, key)).filter(|&hash| hash != 0 && hash != u32::MAX)
}

impl Kernel for ClaimColor {
    const NAME: &'static str = "claim_color";
    const WGSL: &'static [&'static str] = &[super::WGSL, pcg::WGSL, COLORS, include_str!("claim_color.wgsl")];
    type Uniform = ClaimColorUniform;
    type Inputs = (Contact, u32);
}

impl Lower<4> for ClaimColor {
    fn lower(
        i: u32,
        uniform: &ClaimColorUniform,
        (contacts, drawn): HostViews<'_, Self>,
    ) -> [Option<(u32, u32)>; 4] {
        let (contact, color) = (&contacts[i as usize], drawn[i as usize]);
        let value = if uniform.is_settled != 0 { Some(0) } else { claim(i, uniform.key) };
        std::array::from_fn(|slot| {
            let particle = contact.particles[slot];
            let value = value.filter(|_| color != NO_COLOR && contact.is_free(slot));
            value.map(|value| (entry(particle, color, uniform.mask), value))
        })
    }
}
