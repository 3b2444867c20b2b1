//! Jacobi's iteration, second part: the multipliers that go with [`super::Moves`].

use std::marker::PhantomData;

use glam::Vec4;

use super::{CORNERS, averaged, join};
use crate::constraint::{Constraint, Multiplier, Xpbd};
use crate::{HostViews, Kernel, Map};

/// The multiplier \[N s²\] of constraint `k` of kind `C` after its moves, which are not done yet; reads (particles, rest data, q,
/// constraints at the busiest particle).
///
/// A device may round otherwise, as [`super::Correct`].
#[derive(Debug)]
pub struct Multiply<C, const N: usize, const R: usize>(PhantomData<C>);

impl<C: Constraint<N, R>, const N: usize, const R: usize> Kernel for Multiply<C, N, R> {
    const NAME: &'static str = "multiply";
    const WGSL: &'static [&'static str] = &join::<C, N, R>(&[CORNERS, include_str!("multiply.wgsl")]);
    type Uniform = Xpbd;
    type Inputs = ([u32; N], C, Vec4, f32);
}

impl<C: Constraint<N, R>, const N: usize, const R: usize> Map for Multiply<C, N, R> {
    type Output = Vec4;

    #[inline]
    fn map(k: u32, xpbd: &Xpbd, (particles, rest, q, busiest): HostViews<'_, Self>, own: &mut Vec4) {
        let k = k as usize;
        rest[k].correct(&particles[k], &averaged(xpbd, busiest[k]), q, C::Multiplier::within(own));
    }
}
