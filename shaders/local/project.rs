//! The local step: p(A q) of each constraint.

use std::marker::PhantomData;

use glam::Vec4;

use super::{CORNERS, corners, join};
use crate::constraint::Constraint;
use crate::{HostViews, Kernel, Map};

/// Projects constraint `k` of kind `C`; reads (particles, rest data, q), writes the `R` rows of p.
///
/// A device may round otherwise: where the nearest point is the only one, p differs by 10⁻⁵ of its size.
#[derive(Debug)]
pub struct Project<C, const N: usize, const R: usize>(PhantomData<C>);

impl<C: Constraint<N, R>, const N: usize, const R: usize> Kernel for Project<C, N, R> {
    const NAME: &'static str = "project";
    const WGSL: &'static [&'static str] = &join::<C, N, R>(&[CORNERS, include_str!("project.wgsl")]);
    type Uniform = ();
    type Inputs = ([u32; N], C, Vec4);
}

impl<C: Constraint<N, R>, const N: usize, const R: usize> Map for Project<C, N, R> {
    type Output = [Vec4; R];

    #[inline]
    fn map(k: u32, (): &(), (particles, rest, q): HostViews<'_, Self>, own: &mut [Vec4; R]) {
        let k = k as usize;
        *own = rest[k].project(rest[k].apply(&corners(k, particles, q))).map(|p| p.extend(0.0));
    }
}
