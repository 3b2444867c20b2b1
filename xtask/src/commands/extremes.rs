//! `cargo xtask extremes`: what each method survives.

use std::path::PathBuf;

use super::reproduce_figures::workspace;
use super::{CommandError, output, pool};
use crate::extremes;
use crate::report::{Report, RunInfo};

/// Take small scenes to their ends with every method and write what survives
///
/// Time step, stiffness, mass ratio, iterations, omega, anchors, bad starts,
/// slivers, far from the origin, not a number. A minute or so.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// One case of each kind
    #[arg(long)]
    quick: bool,
    /// Folder of the report [default: out/extremes in the workspace]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Threads [default: all]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    threads: Option<u32>,
}

/// Plays all cases and prints where the report is.
pub fn run(args: Args) -> Result<(), CommandError> {
    let pool = pool(args.threads)?;
    let quick = if args.quick { " --quick" } else { "" };
    let command = format!("cargo xtask extremes{quick} --threads {}", pool.current_num_threads());
    let info = RunInfo::new("Vivace: extremes", &command, 0, &workspace());
    let out = args.out.unwrap_or_else(|| workspace().join("out/extremes"));
    let mut report = Report::create(&out, info)?;
    let figure = pool
        .install(|| extremes::make(&command, args.quick))
        .map_err(|error| CommandError::Failed(error.to_string()))?;
    report.add(figure)?;
    output::print_page(&report.finish()?)
}
