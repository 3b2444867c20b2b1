//! The one error type of this crate. Every message names the element or line and the remedy.

/// Why a mesh was refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} has the non-finite coordinate {value}; give finite coordinates in metres")]
    NonFinite {
        /// Index of the vertex, from 0.
        vertex: usize,
        /// The offending coordinate.
        value: f32,
    },
    /// A face or cell names a vertex that is not there.
    #[error("{element} {index} names vertex {vertex}, but there are {n_vertices} (numbered from 0)")]
    IndexOutOfRange {
        /// "triangle" or "tetrahedron".
        element: &'static str,
        /// Index of the element, from 0.
        index: usize,
        /// The vertex it names.
        vertex: u32,
        /// How many vertices there are.
        n_vertices: usize,
    },
    /// A tetrahedron names one vertex twice.
    #[error("{element} {index} names vertex {vertex} twice; remove it or give it distinct corners")]
    RepeatedVertex {
        /// "triangle" or "tetrahedron".
        element: &'static str,
        /// Index of the element, from 0.
        index: usize,
        /// The vertex named twice.
        vertex: u32,
    },
    /// More than 2^32 - 2 vertices or elements: indices are 32-bit.
    #[error("{count} {what}: indices are 32-bit, so at most {} fit; split the mesh", u32::MAX - 1)]
    TooLarge {
        /// What there is too much of.
        what: &'static str,
        /// How many there are.
        count: usize,
    },
}
