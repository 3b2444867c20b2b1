//! The local step of springs.

use glam::{Vec3, Vec4};

use super::{Row, Tap, VEC3, WGSL, guarded};
use crate::{HostViews, Kernel, Map};

/// `Σ w Aᵀ p` \[N\] of the springs of particle `i`, to which passes add theirs; reads (rows, taps, spring pulls \[N\], q).
#[derive(Debug)]
pub struct SpringPull;

impl Kernel for SpringPull {
    const NAME: &'static str = "spring_pull";
    const WGSL: &'static [&'static str] = &[VEC3, WGSL, include_str!("spring_pull.wgsl")];
    type Uniform = ();
    type Inputs = (Row, Tap, f32, Vec4);
}

impl Map for SpringPull {
    type Output = Vec4;

    #[inline]
    fn map(i: u32, (): &(), (rows, taps, spring_pulls, q): HostViews<'_, Self>, own: &mut Vec4) {
        let (row, at) = (&rows[i as usize], q[i as usize].truncate());
        let mut sum = Vec3::ZERO;
        for e in row.entries(0, row.n_springs) {
            let d = q[taps[e].column as usize].truncate() - at;
            sum -= d * (spring_pulls[e] / guarded(d.length_squared()).sqrt());
        }
        *own = sum.extend(0.0);
    }
}
