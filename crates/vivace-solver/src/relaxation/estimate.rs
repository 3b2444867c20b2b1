//! The spectral radius of a relaxation, from iterations of it without acceleration (Wang 2015).

use super::Schedule;
use crate::step::Ease;
use crate::{Relaxation, Stages};

/// Iterations at most.
const ITERATIONS: usize = 128;
/// What moves by less than this part of what it first did is soon but rounding.
const LEAST: f32 = 1e-4;

/// By how much moves shrink from one plain iteration to the next, on average over the last quarter of them; nothing where they do not. Leaves
/// q as it was.
pub(crate) fn spectral_radius(stages: &mut dyn Stages, relaxation: Relaxation) -> Option<f32> {
    // Nothing is estimated yet, so ρ is 0.
    let mut schedule = Schedule::new(relaxation, Ease::default(), false);
    let (mut moves, mut n) = ([0.0_f32; ITERATIONS], 0);
    let mut is_moving = true;
    stages.save();
    while is_moving && n < ITERATIONS {
        stages.remember();
        schedule.iterate(stages);
        moves[n] = stages.moved();
        // Nor is it if it is not a number.
        is_moving = moves[n] > LEAST * moves[0];
        n += 1;
    }
    stages.restore();
    // From a sweep to another that comes as long after its local step.
    let (last, period) = (n - 1, stages.n_sweeps() as usize);
    let quarter = last.div_ceil(4).next_multiple_of(period).min(last);
    let rho = (moves[last] / moves[last - quarter]).powf(1.0 / quarter.max(1) as f32);
    // 0/0 where nothing moves.
    (rho < 1.0).then_some(rho)
}
