//! What inertia adds to the objective of a time step.

use glam::Vec4;

use super::StepUniform;
use crate::{HostViews, Kernel, Map};

/// |q − s|² / (2 w h²) \[J\] of particle `i`, w its inverse mass, 0 where pinned; reads (predicted positions s, q).
///
/// A device may round otherwise: by 10⁻⁶ of itself.
#[derive(Debug)]
pub struct Inertia;

impl Kernel for Inertia {
    const NAME: &'static str = "inertia";
    const WGSL: &'static [&'static str] = &[include_str!("inertia.wgsl")];
    type Uniform = StepUniform;
    type Inputs = (Vec4, Vec4);
}

impl Map for Inertia {
    type Output = f32;

    #[inline]
    fn map(i: u32, step: &StepUniform, (predicted, q): HostViews<'_, Self>, own: &mut f32) {
        let (q, predicted) = (q[i as usize], predicted[i as usize]);
        let squared = (q - predicted).truncate().length_squared();
        *own = if q.w > 0.0 { squared / (2.0 * q.w * step.squared_h) } else { 0.0 };
    }
}
