//! A scene, its files, and the model it makes.

use std::path::Path;

use glam::Vec3;
use ron::extensions::Extensions;
use serde::{Deserialize, Serialize};
use vivace_model::{Forces, Model, ModelBuilder, State, check_time_step};

use crate::drag::Path as Way;
use crate::{Body, Collisions, Hold, SceneError};

/// Bodies, and what acts on them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Scene {
    /// For people.
    pub name: String,
    /// Particles are numbered body by body.
    pub bodies: Vec<Body>,
    /// Gravity, damping, wind.
    pub forces: Forces,
    /// Time from frame to frame \[s\].
    pub time_step: f32,
    /// Whether and with what bodies collide; left out, they pass through one another.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub collisions: Option<Collisions>,
}

/// A scene, built.
#[derive(Debug, Clone, PartialEq)]
pub struct Built {
    /// The model.
    pub model: Model,
    /// The state it begins in.
    pub state: State,
    /// What is dragged while it runs, in the order of the scene.
    pub drags: Vec<Held>,
}

/// A [`Drag`](crate::Drag) of the particles that it selects.
#[derive(Debug, Clone, PartialEq)]
pub struct Held {
    /// The particles.
    pub particles: Vec<u32>,
    /// How they are held.
    pub hold: Hold,
    /// Where they go.
    pub path: Way,
    /// When they are let go \[s\].
    pub release: Option<f64>,
}

impl Default for Scene {
    /// Nothing under gravity, at 30 frames a second.
    fn default() -> Self {
        Self {
            name: String::new(),
            bodies: Vec::new(),
            forces: Forces::default(),
            time_step: 1.0 / 30.0,
            collisions: None,
        }
    }
}

impl Scene {
    /// Reads a .ron or .json file.
    ///
    /// # Errors
    /// The file cannot be read; it is not a scene: says the line and column.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, SceneError> {
        let path = path.as_ref();
        let parse = match path.extension().and_then(|extension| extension.to_str()) {
            Some(e) if e.eq_ignore_ascii_case("ron") => Self::from_ron,
            Some(e) if e.eq_ignore_ascii_case("json") => Self::from_json,
            _ => return Err(SceneError::Extension { path: path.to_owned() }),
        };
        let text = std::fs::read_to_string(path)
            .map_err(|error| SceneError::Read { path: path.to_owned(), reason: error.to_string() })?;
        parse(&text).map_err(|error| match error {
            SceneError::Syntax { line, column, reason, .. } => {
                SceneError::Syntax { path: Some(path.to_owned()), line, column, reason }
            }
            other => other,
        })
    }

    /// Reads RON. `Some(…)` may be left out.
    ///
    /// # Errors
    /// The text is not a scene: says the line and column.
    pub fn from_ron(text: &str) -> Result<Self, SceneError> {
        let options = ron::Options::default().with_default_extension(Extensions::IMPLICIT_SOME);
        options.from_str(text).map_err(|error| {
            let (line, column) = (error.span.start.line, error.span.start.col);
            // The parser points at the blanks before a value, people at the value.
            let from = text.lines().nth(line.saturating_sub(1)).unwrap_or_default().chars();
            let n_blanks = from.skip(column.saturating_sub(1)).take_while(|c| c.is_whitespace()).count();
            let reason = error.code.to_string();
            SceneError::Syntax { path: None, line, column: column + n_blanks, reason }
        })
    }

    /// Reads JSON.
    ///
    /// # Errors
    /// The text is not a scene: says the line and column.
    pub fn from_json(text: &str) -> Result<Self, SceneError> {
        serde_json::from_str(text).map_err(|error| {
            let (line, column) = (error.line(), error.column());
            let reason = error.to_string();
            let place = format!(" at line {line} column {column}");
            let reason = reason.strip_suffix(&place).unwrap_or(&reason).to_owned();
            SceneError::Syntax { path: None, line, column, reason }
        })
    }

    /// As RON that [`Scene::from_ron`] reads back to the same scene.
    ///
    /// # Errors
    /// A path that is not Unicode.
    pub fn to_ron(&self) -> Result<String, SceneError> {
        let options = ron::Options::default().with_default_extension(Extensions::IMPLICIT_SOME);
        let pretty = ron::ser::PrettyConfig::default().compact_arrays(true).new_line("\n");
        let text = options.to_string_pretty(self, pretty);
        text.map(|text| text + "\n").map_err(|error| SceneError::Write { reason: error.to_string() })
    }

    /// As JSON that [`Scene::from_json`] reads back to the same scene, if all its numbers are finite.
    ///
    /// # Errors
    /// A path that is not Unicode.
    pub fn to_json(&self) -> Result<String, SceneError> {
        let text = serde_json::to_string_pretty(self);
        text.map(|text| text + "\n").map_err(|error| SceneError::Write { reason: error.to_string() })
    }

    /// The model, and the state it begins in; what is dragged is free there, see [`Scene::build_all`]. Files of meshes are looked for
    /// in `folder`.
    ///
    /// # Errors
    /// As [`Scene::build_all`].
    pub fn build(&self, folder: &Path) -> Result<(Model, State), SceneError> {
        self.build_all(folder).map(|built| (built.model, built.state))
    }

    /// The model, the state it begins in, and what is dragged while it runs. Files of meshes are looked for in `folder`.
    ///
    /// # Errors
    /// No bodies; a value that is not finite, zero or negative where it may not be; a mesh that cannot be made; a selection that
    /// means nothing. Says which body.
    pub fn build_all(&self, folder: &Path) -> Result<Built, SceneError> {
        if self.bodies.is_empty() {
            return Err(SceneError::Empty);
        }
        self.forces.check().map_err(SceneError::Value)?;
        check_time_step(self.time_step).map_err(SceneError::Value)?;
        let mut builder = ModelBuilder::new();
        let (mut velocities, mut drags) = (Vec::<Vec3>::new(), Vec::new());
        for (index, body) in self.bodies.iter().enumerate() {
            let result = body.add(&mut builder, &mut velocities, &mut drags, folder);
            result.map_err(|source| SceneError::Body { body: index, shape: body.shape.name(), source })?;
        }
        let (model, mut state) = builder.build()?;
        for ((particle, velocity), wanted) in (0..).zip(&mut state.velocities).zip(velocities) {
            if !model.is_pinned(particle) {
                *velocity = wanted;
            }
        }
        Ok(Built { model, state, drags })
    }
}
