//! The one error type of this crate. Every message names the element or line and the remedy.

use std::path::PathBuf;

use crate::mesh::{FLAT_QUALITY, MAX_COORDINATE};

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
    /// A coordinate is finite but so large that volumes overflow in `f32`: see [`MAX_COORDINATE`].
    #[error(
        "vertex {vertex} has the coordinate {value:e}, beyond {MAX_COORDINATE:e} m, where volumes overflow; \
         scale the mesh down"
    )]
    TooFar {
        /// Index of the vertex, from 0.
        vertex: usize,
        /// The offending coordinate \[m\].
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
    /// A tetrahedron is flat: its quality is at most [`FLAT_QUALITY`], so that its rest shape cannot be inverted.
    #[error(
        "tetrahedron {index} is flat (quality {quality:.1e}, at most {FLAT_QUALITY:.0e}), so its rest shape cannot be \
         inverted; remove it or move a corner"
    )]
    FlatTet {
        /// Index of the tetrahedron, from 0.
        index: usize,
        /// Its quality \[1\], 1 for the regular tetrahedron.
        quality: f64,
    },
    /// A tetrahedron is well shaped, but its volume is below what an `f32` can hold with full precision.
    #[error(
        "tetrahedron {index} has a volume of {volume:.1e} m^3, too small for 32-bit numbers; scale the mesh up"
    )]
    TinyTet {
        /// Index of the tetrahedron, from 0.
        index: usize,
        /// Its volume \[m^3\].
        volume: f64,
    },
    /// A tetrahedron has negative volume.
    #[error(
        "tetrahedron {index} is inverted (volume {volume:.1e} m^3); swap two of its corners, or use TetMesh::oriented"
    )]
    InvertedTet {
        /// Index of the tetrahedron, from 0.
        index: usize,
        /// Its volume \[m^3\], negative.
        volume: f64,
    },
    /// More than 2^32 - 2 vertices or elements: indices are 32-bit.
    #[error("{count} {what}: indices are 32-bit, so at most {} fit; split the mesh", u32::MAX - 1)]
    TooLarge {
        /// What there is too much of.
        what: &'static str,
        /// How many there are.
        count: usize,
    },
    /// There is nothing to simulate.
    #[error("there are no {what}; give at least one")]
    Empty {
        /// What is missing.
        what: &'static str,
    },
    /// A surface does not bound a volume.
    #[error("this surface does not bound a volume: {fault}; repair it, or use it as a cloth")]
    NotAVolumeBoundary {
        /// The first fault found, with the edge, the vertex or the triangles (numbered from 0).
        fault: String,
    },
    /// A generator was asked for an impossible size.
    #[error("{what} is {value}, but must be {need}")]
    Size {
        /// The parameter.
        what: &'static str,
        /// Its value.
        value: f64,
        /// What it has to be.
        need: &'static str,
    },
    /// The Delaunay triangulation of a generated mesh failed.
    #[error("the points could not be triangulated ({reason}); use another spacing or seed")]
    Delaunay {
        /// What the triangulation said.
        reason: String,
    },
    /// Something is wrong in the text of a file.
    #[error("line {line}: {reason}")]
    Line {
        /// Line number, from 1.
        line: usize,
        /// What is wrong there and what to do.
        reason: String,
    },
    /// A file could not be read or written.
    #[error("{reason}; check the path and the permissions")]
    Io {
        /// What the operating system said.
        reason: String,
    },
    /// The name of a file does not tell its format.
    #[error(
        "the format cannot be told from the extension {extension:?}; use .obj (triangles) or .vtk (tetrahedra)"
    )]
    UnknownExtension {
        /// The extension as it stands in the name, empty if there is none.
        extension: String,
    },
    /// Any of the above, and the file where it happened.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What happened.
        source: Box<MeshError>,
    },
    /// A signed distance function gave NaN or infinity.
    #[error("the signed distance at {point:?} is {value}; the function must be finite inside its bounds")]
    NonFiniteDistance {
        /// Where \[m\].
        point: [f64; 3],
        /// What it gave.
        value: f64,
    },
    /// A shape's bounding box is infinite, NaN or inverted.
    #[error("the shape's bounds reach from {min:?} to {max:?}; give finite bounds with min <= max")]
    BadBounds {
        /// Smallest coordinates \[m\].
        min: [f64; 3],
        /// Largest coordinates \[m\].
        max: [f64; 3],
    },
    /// No lattice point lies inside the shape.
    #[error("no lattice point lies inside the shape at a cell size of {cell_size} m; use smaller cells")]
    EmptyShape {
        /// Cell size \[m\].
        cell_size: f64,
    },
    /// The cells are too small for 32-bit indices.
    #[error(
        "cells of {cell_size} m need {needed} {what}, but at most {limit} can be numbered; use larger cells"
    )]
    CellTooFine {
        /// Cell size \[m\].
        cell_size: f64,
        /// What there would be too many of.
        what: &'static str,
        /// How many there would be (infinity when beyond counting).
        needed: f64,
        /// How many can be numbered.
        limit: f64,
    },
    /// The cells are so small that 32-bit coordinates cannot tell their vertices apart.
    #[error(
        "cells of {cell_size} m cannot be told apart at the coordinate {coordinate} m in 32-bit floats; use larger cells or move \
         the shape to the origin"
    )]
    CellBelowPrecision {
        /// Cell size \[m\].
        cell_size: f64,
        /// Largest coordinate of the shape \[m\].
        coordinate: f64,
    },
}

impl MeshError {
    /// Something wrong at a line (from 1) of a text.
    pub(crate) fn at(line: usize, reason: impl Into<String>) -> Self {
        Self::Line { line, reason: reason.into() }
    }
}
