//! What the projections of a particle's constraints ask of it.

use std::marker::PhantomData;

use glam::Vec4;

use super::{join, row};
use crate::constraint::Constraint;
use crate::{HostViews, Kernel, Map};

/// Adds `w Aᵀ p` \[N\] of the constraints of kind `C` of particle `i`, p as [`super::Project`] left it; reads (offsets, slots, rest
/// data, projected). Slots are numbered `constraint · N + slot`, grouped by particle.
///
/// A device may round otherwise: the sum differs by 10⁻⁵ of its largest term.
#[derive(Debug)]
pub struct Pull<C, const N: usize, const R: usize>(PhantomData<C>);

impl<C: Constraint<N, R>, const N: usize, const R: usize> Kernel for Pull<C, N, R> {
    const NAME: &'static str = "pull";
    const WGSL: &'static [&'static str] = &join::<C, N, R>(&[include_str!("pull.wgsl")]);
    type Uniform = ();
    type Inputs = (u32, u32, C, [Vec4; R]);
}

impl<C: Constraint<N, R>, const N: usize, const R: usize> Map for Pull<C, N, R> {
    type Output = Vec4;

    #[inline]
    fn map(i: u32, (): &(), (offsets, slots, rest, projected): HostViews<'_, Self>, own: &mut Vec4) {
        let mut sum = own.truncate();
        for (k, slot) in row::<N>(i, offsets, slots) {
            sum += rest[k].pull(slot, &projected[k].map(Vec4::truncate));
        }
        *own = sum.extend(0.0);
    }
}
