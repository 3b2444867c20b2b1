//! A watch over accelerated relaxations.

use crate::Stages;

/// Compares the objective at 8, 16, 32, 48, … iterations and at the end with what it was; takes back what raised it, and eases the
/// acceleration. Plain relaxations never raise it in Projective Dynamics, so easing ends.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Safeguard {
    /// Lowest objective seen, and that of the positions that were kept last \[J\].
    lowest: f64,
    kept: f64,
    /// What roundings may add to it \[J\].
    rounding: f64,
    looks: Looks,
}

/// Iterations before the first look.
const FIRST: u32 = 8;
/// Most iterations between two looks.
pub(crate) const LONGEST: u32 = 16;

/// When to look: after 8, 16, 32, 48, … iterations.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Looks {
    last: u32,
    next: u32,
}

impl Looks {
    pub(crate) fn new() -> Self {
        Self { last: 0, next: FIRST }
    }

    /// Whether it is time, after `k` iterations.
    pub(crate) fn is_due(&self, k: u32) -> bool {
        k >= self.next
    }

    pub(crate) fn look(&mut self, k: u32) {
        *self = Self { last: k, next: k + k.clamp(1, LONGEST) };
    }
}

impl Safeguard {
    /// Before the first iteration of a time step, whose objective was so at its start \[J\].
    pub(crate) fn begin(objective: f64, rounding: f64, stages: &mut dyn Stages) -> Self {
        stages.save();
        Self { lowest: objective, kept: objective, rounding, looks: Looks::new() }
    }

    /// After iteration `k` (from 1): whether it is time to look.
    pub(crate) fn is_due(&self, k: u32) -> bool {
        self.looks.is_due(k)
    }

    /// Looks; returns whether the iterations since the last look were taken back.
    pub(crate) fn check(&mut self, k: u32, stages: &mut dyn Stages) -> bool {
        self.looks.look(k);
        let objective = stages.objective();
        // Not a number compares false: it is a rise.
        if objective <= self.lowest + stages.tolerated_rise() * self.lowest.abs() + self.rounding {
            self.lowest = objective.min(self.lowest);
            self.kept = objective;
            stages.save();
            false
        } else {
            stages.restore();
            true
        }
    }

    /// Whether the last look was after iteration `k`.
    pub(crate) fn has_looked(&self, k: u32) -> bool {
        self.looks.last == k
    }

    /// The objective of the positions that were kept last \[J\].
    pub(crate) fn kept(&self) -> f64 {
        self.kept
    }
}
