//! How long a step may take.

use serde::{Deserialize, Serialize};

use crate::SolverError;

/// When a step stops: at the first of the bounds that are set. At least one must be.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Budget {
    /// Iterations of the relaxation, over all substeps. 0 leaves the prediction as it is: free fall.
    pub iterations: Option<u32>,
    /// Time for the solver \[s\]. Another iteration begins while it is expected to end in time; the first always runs.
    pub seconds: Option<f64>,
    /// Stop when an iteration moves no particle by more than this \[m\] (root mean square).
    pub tolerance: Option<f32>,
}

impl Budget {
    /// So many iterations.
    #[must_use]
    pub const fn iterations(n: u32) -> Self {
        Self { iterations: Some(n), seconds: None, tolerance: None }
    }

    /// So much time \[ms\].
    #[must_use]
    pub fn milliseconds(ms: f64) -> Self {
        Self { seconds: Some(ms / 1e3), ..Self::default() }
    }

    /// Until an iteration moves the particles by less than this \[m\] (root mean square), and at most 100,000 iterations.
    #[must_use]
    pub fn tolerance(meters: f32) -> Self {
        Self { tolerance: Some(meters), iterations: Some(100_000), ..Self::default() }
    }

    /// With a bound on the iterations, too.
    #[must_use]
    pub fn and_iterations(self, n: u32) -> Self {
        Self { iterations: Some(n), ..self }
    }

    /// With a bound on the time \[ms\], too.
    #[must_use]
    pub fn and_milliseconds(self, ms: f64) -> Self {
        Self { seconds: Some(ms / 1e3), ..self }
    }

    /// With a tolerance, too: stops early where an iteration moves the particles by no more than this \[m\] (root mean square).
    #[must_use]
    pub fn and_tolerance(self, meters: f32) -> Self {
        Self { tolerance: Some(meters), ..self }
    }

    /// Whether it is of iterations alone: nobody has to look when to stop.
    pub(crate) fn is_counted(&self) -> bool {
        self.iterations.is_some() && self.seconds.is_none() && self.tolerance.is_none()
    }

    /// Whether there is a bound, and each makes sense.
    ///
    /// # Errors
    /// No bound, or one that is negative or not a number.
    pub fn check(&self) -> Result<(), SolverError> {
        let bad = |what, value| Err(SolverError::Setting { what, value, need: "finite and not negative" });
        match (self.seconds, self.tolerance) {
            (Some(s), _) if !(s >= 0.0 && s.is_finite()) => bad("the time budget [s]", s),
            (_, Some(t)) if !(t >= 0.0 && t.is_finite()) => bad("the tolerance [m]", f64::from(t)),
            (None, None) if self.iterations.is_none() => Err(SolverError::NoBudget),
            (None, Some(_)) if self.iterations.is_none() => Err(SolverError::NoBudget),
            _ => Ok(()),
        }
    }
}
