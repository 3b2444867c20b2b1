//! Sums of many numbers, in a fixed order.

use bytemuck::{Pod, Zeroable};

use crate::{HostViews, Kernel, Map};

/// Numbers in one sum: its error is below 256 roundings of the sum of their sizes, 10⁻⁵.
pub const BLOCK: u32 = 256;

/// Element `first + b` is the sum of the numbers b, b + n, b + 2 n, …, where n is the number of sums; reads (numbers). What is
/// left, `BLOCK` times less, the host adds up in `f64`.
#[derive(Debug)]
pub struct Sum;

/// Parameters of [`Sum`].
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct SumUniform {
    /// Where the sums begin.
    pub first: u32,
    /// How many sums.
    pub n_sums: u32,
    /// How many numbers.
    pub n_numbers: u32,
}

impl Kernel for Sum {
    const NAME: &'static str = "sum";
    const WGSL: &'static [&'static str] = &[include_str!("sum.wgsl")];
    type Uniform = SumUniform;
    type Inputs = (f32,);
}

impl Map for Sum {
    type Output = f32;

    #[inline]
    fn map(i: u32, uniform: &SumUniform, (numbers,): HostViews<'_, Self>, own: &mut f32) {
        let mut sum = 0.0;
        let mut k = i - uniform.first;
        while k < uniform.n_numbers {
            sum += numbers[k as usize];
            k += uniform.n_sums;
        }
        *own = sum;
    }
}
