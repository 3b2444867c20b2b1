//! The one error type of this crate. Every message names the place and the remedy.

use std::io;
use std::path::PathBuf;

/// Why a graph was refused.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum GraphError {
    /// A constraint names a vertex that is not there.
    #[error(
        "constraint {constraint} of list {list} names vertex {vertex}, but there are {n_vertices} vertices (numbered from 0); \
         correct the constraint or raise the number of vertices"
    )]
    ConstraintOutOfRange {
        /// Which list of constraints, in the order given, from 0.
        list: usize,
        /// Index of the constraint in its list, from 0.
        constraint: usize,
        /// The vertex it names.
        vertex: u32,
        /// How many vertices there are.
        n_vertices: usize,
    },
    /// A row of neighbors names a vertex that is not there.
    #[error(
        "entry {entry} of row {row} is {vertex}, but there are {n_vertices} rows (numbered from 0); \
         correct the entry or add empty rows"
    )]
    NeighborOutOfRange {
        /// The row, from 0.
        row: usize,
        /// Position inside the row, from 0.
        entry: usize,
        /// The vertex it names.
        vertex: u32,
        /// How many vertices there are.
        n_vertices: usize,
    },
    /// Row offsets that do not delimit rows.
    #[error(
        "offset {index} is {found}, which {why}; offsets are 0, then the end of each row, the last one the number of items"
    )]
    Offsets {
        /// Index into the offsets.
        index: usize,
        /// What stands there.
        found: u64,
        /// What is wrong with it.
        why: &'static str,
    },
    /// More of something than 32-bit indices can number.
    #[error("{count} {what}: indices are 32-bit, so at most {limit} fit; split the problem")]
    TooLarge {
        /// What there is too much of.
        what: &'static str,
        /// How many there are.
        count: usize,
        /// How many may be.
        limit: usize,
    },
    /// A new numbering of the wrong length.
    #[error(
        "the numbering has {found} entries for {n_vertices} vertices; give one new number for each vertex"
    )]
    NumberingLength {
        /// Entries given.
        found: usize,
        /// How many vertices there are.
        n_vertices: usize,
    },
    /// A new numbering that is not one-to-one.
    #[error(
        "vertex {vertex} is given the number {number}, which is {why}; use each of 0..{n_vertices} exactly once"
    )]
    Numbering {
        /// The vertex.
        vertex: usize,
        /// The number given to it.
        number: u32,
        /// "taken already" or "out of range".
        why: &'static str,
        /// How many vertices there are.
        n_vertices: usize,
    },
    /// An edge from a vertex to itself.
    #[error("the edge [{vertex}, {vertex}] joins a vertex to itself; leave it out")]
    SelfLoop {
        /// The vertex.
        vertex: u32,
    },
    /// An edge with an end that is not there.
    #[error("the edge [{}, {}] leaves the {n_vertices} vertices (numbered from 0); correct it or make a larger graph", edge[0], edge[1])]
    EdgeOutOfRange {
        /// The edge.
        edge: [u32; 2],
        /// How many vertices there are.
        n_vertices: usize,
    },
    /// Text that is not a Matrix Market file this crate can use.
    #[error("line {line}: {reason}; {remedy}")]
    Parse {
        /// Line, from 1.
        line: usize,
        /// What is wrong.
        reason: String,
        /// What to do.
        remedy: &'static str,
    },
    /// A file that could not be read or written.
    #[error("cannot read {}: {kind}; check that the path names a readable file", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why not.
        kind: io::ErrorKind,
    },
    /// A file that was read but not understood.
    #[error("{}: {error}", path.display())]
    InFile {
        /// The file.
        path: PathBuf,
        /// What is wrong in it.
        error: Box<GraphError>,
    },
}
