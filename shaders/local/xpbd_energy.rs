//! The energy of each constraint as Position Based Dynamics sees it.

use std::marker::PhantomData;

use glam::Vec4;

use super::{CORNERS, corners, join};
use crate::constraint::Constraint;
use crate::{HostViews, Kernel, Map};

/// w C² / 2 \[J\] of constraint `k` of kind `C`; reads (particles, rest data, q).
///
/// A device may round otherwise: C differs by 10⁻⁵ of the size of A q.
#[derive(Debug)]
pub struct XpbdEnergy<C, const N: usize, const R: usize>(PhantomData<C>);

impl<C: Constraint<N, R>, const N: usize, const R: usize> Kernel for XpbdEnergy<C, N, R> {
    const NAME: &'static str = "xpbd_energy";
    const WGSL: &'static [&'static str] = &join::<C, N, R>(&[CORNERS, include_str!("xpbd_energy.wgsl")]);
    type Uniform = ();
    type Inputs = ([u32; N], C, Vec4);
}

impl<C: Constraint<N, R>, const N: usize, const R: usize> Map for XpbdEnergy<C, N, R> {
    type Output = f32;

    #[inline]
    fn map(k: u32, (): &(), (particles, rest, q): HostViews<'_, Self>, own: &mut f32) {
        let k = k as usize;
        let (c, _) = rest[k].deviation(&corners(k, particles, q));
        *own = 0.5 * rest[k].weight() * c * c;
    }
}
