//! What can be wrong with a model or a state.

use glam::Vec3;

/// Why a model or state is refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// A parameter is out of range.
    #[error("{what} is {value}; it must be {need}")]
    Value {
        /// The parameter.
        what: &'static str,
        /// Its value.
        value: f32,
        /// What it must be.
        need: &'static str,
    },
    /// An element names a particle that does not exist.
    #[error(
        "{kind} {element} names particle {particle}, but there are only {n_particles}: check the indices"
    )]
    Index {
        /// Kind of the element.
        kind: &'static str,
        /// Which one.
        element: usize,
        /// The particle it names.
        particle: u32,
        /// How many particles there are.
        n_particles: usize,
    },
    /// An element names a particle twice, or is too flat to have a rest shape.
    #[error("{kind} {element} is degenerate (particles {particles:?}): remove it, or repair the mesh")]
    Degenerate {
        /// Kind of the element.
        kind: &'static str,
        /// Which one.
        element: usize,
        /// Its particles.
        particles: Vec<u32>,
    },
    /// A particle has a mass that cannot be simulated.
    #[error(
        "particle {particle} has mass {mass} kg; a mass must be positive (infinite: pinned). Is the particle part of any element?"
    )]
    Mass {
        /// The particle.
        particle: usize,
        /// Its mass \[kg\].
        mass: f32,
    },
    /// An array has a wrong length.
    #[error("there are {found} {what} for {expected} particles")]
    Length {
        /// The array.
        what: &'static str,
        /// Number of particles.
        expected: usize,
        /// Its length.
        found: usize,
    },
    /// A position or velocity is not finite, or too large to be squared.
    #[error(
        "the {what} hold {value} at particle {particle}: not finite or beyond 1e12. The state was left as it was"
    )]
    NotFinite {
        /// The array.
        what: &'static str,
        /// The particle.
        particle: usize,
        /// What stands there.
        value: Vec3,
    },
    /// More particles than 32 bits can number.
    #[error("{n_particles} particles are more than 32 bits can number")]
    TooMany {
        /// How many were wanted.
        n_particles: usize,
    },
}
