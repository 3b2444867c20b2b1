//! What can be wrong with a scene.

use std::path::PathBuf;

use vivace_mesh::MeshError;
use vivace_model::ModelError;

use crate::{ObstacleError, PathError};

/// Why a scene is refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// A file cannot be read.
    #[error("cannot read {}: {reason}; check the path", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the operating system said.
        reason: String,
    },
    /// A file's name does not say what it is.
    #[error("{} is neither .ron nor .json; rename it", path.display())]
    Extension {
        /// The file.
        path: PathBuf,
    },
    /// The text is not a scene.
    #[error(
        "{}line {line}, column {column}: {reason}; write there what the documentation of `Scene` lists",
        prefix(path.as_ref())
    )]
    Syntax {
        /// The file, where it was one.
        path: Option<PathBuf>,
        /// From 1.
        line: usize,
        /// From 1.
        column: usize,
        /// What was expected there.
        reason: String,
    },
    /// There is nothing to simulate.
    #[error("the scene has no bodies; give at least one in `bodies`")]
    Empty,
    /// The time step or a force cannot be simulated.
    #[error("the scene's forces or time step: {0}")]
    Value(ModelError),
    /// A body cannot be made.
    #[error("body {body} ({shape}): {source}")]
    Body {
        /// Which, from 0.
        body: usize,
        /// What it is.
        shape: &'static str,
        /// What is wrong with it.
        source: BodyError,
    },
    /// An obstacle cannot be made.
    #[error("obstacle {obstacle}: {source}")]
    Obstacle {
        /// Which, from 0.
        obstacle: usize,
        /// What is wrong with it.
        source: ObstacleError,
    },
    /// The bodies do not make a model together.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A scene could not be written as text.
    #[error("the scene cannot be written as text: {reason}")]
    Write {
        /// Why.
        reason: String,
    },
}

/// Why a body is refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BodyError {
    /// Its shape has no mesh.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// Its material, or a place, is out of range.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// Cloth that is to tear and has nothing that can break.
    #[error(
        "the cloth is to tear, which begins with a spring that breaks; give it `springs`, or leave `tear` out"
    )]
    NoSprings,
    /// A file that the shape needs cannot be read.
    #[error("cannot read {}: {reason}; paths are relative to the scene's folder", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the operating system said.
        reason: String,
    },
    /// A surface of volume material, or the reverse.
    #[error("the shape is a {shape}, but the material is for a {material}; give it `material: {remedy}`")]
    Material {
        /// What the shape is.
        shape: &'static str,
        /// What the material is for.
        material: &'static str,
        /// What to write.
        remedy: &'static str,
    },
    /// What is to be dragged has no way.
    #[error("drags[{index}]: {source}")]
    Drag {
        /// Which, from 0.
        index: usize,
        /// What is wrong with it.
        source: PathError,
    },
    /// A selection that means no particle.
    #[error(
        "{list}[{index}] selects no particle; the body reaches from {min} to {max} (its own coordinates)"
    )]
    Nothing {
        /// `pins`, `attachments` or `drags`.
        list: &'static str,
        /// Which, from 0.
        index: usize,
        /// Least coordinates of the body \[m\].
        min: glam::Vec3,
        /// Greatest coordinates of the body \[m\].
        max: glam::Vec3,
    },
    /// A selection with numbers that cannot be.
    #[error("{list}[{index}]: {reason}")]
    Select {
        /// `pins`, `attachments` or `drags`.
        list: &'static str,
        /// Which, from 0.
        index: usize,
        /// What is wrong and what to do.
        reason: String,
    },
}

fn prefix(path: Option<&PathBuf>) -> String {
    path.map_or_else(String::new, |path| format!("{}, ", path.display()))
}
