//! A simulation at rest on disk.

use serde::{Deserialize, Serialize};
use vivace_model::{Forces, State, Tear};
use vivace_solver::Ease;

use crate::{Patch, SimError, Vec3};

/// All of a simulation that changes from frame to frame. The scene and the solver are not part of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Snapshot {
    /// Frames since the start.
    pub frame: u64,
    /// Time since the start \[s\].
    pub time: f64,
    /// Time from frame to frame \[s\].
    pub time_step: f32,
    /// What acts on the particles.
    pub forces: Forces,
    /// What the safeguard remembers.
    pub ease: Ease,
    /// What is held.
    #[serde(default)]
    pub grabs: Vec<Patch>,
    /// How often something has been held.
    #[serde(default)]
    pub n_grabs: u64,
    /// What has torn, frame by frame.
    #[serde(default)]
    pub tears: Vec<Torn>,
    /// Where each attachment pulls to \[m\].
    pub targets: Vec<Vec3>,
    /// Positions and velocities.
    pub state: State,
}

/// What tore at the end of a frame.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Torn {
    /// The frame, from 1.
    pub frame: u64,
    /// In the order in which it tore.
    pub tears: Vec<Tear>,
}

impl Snapshot {
    /// As JSON; [`Snapshot::from_json`] reads back every bit of it.
    ///
    /// # Errors
    /// None for the snapshot of a simulation.
    pub fn to_json(&self) -> Result<String, SimError> {
        serde_json::to_string(self).map_err(|error| in_text(&error))
    }

    /// Reads JSON.
    ///
    /// # Errors
    /// The text is not a snapshot: says the line and column.
    pub fn from_json(text: &str) -> Result<Self, SimError> {
        serde_json::from_str(text).map_err(|error| in_text(&error))
    }
}

fn in_text(error: &serde_json::Error) -> SimError {
    let (line, column) = (error.line(), error.column());
    let text = error.to_string();
    let reason = text.strip_suffix(&format!(" at line {line} column {column}")).unwrap_or(&text).to_owned();
    SimError::Text { line, column, reason }
}
