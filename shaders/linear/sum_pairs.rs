//! Sums of many pairs of vectors, in a fixed order.

use glam::Vec4;

use crate::step::SumUniform;
use crate::{HostViews, Kernel, Map};

/// Sums as [`crate::step::Sum`] has them, of pairs of vectors; reads (pairs).
#[derive(Debug)]
pub struct SumPairs;

impl Kernel for SumPairs {
    const NAME: &'static str = "sum_pairs";
    const WGSL: &'static [&'static str] = &[super::PAIR, include_str!("sum_pairs.wgsl")];
    type Uniform = SumUniform;
    type Inputs = ([Vec4; 2],);
}

impl Map for SumPairs {
    type Output = [Vec4; 2];

    fn map(i: u32, uniform: &SumUniform, (pairs,): HostViews<'_, Self>, own: &mut [Vec4; 2]) {
        let numbers = (i - uniform.first..uniform.n_numbers).step_by(uniform.n_sums as usize);
        *own = total(numbers.map(|k| &pairs[k as usize]));
    }
}

/// The sum of pairs.
pub(super) fn total<'a>(pairs: impl Iterator<Item = &'a [Vec4; 2]>) -> [Vec4; 2] {
    pairs.fold([Vec4::ZERO; 2], |sum, pair| [sum[0] + pair[0], sum[1] + pair[1]])
}
