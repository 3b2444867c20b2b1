//! The next direction.

use glam::Vec4;

use super::Scalars;
use crate::{HostViews, Kernel, Map};

/// `d = z + β d`; reads (scalars, z).
#[derive(Debug)]
pub struct Turn;

impl Kernel for Turn {
    const NAME: &'static str = "turn";
    const WGSL: &'static [&'static str] = &[super::SCALARS, include_str!("turn.wgsl")];
    type Uniform = ();
    type Inputs = (Scalars, Vec4);
}

impl Map for Turn {
    type Output = Vec4;

    #[inline]
    fn map(i: u32, (): &(), (scalars, z): HostViews<'_, Self>, own: &mut Vec4) {
        *own = (z[i as usize].truncate() + own.truncate() * scalars[0].beta.truncate()).extend(0.0);
    }
}
