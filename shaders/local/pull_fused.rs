//! What a particle's constraints ask of it, projected from the latest positions.

use std::marker::PhantomData;

use glam::Vec4;

use super::{CORNERS, corners, join, row};
use crate::constraint::Constraint;
use crate::{HostViews, Kernel, Map};

/// Adds `w Aᵀ p(A q)` \[N\] of the constraints of kind `C` of particle `i`; reads (offsets, slots, particles, rest data, q).
///
/// A device may round otherwise: where the nearest point is the only one, the sum differs by 10⁻⁵ of its largest term.
#[derive(Debug)]
pub struct PullFused<C, const N: usize, const R: usize>(PhantomData<C>);

impl<C: Constraint<N, R>, const N: usize, const R: usize> Kernel for PullFused<C, N, R> {
    const NAME: &'static str = "pull_fused";
    const WGSL: &'static [&'static str] = &join::<C, N, R>(&[CORNERS, include_str!("pull_fused.wgsl")]);
    type Uniform = ();
    type Inputs = (u32, u32, [u32; N], C, Vec4);
}

impl<C: Constraint<N, R>, const N: usize, const R: usize> Map for PullFused<C, N, R> {
    type Output = Vec4;

    #[inline]
    fn map(i: u32, (): &(), (offsets, slots, particles, rest, q): HostViews<'_, Self>, own: &mut Vec4) {
        let mut sum = own.truncate();
        for (k, slot) in row::<N>(i, offsets, slots) {
            let p = rest[k].project(rest[k].apply(&corners(k, particles, q)));
            sum += rest[k].pull(slot, &p);
        }
        *own = sum.extend(0.0);
    }
}
