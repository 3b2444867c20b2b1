//! The diagonal of Y as a preconditioner.

use glam::Vec4;

use crate::pd::{self, Row};
use crate::{HostViews, Kernel, Map};

/// `z_i = r_i / Y_ii`; reads (rows, r).
#[derive(Debug)]
pub struct Divide;

impl Kernel for Divide {
    const NAME: &'static str = "divide";
    const WGSL: &'static [&'static str] = &[pd::WGSL, include_str!("divide.wgsl")];
    type Uniform = ();
    type Inputs = (Row, Vec4);
}

impl Map for Divide {
    type Output = Vec4;

    #[inline]
    fn map(i: u32, (): &(), (rows, r): HostViews<'_, Self>, z: &mut Vec4) {
        *z = (r[i as usize].truncate() * rows[i as usize].inverse_diagonal).extend(0.0);
    }
}
