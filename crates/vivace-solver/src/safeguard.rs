//! A watch over accelerated relaxations.

use crate::Stages;

/// Compares the objective at 8, 16, 32, 48, … iterations and at the end with what it was; takes back what raised it, and eases the
/// acceleration. Plain relaxations never raise it in Projective Dynamics, so easing ends.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Safeguard {
    lowest: f64,
    next_check: u32,
}

/// Iterations before the first check.
const FIRST: u32 = 8;
/// Most iterations between two checks.
const LONGEST: u32 = 16;

impl Safeguard {
    /// At the start of a time step, before its first iteration.
    pub(crate) fn begin(stages: &mut impl Stages) -> Self {
        stages.save();
        Self { lowest: stages.objective(), next_check: FIRST }
    }

    /// After iteration `k` (from 1): whether it is time to look.
    pub(crate) fn is_due(&self, k: u32) -> bool {
        k >= self.next_check
    }

    /// Looks; returns whether the iterations since the last look were taken back.
    pub(crate) fn check(&mut self, k: u32, stages: &mut impl Stages) -> bool {
        self.next_check = k + k.clamp(1, LONGEST);
        let objective = stages.objective();
        // Not a number compares false: it is a rise.
        if objective <= self.lowest + stages.tolerated_rise() * self.lowest.abs() {
            self.lowest = objective.min(self.lowest);
            stages.save();
            false
        } else {
            stages.restore();
            true
        }
    }

    /// The lowest objective seen \[J\].
    pub(crate) fn lowest(&self) -> f64 {
        self.lowest
    }
}
