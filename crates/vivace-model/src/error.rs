//! What can be wrong with a model or a state.

use std::ops::Range;

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
        "{kind} {element} names particle {particle}, but there are only {n_particles}, numbered from 0: check its indices and `first`, which is added to them"
    )]
    Index {
        /// Kind of the element.
        kind: &'static str,
        /// Which one of its call, from 0.
        element: usize,
        /// The particle it names, numbered through all bodies.
        particle: u64,
        /// How many particles there are.
        n_particles: usize,
    },
    /// An element names a particle twice, or has no rest shape: it is flat, or so large or stiff that `f32` cannot hold it.
    #[error(
        "{kind} {element} is degenerate (particles {particles:?}): it names one twice, is flat, or is too large or stiff for f32; remove it, or repair the mesh"
    )]
    Degenerate {
        /// Kind of the element.
        kind: &'static str,
        /// Which one of its call, from 0.
        element: usize,
        /// Its particles, numbered through all bodies.
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
    /// A density and a mesh that give a mass which `f32` cannot hold.
    #[error(
        "the density gives particle {particle} a mass of {mass:e} kg, beyond the range of f32: correct the density, or the size of the mesh"
    )]
    Density {
        /// The particle.
        particle: usize,
        /// Its mass \[kg\].
        mass: f64,
    },
    /// There is no such attachment.
    #[error("there is no attachment {attachment}: the model has {n_attachments}, numbered from 0")]
    Attachment {
        /// The one that was asked for.
        attachment: usize,
        /// How many there are.
        n_attachments: usize,
    },
    /// A target that is not finite, or too far away to be squared.
    #[error(
        "the target of attachment {attachment} is {target}: not finite or beyond 1e12 m; correct it. Nothing was changed"
    )]
    Target {
        /// The attachment.
        attachment: usize,
        /// Where it was to pull to \[m\].
        target: Vec3,
    },
    /// A particle that is to be held and is pinned.
    #[error("particle {particle} is pinned already; release it first, or hold another")]
    Pinned {
        /// The particle.
        particle: u32,
    },
    /// A particle that is to be let go and is not held.
    #[error("particle {particle} is not pinned, or has been since the model was built, and stays so")]
    NotPinned {
        /// The particle.
        particle: u32,
    },
    /// Springs that are to break and are not there.
    #[error("springs {springs:?} are to break, but there are {n_springs}, numbered from 0: add them first")]
    Springs {
        /// Their numbers.
        springs: Range<usize>,
        /// How many there are.
        n_springs: usize,
    },
    /// A spring that may not break.
    #[error(
        "spring {spring} is to break at a particle of a tetrahedron: volumes do not tear, cloth and ropes do"
    )]
    NoTear {
        /// Its number.
        spring: usize,
    },
    /// A tear that is none of this model's.
    #[error("tear {tear}: {reason}. Tears are those of the model in which they were found")]
    Tear {
        /// Which of those given, from 0.
        tear: usize,
        /// What is wrong with it.
        reason: &'static str,
    },
    /// A time step that cannot be.
    #[error("the time step is {value} s; it must be above 0 and at most 1000")]
    TimeStep {
        /// \[s\].
        value: f32,
    },
    /// An array has a wrong length.
    #[error("there are {found} {what} for {expected} particles; give one for each")]
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
        "the {what} hold {value} at particle {particle}: not finite or beyond 1e12; correct it. Nothing was changed"
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
    #[error("{n_particles} particles are more than 32 bits can number; split the model")]
    TooMany {
        /// How many were wanted.
        n_particles: usize,
    },
}
