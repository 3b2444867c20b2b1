//! Algorithm 1.

use std::time::Instant;

use serde::{Deserialize, Serialize};

use crate::relaxation::{Schedule, is_accelerated, spectral_radius};
use crate::safeguard::{Looks, Safeguard};
use crate::{Budget, Relaxation, Solver, Stages, StepReport, Stop};

/// What is remembered of acceleration from step to step: by how much the safeguard has eased it, how long all has been well since, and
/// the spectral radius that was estimated for it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ease {
    level: u32,
    quiet_steps: u32,
    /// For (small) steps of so many seconds, this ρ.
    #[serde(default)]
    estimate: Option<(f32, f32)>,
}

/// Steps without trouble after which acceleration is raised again by one level.
pub(crate) const RECOVERY: u32 = 30;
/// Beyond this many halvings nothing is left of any acceleration.
pub(crate) const LARGEST: u32 = 24;

impl Ease {
    /// The spectral radius as [`Rho::Estimated`](crate::Rho::Estimated) has found it, if it has.
    #[must_use]
    pub fn rho(&self) -> Option<f32> {
        self.estimate.map(|(_, rho)| rho)
    }

    /// How many times acceleration is halved.
    pub(crate) fn level(&self) -> u32 {
        self.level
    }

    /// Whether `relaxation` asks for ρ, and it is not known for steps of `h` \[s\].
    pub(crate) fn lacks_rho(&self, relaxation: Relaxation, h: f32) -> bool {
        relaxation.estimates() && self.estimate.is_none_or(|(of, _)| of != h)
    }

    /// Estimates ρ for steps of `h` \[s\], one of which has begun.
    pub(crate) fn estimate_rho(&mut self, stages: &mut dyn Stages, relaxation: Relaxation, h: f32) {
        self.estimate = spectral_radius(stages, relaxation).map(|rho| (h, rho));
    }

    /// Within its bounds, wherever it comes from.
    pub(crate) fn clamped(self) -> Self {
        let estimate = self.estimate.filter(|(_, rho)| (0.0..1.0).contains(rho));
        Self { level: self.level.min(LARGEST), estimate, ..self }
    }

    /// The level, and the steps since it has changed.
    pub(crate) fn parts(self) -> [u32; 2] {
        [self.level, self.quiet_steps]
    }

    /// The same with another level, and other steps since.
    pub(crate) fn at(self, [level, quiet_steps]: [u32; 2]) -> Self {
        Self { level, quiet_steps, ..self }.clamped()
    }

    fn more(&mut self) {
        *self = Self { level: self.level + 1, quiet_steps: 0, ..*self }.clamped();
    }

    fn quiet(&mut self) {
        self.quiet_steps = self.quiet_steps.saturating_add(1);
        if self.quiet_steps >= RECOVERY {
            *self = Self { level: self.level.saturating_sub(1), quiet_steps: 0, ..*self };
        }
    }
}

/// Lines 3 to 8 of Algorithm 1: iterations until `budget` is spent, on positions that were predicted before. `rounding` is what roundings may add to the
/// objective \[J\].
pub(crate) fn solve(
    stages: &mut dyn Stages,
    solver: &Solver,
    budget: &Budget,
    rounding: f64,
    start: Instant,
    ease: &mut Ease,
    report: &mut StepReport,
) {
    let most = budget.iterations.unwrap_or(u32::MAX);
    report.stop = Stop::Iterations;
    // Whatever has been eased away: it may come back.
    let is_watched = solver.safeguard && most > 0 && is_accelerated(solver.relaxation);
    if is_watched && budget.is_counted() && stages.watch(solver.relaxation, most, *ease, rounding) {
        solve_unseen(stages, solver, most);
        report.iterations += most;
        return;
    }
    stages.learn(ease, report);
    let mut schedule = Schedule::new(solver.relaxation, *ease, solver.safeguard);
    let at_start = is_watched.then(|| stages.objective());
    if most > 0 {
        stages.meet();
    }
    let mut safeguard = at_start.map(|objective| Safeguard::begin(objective, rounding, stages));
    let solve_start = Instant::now();
    let (mut k, mut backoffs) = (0, 0);
    while k < most {
        if k > 0 && budget.seconds.is_some_and(|seconds| is_spent(start, solve_start, k, seconds)) {
            report.stop = Stop::Time;
            break;
        }
        if budget.tolerance.is_some() {
            stages.remember();
        }
        schedule.iterate(stages);
        k += 1;
        if budget.seconds.is_some() {
            stages.wait();
        }
        report.last_move = budget.tolerance.map(|_| stages.moved());
        let is_small = report.last_move.zip(budget.tolerance).is_some_and(|(moved, most)| moved <= most);
        let has_settled = is_small && schedule.settle();
        if let Some(safeguard) = &mut safeguard
            && (has_settled || safeguard.is_due(k) || k == most)
        {
            if safeguard.check(k, stages) {
                backoffs += 1;
                ease.more();
                report.last_move = None;
                schedule = Schedule::new(solver.relaxation, *ease, solver.safeguard);
                continue;
            }
            schedule.project_anew();
        }
        if has_settled {
            report.stop = Stop::Tolerance;
            break;
        }
    }
    if let Some(safeguard) = &mut safeguard {
        if !safeguard.has_looked(k) && safeguard.check(k, stages) {
            backoffs += 1;
            ease.more();
            report.last_move = None;
        }
        report.objective = Some(safeguard.kept());
        if backoffs == 0 {
            ease.quiet();
        }
    }
    report.iterations += k;
    report.backoffs += backoffs;
}

/// The same where decisions are made where the positions are: nobody waits for them.
fn solve_unseen(stages: &mut dyn Stages, solver: &Solver, most: u32) {
    // Of weights it says what stages replace: level and beginning are not known here.
    let mut schedule = Schedule::new(solver.relaxation, Ease::default(), true);
    let mut looks = Looks::new();
    for k in 1..=most {
        stages.turn(k - 1);
        schedule.iterate(stages);
        if looks.is_due(k) || k == most {
            looks.look(k);
            stages.look(k, k == most);
            schedule.project_anew();
        }
    }
}

/// Whether another iteration, as long as the mean of the `k` so far, would end after `seconds` since `start`.
fn is_spent(start: Instant, solve_start: Instant, k: u32, seconds: f64) -> bool {
    let now = Instant::now();
    let mean = (now - solve_start).as_secs_f64() / f64::from(k);
    (now - start).as_secs_f64() + mean > seconds
}
