//! What a solver refuses.

use vivace_collision::CollisionError;
use vivace_coloring::{GraphError, Violation};
use vivace_model::ModelError;

/// Why a system cannot be made or stepped. The state is as it was.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SolverError {
    /// The model or the state is not one that can be simulated.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The model has more constraints than 32 bits can number.
    #[error(transparent)]
    Graph(#[from] GraphError),
    /// A parameter is out of range.
    #[error("{what} is {value}; it must be {need}")]
    Setting {
        /// The parameter.
        what: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        need: &'static str,
    },
    /// A budget without an end.
    #[error("the budget has no bound that is sure to end: set iterations or seconds")]
    NoBudget,
    /// A combination that does not exist.
    #[error(
        "{relaxation} works in Projective Dynamics only; take another relaxation for Position Based Dynamics"
    )]
    NotPositionBased {
        /// The relaxation.
        relaxation: &'static str,
    },
    /// A step without a state to begin with.
    #[error("there is no state to go on from: load one first")]
    NoState,
    /// What a device does not do.
    #[error("{what} is not done on a device: take {instead}, or stay on the CPU")]
    NotOnDevice {
        /// What was asked for.
        what: &'static str,
        /// What is done there.
        instead: &'static str,
    },
    /// The device could not do its work: the error is the backend's own.
    #[error(transparent)]
    Device(Box<dyn std::error::Error + Send + Sync>),
    /// The crate was built without the feature.
    #[error("the direct solver is not built in: enable the feature `direct`")]
    NoDirect,
    /// An entry on the diagonal of Y that cannot be divided by.
    #[error(
        "mass / h² and the stiffness of all constraints at particle {particle} add up to {weight:e} N/m, beyond the range of f32: correct its mass or stiffness, or change the time step"
    )]
    Weight {
        /// The particle.
        particle: u32,
        /// The entry \[N/m\].
        weight: f32,
    },
    /// Y could not be factored.
    #[error(
        "the matrix of the global step could not be factored ({reason}): masses or weights are too far apart"
    )]
    Factor {
        /// What the factorisation said.
        reason: String,
    },
    /// Where coloring anew in every frame cannot be.
    #[error(
        "{why}, so it is not colored anew in every frame: its coloring stands as long as its constraints do"
    )]
    NoRecoloring {
        /// What it is.
        why: &'static str,
    },
    /// Detection refuses the surface, an obstacle or a position.
    #[error(transparent)]
    Collision(#[from] CollisionError),
    /// The graph of a model and its coloring disagree.
    #[error("{violation}")]
    Coloring {
        /// Where.
        violation: Violation,
    },
    /// The step ended outside the range of `f32`.
    #[error(
        "particle {particle} left the range of numbers; the state was left as it was. Take a smaller step, or a solver with safeguard"
    )]
    Diverged {
        /// The first particle that is not finite; a pinned one only if no other is.
        particle: usize,
    },
}

/// A count that has to fit 32 bits.
pub(crate) fn narrow(what: &'static str, count: usize) -> Result<u32, GraphError> {
    u32::try_from(count).map_err(|_| GraphError::TooLarge { what, count, limit: u32::MAX as usize })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_count_beyond_32_bits_says_of_what() {
        assert_eq!(narrow("neighbors", 7), Ok(7));
        let error = narrow("neighbors", 1 << 32).unwrap_err().to_string();
        assert!(error.starts_with("4294967296 neighbors"), "{error}");
    }
}
