//! `cargo verify`: everything that a change must pass, in the order that fails soonest.
//!
//! A package of its own that needs next to nothing, so that formatting is checked before anything large is built, and what only
//! `cargo xtask` needs is never built for release here.

mod setup;
mod steps;
mod vulkan;

use std::io::{self, Write as _};
use std::process::ExitCode;

use clap::Parser;

/// Run formatting, lints, documentation and all tests; stop at the first failure.
#[derive(Parser)]
#[command(name = "verify", bin_name = "cargo verify", max_term_width = 80, verbatim_doc_comment)]
struct Args {
    /// Install the software Vulkan driver with the system's package manager where
    /// there is none and it may.
    #[arg(long, verbatim_doc_comment)]
    setup: bool,
}

/// Why it ended without all passed.
#[derive(Debug, thiserror::Error)]
enum Error {
    /// A step or the installation failed.
    #[error("{0}")]
    Failed(String),
    /// Whoever reads the output went away, or the disk is full.
    #[error("cannot write the output: {0}")]
    Output(#[from] io::Error),
}

fn main() -> ExitCode {
    match steps::run(Args::parse().setup) {
        Ok(()) => ExitCode::SUCCESS,
        // The reader of a pipe has seen enough: there is nobody left to tell.
        Err(Error::Output(error)) if error.kind() == io::ErrorKind::BrokenPipe => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Writes to standard output, at once.
fn print(text: &str) -> Result<(), Error> {
    let mut stdout = io::stdout().lock();
    Ok(stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush())?)
}
