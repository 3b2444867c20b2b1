//! What a step says of itself.

use serde::{Deserialize, Serialize};

/// What one step did.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct StepReport {
    /// Iterations of the relaxation, over all substeps.
    pub iterations: u32,
    /// Colors of the sweeps; 0 where the relaxation needs none.
    pub colors: u32,
    /// Root mean square distance that the last iteration moved the particles \[m\]; `None` without a tolerance in the budget, and
    /// where no iteration was kept.
    pub last_move: Option<f32>,
    /// Objective of the (last small) step at its end \[J\], up to a constant of the step: inertia and energy of the constraints.
    /// There where the safeguard watched, as it does accelerated relaxations, and where [`System::set_measuring`] asks for it.
    ///
    /// [`System::set_measuring`]: crate::System::set_measuring
    pub objective: Option<f64>,
    /// Root mean square force that is out of balance at the end, over the free particles \[N\]: the gradient of the objective. There
    /// where [`System::set_measuring`] asks for it.
    ///
    /// [`System::set_measuring`]: crate::System::set_measuring
    pub residual: Option<f64>,
    /// How often the safeguard took back an iteration and lowered the acceleration.
    pub backoffs: u32,
    /// Time per phase.
    pub times: PhaseTimes,
    /// Why it stopped.
    pub stop: Stop,
    /// Contacts; all 0 without collisions.
    #[serde(default)]
    pub contacts: ContactReport,
    /// What tore at the end, where a simulation looks after that; all 0 where nothing did.
    #[serde(default)]
    pub tears: TearReport,
}

/// What tore. Counts.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TearReport {
    /// Particles that have come to be.
    pub copies: usize,
    /// Corners of triangles that have a copy in place of what was there.
    pub triangles: usize,
    /// Springs between no triangles that broke.
    pub springs: usize,
}

/// What collisions did in a step.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ContactReport {
    /// Contacts that were solved, in the last small step.
    pub contacts: usize,
    /// Colors of these, in each of which no two share a particle; on a GPU as many as it goes through, some of them empty.
    pub colors: usize,
    /// Contacts beyond the bound on their number, which were not, over all small steps.
    pub left_out: usize,
    /// Particles that the guard held back, over all small steps.
    pub held_back: usize,
    /// By how much the end of the step comes nearer than the thickness, at the worst contact \[m\].
    pub deepest: f32,
    /// The same, as a mean over all contacts \[m\].
    pub mean_depth: f32,
}

/// Seconds spent in each phase of a step.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct PhaseTimes {
    /// Checks and copies; where the time step changed, parameters, factorization, [`Rho::Estimated`](crate::Rho::Estimated) \[s\]. (Graph
    /// and coloring are made with the system.)
    pub setup: f64,
    /// Outer forces and prediction \[s\].
    pub predict: f64,
    /// Iterations \[s\].
    pub solve: f64,
    /// Detection of contacts \[s\].
    #[serde(default)]
    pub detect: f64,
    /// Contacts made constraints, and colored \[s\].
    #[serde(default)]
    pub color: f64,
    /// The guard that lets nothing pass \[s\].
    #[serde(default)]
    pub guard: f64,
    /// Looking for what tears, and making the system anew where something did \[s\].
    #[serde(default)]
    pub tear: f64,
    /// Velocities, checks, and measures where they are asked for \[s\].
    pub finish: f64,
}

/// Why a step stopped.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Stop {
    /// All iterations were done.
    #[default]
    Iterations,
    /// The time was up.
    Time,
    /// The particles moved no more than the tolerance.
    Tolerance,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_report_survives_json() {
        let bare = StepReport::default();
        let third = |k: i32| f64::from(k) / 3.0;
        let full = (-500..500).map(|k| StepReport {
            last_move: Some(k as f32 / 3.0),
            objective: Some(third(k) * 1e-7),
            residual: Some(third(k).exp2()),
            stop: Stop::Tolerance,
            ..bare
        });
        for report in full.chain([bare]) {
            let text = serde_json::to_string(&report).unwrap();
            assert_eq!(serde_json::from_str::<StepReport>(&text).unwrap(), report, "{text}");
        }
    }
}
