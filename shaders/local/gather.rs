//! Jacobi's iteration, third part: a particle moves by what its constraints ask.

use std::marker::PhantomData;

use glam::Vec4;

use super::{join, row};
use crate::constraint::Constraint;
use crate::{HostViews, Kernel, Map};

/// Moves particle `i` by what [`super::Moves`] has found for it \[m\]; reads (offsets, slots, moves), writes q. Slots are numbered
/// `constraint · N + slot`, grouped by particle.
///
/// A device may round otherwise: the sum differs by 10⁻⁵ of its largest term.
#[derive(Debug)]
pub struct Gather<C, const N: usize, const R: usize>(PhantomData<C>);

impl<C: Constraint<N, R>, const N: usize, const R: usize> Kernel for Gather<C, N, R> {
    const NAME: &'static str = "gather";
    const WGSL: &'static [&'static str] = &join::<C, N, R>(&[include_str!("gather.wgsl")]);
    type Uniform = ();
    type Inputs = (u32, u32, [Vec4; N]);
}

impl<C: Constraint<N, R>, const N: usize, const R: usize> Map for Gather<C, N, R> {
    type Output = Vec4;

    #[inline]
    fn map(i: u32, (): &(), (offsets, slots, moves): HostViews<'_, Self>, own: &mut Vec4) {
        let mut sum = Vec4::ZERO;
        for (k, slot) in row::<N>(i, offsets, slots) {
            sum += moves[k][slot];
        }
        *own += sum;
    }
}
