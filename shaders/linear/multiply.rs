//! Y times a vector.

use glam::Vec4;

use crate::pd::{self, Row, Tap};
use crate::{HostViews, Kernel, Map};

/// `(Y d)_i` \[N\]; reads (rows, taps, anchors, d), where d is 0 at what is pinned.
///
/// A device may fuse products with sums, as all kernels over rows.
#[derive(Debug)]
pub struct Multiply;

impl Kernel for Multiply {
    const NAME: &'static str = "multiply_rows";
    const WGSL: &'static [&'static str] = &[pd::WGSL, include_str!("multiply.wgsl")];
    type Uniform = ();
    type Inputs = (Row, Tap, Vec4, Vec4);
}

impl Map for Multiply {
    type Output = Vec4;

    #[inline]
    fn map(i: u32, (): &(), (rows, taps, anchors, d): HostViews<'_, Self>, own: &mut Vec4) {
        let (row, at) = (&rows[i as usize], d[i as usize].truncate());
        let mut sum = at * anchors[i as usize].w.abs();
        for e in row.entries(0, row.n) {
            sum += (at - d[taps[e].column as usize].truncate()) * taps[e].weight;
        }
        *own = sum.extend(0.0);
    }
}
