//! The weights of the iterations until the next look.

use std::marker::PhantomData;

use bytemuck::{Pod, Zeroable};

use super::{ExtrapolateUniform, Watch};
use crate::constraint::Xpbd;
use crate::pd::Omega;
use crate::{Element, HostViews, Kernel, Map};

/// Parameters of a relaxation that the safeguard picks from a table.
pub trait Weight: Element {
    /// What it is in WGSL.
    const WGSL: &'static str;
}

macro_rules! weights {
    ($($weight:ty: $wgsl:literal),*) => { $(impl Weight for $weight { const WGSL: &'static str = $wgsl; })* };
}
weights!(Omega: "alias Weight = f32;", ExtrapolateUniform: "alias Weight = f32;", Xpbd: "alias Weight = vec2<f32>;");

/// Element `i` of the parameters of the iterations from `k` on, `stride` elements each: those of its iteration, counted from where
/// acceleration began anew, at the present level; reads (watch, table: a row of `n` iterations for each level).
#[derive(Debug)]
pub struct PickWeight<U>(PhantomData<U>);

/// Parameters of [`PickWeight`].
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct PickWeightUniform {
    /// Iterations so far.
    pub k: u32,
    /// Elements for each iteration.
    pub stride: u32,
    /// Iterations in a row of the table.
    pub n: u32,
}

impl<U: Weight> Kernel for PickWeight<U> {
    const NAME: &'static str = "pick_weight";
    const WGSL: &'static [&'static str] = &[super::WATCH, U::WGSL, include_str!("pick_weight.wgsl")];
    type Uniform = PickWeightUniform;
    type Inputs = (Watch, U);
}

impl<U: Weight> Map for PickWeight<U> {
    type Output = U;

    fn map(i: u32, uniform: &PickWeightUniform, (watch, table): HostViews<'_, Self>, own: &mut U) {
        let k = (uniform.k + i / uniform.stride - watch[0].began_at).min(uniform.n - 1);
        *own = table[(watch[0].level * uniform.n + k) as usize];
    }
}
