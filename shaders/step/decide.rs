//! The safeguard's decision.

use bytemuck::{Pod, Zeroable};

use crate::{HostViews, Kernel, Map};

/// What the safeguard knows, of which there is one: compares the objective, the sum of all numbers read, with the lowest it has seen; reads
/// (sums). What is not finite is a rise.
///
/// A device may add up in another order: 10⁻⁶ of the objective, a hundredth of the rise that is tolerated.
#[derive(Debug)]
pub struct Decide;

/// What the safeguard knows between two looks.
#[derive(Debug, Clone, Copy, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Watch {
    /// Lowest objective of this small step \[J\].
    pub lowest: f32,
    /// That of the positions that were kept last \[J\].
    pub kept: f32,
    /// By how many halvings acceleration is eased.
    pub level: u32,
    /// Small steps since the level has changed.
    pub quiet_steps: u32,
    /// The iteration of this small step after which acceleration began anew.
    pub began_at: u32,
    /// How often iterations were taken back, over all steps.
    pub n_backoffs: u32,
    /// Whether any were in this small step: 1 or 0.
    pub has_backed_off: u32,
    /// Whether those before this look were.
    pub is_back: u32,
}

/// Parameters of [`Decide`].
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct DecideUniform {
    /// How many numbers make the objective.
    pub n_sums: u32,
    /// Iterations so far; at 0 a small step begins, and there is nothing to compare with.
    pub k: u32,
    /// Whether a small step ends: 1 or 0.
    pub is_last: u32,
    /// By how much of itself the objective may rise.
    pub tolerated_rise: f32,
    /// Halvings at most.
    pub most: u32,
    /// Small steps without a rise after which there is a halving less.
    pub recovery: u32,
    /// What roundings may add to the objective \[J\].
    pub rounding: f32,
}

impl Kernel for Decide {
    const NAME: &'static str = "decide";
    const WGSL: &'static [&'static str] = &[super::WATCH, include_str!("decide.wgsl")];
    type Uniform = DecideUniform;
    type Inputs = (f32,);
}

impl Map for Decide {
    type Output = Watch;

    #[expect(
        clippy::neg_cmp_op_on_partial_ord,
        reason = "a bound that is no number refuses nobody, as in WGSL"
    )]
    fn map(_: u32, uniform: &DecideUniform, (sums,): HostViews<'_, Self>, watch: &mut Watch) {
        let objective: f32 = sums[..uniform.n_sums as usize].iter().sum();
        watch.is_back = 0;
        if uniform.k == 0 {
            (watch.lowest, watch.kept) = (objective, objective);
            (watch.began_at, watch.has_backed_off) = (0, 0);
            return;
        }
        let bound = watch.lowest + uniform.tolerated_rise * watch.lowest.abs() + uniform.rounding;
        if objective.is_finite() && !(objective > bound) {
            watch.lowest = objective.min(watch.lowest);
            watch.kept = objective;
        } else {
            (watch.is_back, watch.has_backed_off, watch.began_at) = (1, 1, uniform.k);
            watch.n_backoffs = watch.n_backoffs.wrapping_add(1);
            (watch.level, watch.quiet_steps) = ((watch.level + 1).min(uniform.most), 0);
        }
        if uniform.is_last == 1 && watch.has_backed_off == 0 {
            watch.quiet_steps += 1;
            if watch.quiet_steps >= uniform.recovery {
                (watch.level, watch.quiet_steps) = (watch.level.saturating_sub(1), 0);
            }
        }
    }
}
