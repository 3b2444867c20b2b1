//! The energy of a row.

use glam::Vec4;

use super::{Row, SpringTap, Tap, VEC3, WGSL};
use crate::{HostViews, Kernel, Map};

/// Energy of the springs and flat hinges of row `i`, half of each entry towards a free particle, and of its inertia \[J\]; reads (rows,
/// taps, springs, anchors, q).
#[derive(Debug)]
pub struct RowEnergy;

impl Kernel for RowEnergy {
    const NAME: &'static str = "row_energy";
    const WGSL: &'static [&'static str] = &[VEC3, WGSL, include_str!("row_energy.wgsl")];
    type Uniform = ();
    type Inputs = (Row, Tap, SpringTap, Vec4, Vec4);
}

impl Map for RowEnergy {
    type Output = f32;

    #[inline]
    fn map(i: u32, (): &(), (rows, taps, springs, anchors, q): HostViews<'_, Self>, own: &mut f32) {
        let (row, at, anchor) = (&rows[i as usize], q[i as usize].truncate(), anchors[i as usize]);
        let mut sum = (at - anchor.truncate()).length_squared() * anchor.w;
        for e in row.entries(0, row.n) {
            let (d, spring) = (q[taps[e].column as usize].truncate() - at, springs[e]);
            let squared = d.length_squared();
            let force = spring.stiffness * squared.sqrt() - spring.pull;
            sum += force * force * spring.compliance + spring.linear * squared;
        }
        *own = 0.5 * sum;
    }
}
