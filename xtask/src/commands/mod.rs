//! One file for each command: its arguments, and `run`.

pub mod bench_coloring;
pub mod bench_gpu;
pub mod bench_simulation;
pub mod color;
pub mod extremes;
pub mod fuzz;
pub mod inspect;
pub mod reproduce_figures;
pub mod simulate;
pub mod tradeoff;

mod input;
mod output;
mod scene;

use std::io;

use crate::report::ReportError;

/// As many threads as asked for, or as the machine has.
fn n_threads(wanted: Option<u32>) -> usize {
    let wanted = wanted.and_then(|n| usize::try_from(n).ok());
    wanted.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from))
}

/// A pool of so many threads.
fn pool(wanted: Option<u32>) -> Result<rayon::ThreadPool, CommandError> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads(wanted)).build();
    pool.map_err(|error| CommandError::Failed(error.to_string()))
}

/// Why a command ended without doing what it was asked to.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CommandError {
    /// The command line asks for something that cannot be; the message says what to write instead.
    #[error("{0}")]
    Usage(String),
    /// The command was understood and failed.
    #[error("{0}")]
    Failed(String),
    /// A report could not be written.
    #[error(transparent)]
    Report(#[from] ReportError),
    /// Whoever reads the output went away, or the disk is full.
    #[error("cannot write the output: {0}")]
    Output(io::Error),
}

impl CommandError {
    /// What the shell gets: 2 for a command line that cannot be, 1 for anything else.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Usage(_) => 2,
            _ => 1,
        }
    }

    /// Whether there is nobody left to tell: the reader of a pipe has seen enough.
    pub fn is_silent(&self) -> bool {
        matches!(self, Self::Output(error) if error.kind() == io::ErrorKind::BrokenPipe)
    }
}
