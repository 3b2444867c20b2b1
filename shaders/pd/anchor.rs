//! Where inertia and attachments pull a particle together.

use glam::Vec4;

use crate::{HostViews, Kernel, Map};

/// The anchor of particle `i` \[m\]: the prediction times its share of the anchor's weight, and the targets times theirs; reads
/// (predicted \[m\], holds: Σ share · target \[m\], share of the prediction). Keeps w, the anchor's weight \[N/m\].
#[derive(Debug)]
pub struct Anchor;

impl Kernel for Anchor {
    const NAME: &'static str = "anchor";
    const WGSL: &'static [&'static str] = &[include_str!("anchor.wgsl")];
    type Uniform = ();
    type Inputs = (Vec4, Vec4);
}

impl Map for Anchor {
    type Output = Vec4;

    #[inline]
    fn map(i: u32, (): &(), (predicted, holds): HostViews<'_, Self>, own: &mut Vec4) {
        let (predicted, hold) = (predicted[i as usize], holds[i as usize]);
        *own = (predicted.truncate() * hold.w + hold.truncate()).extend(own.w);
    }
}
