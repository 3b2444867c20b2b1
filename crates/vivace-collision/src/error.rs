//! What detection refuses.

use glam::Vec3;

/// Why a detector or an obstacle cannot be made, or a frame cannot be looked at. Nothing was changed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CollisionError {
    /// A parameter is out of range.
    #[error("{what} is {value}; it must be {need}")]
    Setting {
        /// The parameter.
        what: &'static str,
        /// Its value.
        value: f32,
        /// What it must be.
        need: &'static str,
    },
    /// A thickness that the mesh is too fine for.
    #[error(
        "the thickness is {thickness} m, but the edge ({}, {}) is only {length} m long: take at most half of it, or a coarser mesh",
        edge[0], edge[1]
    )]
    Thickness {
        /// The thickness \[m\].
        thickness: f32,
        /// The ends of the shortest edge.
        edge: [u32; 2],
        /// Its length \[m\].
        length: f32,
    },
    /// A triangle that names a particle which is not there, or one twice.
    #[error("triangle {triangle} is ({}, {}, {}): it needs three different ones of the {n_particles} particles", corners[0], corners[1], corners[2])]
    Triangle {
        /// The triangle.
        triangle: usize,
        /// Its corners.
        corners: [u32; 3],
        /// How many particles there are.
        n_particles: usize,
    },
    /// An array of a wrong length.
    #[error("{found} {what} for {expected} particles")]
    Length {
        /// The array.
        what: &'static str,
        /// Its length.
        found: usize,
        /// What it must be.
        expected: usize,
    },
    /// A position that is not finite, or beyond 10¹² m.
    #[error("{what} of particle {particle} is {value}: it must be finite, at most 1e12 m along each axis")]
    NotFinite {
        /// Which positions.
        what: &'static str,
        /// The first such particle.
        particle: usize,
        /// Its position \[m\].
        value: Vec3,
    },
    /// An obstacle with a pose that is not one, or a length that is not positive.
    #[error("obstacle {obstacle}: {fault}")]
    Obstacle {
        /// Which one.
        obstacle: usize,
        /// What is wrong.
        fault: &'static str,
    },
    /// A field that would take more memory than allowed.
    #[error(
        "a field of {cells:?} cells takes {bytes} bytes, more than the {limit} allowed: take a wider spacing"
    )]
    Memory {
        /// Cells along each axis.
        cells: [u64; 3],
        /// Bytes needed.
        bytes: u64,
        /// Bytes allowed.
        limit: u64,
    },
    /// A solid that cannot be sampled.
    #[error("the solid cannot be sampled: {fault}")]
    Field {
        /// What is wrong.
        fault: &'static str,
    },
}
