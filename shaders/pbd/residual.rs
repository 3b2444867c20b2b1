//! The gradient of the objective of a time step.

use glam::Vec4;

use super::StepUniform;
use crate::{HostViews, Kernel, Map};

/// |(q − s) / (w h²) + ∇W|² \[N²\] of particle `i`, w its inverse mass, 0 where pinned; reads (predicted positions s, q, gradients of
/// the constraints' energy).
///
/// A device may round otherwise: the root by 10⁻⁵ of the larger of the two terms.
#[derive(Debug)]
pub struct Residual;

impl Kernel for Residual {
    const NAME: &'static str = "residual";
    const WGSL: &'static [&'static str] = &[include_str!("residual.wgsl")];
    type Uniform = StepUniform;
    type Inputs = (Vec4, Vec4, Vec4);
}

impl Map for Residual {
    type Output = f32;

    #[inline]
    fn map(i: u32, step: &StepUniform, (predicted, q, gradients): HostViews<'_, Self>, own: &mut f32) {
        let (q, predicted, gradient) = (q[i as usize], predicted[i as usize], gradients[i as usize]);
        let inertia = (q - predicted).truncate() / (q.w * step.squared_h);
        *own = if q.w > 0.0 { (inertia + gradient.truncate()).length_squared() } else { 0.0 };
    }
}
