//! The energy of each constraint.

use std::marker::PhantomData;

use glam::Vec4;

use super::{CORNERS, corners, join};
use crate::constraint::Constraint;
use crate::{HostViews, Kernel, Map};

/// W \[J\] of constraint `k` of kind `C`; reads (particles, rest data, q).
///
/// A device may round otherwise: |A q − p| differs by 10⁻⁵ of the size of A q and p.
#[derive(Debug)]
pub struct Energy<C, const N: usize, const R: usize>(PhantomData<C>);

impl<C: Constraint<N, R>, const N: usize, const R: usize> Kernel for Energy<C, N, R> {
    const NAME: &'static str = "energy";
    const WGSL: &'static [&'static str] = &join::<C, N, R>(&[CORNERS, include_str!("energy.wgsl")]);
    type Uniform = ();
    type Inputs = ([u32; N], C, Vec4);
}

impl<C: Constraint<N, R>, const N: usize, const R: usize> Map for Energy<C, N, R> {
    type Output = f32;

    #[inline]
    fn map(k: u32, (): &(), (particles, rest, q): HostViews<'_, Self>, own: &mut f32) {
        let k = k as usize;
        *own = rest[k].energy(&corners(k, particles, q));
    }
}
