//! Jacobi's iteration, first part: what every constraint would do from the same positions.

use std::marker::PhantomData;

use glam::Vec4;

use super::{CORNERS, averaged, join};
use crate::constraint::{Constraint, Multiplier, Xpbd};
use crate::{HostViews, Kernel, Map};

/// By how much constraint `k` of kind `C` would move its particles \[m\]; reads (particles, rest data, q, constraints at the busiest
/// particle, multipliers).
///
/// A device may round otherwise, as [`super::Correct`].
#[derive(Debug)]
pub struct Moves<C, const N: usize, const R: usize>(PhantomData<C>);

impl<C: Constraint<N, R>, const N: usize, const R: usize> Kernel for Moves<C, N, R> {
    const NAME: &'static str = "moves";
    const WGSL: &'static [&'static str] = &join::<C, N, R>(&[CORNERS, include_str!("moves.wgsl")]);
    type Uniform = Xpbd;
    type Inputs = ([u32; N], C, Vec4, f32, Vec4);
}

impl<C: Constraint<N, R>, const N: usize, const R: usize> Map for Moves<C, N, R> {
    type Output = [Vec4; N];

    #[inline]
    fn map(
        k: u32,
        xpbd: &Xpbd,
        (particles, rest, q, busiest, lambdas): HostViews<'_, Self>,
        own: &mut [Vec4; N],
    ) {
        let k = k as usize;
        let mut lambda = lambdas[k];
        *own = rest[k].correct(
            &particles[k],
            &averaged(xpbd, busiest[k]),
            q,
            C::Multiplier::within(&mut lambda),
        );
    }
}
