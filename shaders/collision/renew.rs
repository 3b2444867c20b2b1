//! The contacts of a step, in one of its small steps.

use bytemuck::{Pod, Zeroable};
use glam::Vec4;

use super::Contact;
use crate::{HostViews, Kernel, Map};

/// Makes contact `i` that of the next small step: a solid's point stands elsewhere, and slips count from where the small step begins. Reads
/// (positions there \[m\]).
///
/// A device may round otherwise: places differ by 10⁻⁶ of their size.
#[derive(Debug)]
pub struct Renew;

/// Parameters of [`Renew`].
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct RenewUniform {
    /// By which part of its way in the whole step a solid's point moves on from where it stands \[1\].
    pub on: f32,
    /// Which part of it lies in the small step \[1\].
    pub share: f32,
}

impl Kernel for Renew {
    const NAME: &'static str = "renew";
    const WGSL: &'static [&'static str] = &[super::WGSL, include_str!("renew.wgsl")];
    type Uniform = RenewUniform;
    type Inputs = (Vec4,);
}

impl Map for Renew {
    type Output = Contact;

    fn map(_: u32, uniform: &RenewUniform, (before,): HostViews<'_, Self>, own: &mut Contact) {
        own.origin += own.way * uniform.on;
        own.start = own.apply(before) + own.way * uniform.share;
    }
}
