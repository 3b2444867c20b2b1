//! The gradient of the energy as Position Based Dynamics sees it.

use std::marker::PhantomData;

use glam::Vec4;

use super::{CORNERS, corners, join, row};
use crate::constraint::Constraint;
use crate::{HostViews, Kernel, Map};

/// Adds w C ∇C \[N\] of the constraints of kind `C` of particle `i`; reads (offsets, slots, particles, rest data, q).
///
/// A device may round otherwise: the sum differs by 10⁻⁵ of its largest term.
#[derive(Debug)]
pub struct XpbdGradient<C, const N: usize, const R: usize>(PhantomData<C>);

impl<C: Constraint<N, R>, const N: usize, const R: usize> Kernel for XpbdGradient<C, N, R> {
    const NAME: &'static str = "xpbd_gradient";
    const WGSL: &'static [&'static str] = &join::<C, N, R>(&[CORNERS, include_str!("xpbd_gradient.wgsl")]);
    type Uniform = ();
    type Inputs = (u32, u32, [u32; N], C, Vec4);
}

impl<C: Constraint<N, R>, const N: usize, const R: usize> Map for XpbdGradient<C, N, R> {
    type Output = Vec4;

    #[inline]
    fn map(i: u32, (): &(), (offsets, slots, particles, rest, q): HostViews<'_, Self>, own: &mut Vec4) {
        let mut sum = own.truncate();
        for (k, slot) in row::<N>(i, offsets, slots) {
            let (c, gradient) = rest[k].deviation(&corners(k, particles, q));
            sum += gradient[slot] * (rest[k].weight() * c);
        }
        *own = sum.extend(0.0);
    }
}
