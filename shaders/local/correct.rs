//! One projection of XPBD (Macklin, Müller, Chentanez 2016, Eq. 18) for each constraint of a color.

use std::marker::PhantomData;

use glam::Vec4;

use super::{CORNERS, join};
use crate::constraint::{Constraint, Multiplier, Xpbd};
use crate::{HostViews, Kernel, Scatter};

/// Moves the particles of constraint `k` of kind `C`, and changes its multiplier \[N s²\] in a vector (see
/// [`Multiplier::within`]); reads (particles, rest data), writes q and the multipliers. What is pinned is not written, so constraints
/// may share it.
///
/// A device may round otherwise: moves and multipliers differ by 10⁻⁵ of their size, and of that of A q.
#[derive(Debug)]
pub struct Correct<C, const N: usize, const R: usize>(PhantomData<C>);

impl<C: Constraint<N, R>, const N: usize, const R: usize> Kernel for Correct<C, N, R> {
    const NAME: &'static str = "correct";
    const WGSL: &'static [&'static str] = &join::<C, N, R>(&[CORNERS, include_str!("correct.wgsl")]);
    type Uniform = Xpbd;
    type Inputs = ([u32; N], C);
}

impl<C: Constraint<N, R>, const N: usize, const R: usize> Scatter<N> for Correct<C, N, R> {
    type State = Vec4;
    type Own = Vec4;

    #[inline]
    fn scatter(
        k: u32,
        xpbd: &Xpbd,
        (particles, rest): HostViews<'_, Self>,
        q: &[Vec4],
        lambda: &mut Vec4,
    ) -> [Option<(u32, Vec4)>; N] {
        let particles = &particles[k as usize];
        let moves = rest[k as usize].correct(particles, xpbd, q, C::Multiplier::within(lambda));
        std::array::from_fn(|slot| {
            let at = q[particles[slot] as usize];
            (at.w > 0.0).then_some((particles[slot], at + moves[slot]))
        })
    }
}
