//! Dot products of x, y and z at once, in a fixed order.

use glam::Vec4;

use crate::step::SumUniform;
use crate::{HostViews, Kernel, Map};

/// Sums as [`crate::step::Sum`] has them, of the products a b and a c; reads (a, b, c).
#[derive(Debug)]
pub struct Dot;

impl Kernel for Dot {
    const NAME: &'static str = "dot";
    const WGSL: &'static [&'static str] = &[super::PAIR, include_str!("dot.wgsl")];
    type Uniform = SumUniform;
    type Inputs = (Vec4, Vec4, Vec4);
}

impl Map for Dot {
    type Output = [Vec4; 2];

    fn map(i: u32, uniform: &SumUniform, (a, b, c): HostViews<'_, Self>, own: &mut [Vec4; 2]) {
        *own = [Vec4::ZERO; 2];
        for k in (i - uniform.first..uniform.n_numbers).step_by(uniform.n_sums as usize) {
            let k = k as usize;
            *own = [own[0] + a[k] * b[k], own[1] + a[k] * c[k]];
        }
    }
}
