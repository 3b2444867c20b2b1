//! `cargo xtask bench-simulation`: the bars of the solvers, measured in one run.

use std::fmt::Write as _;
use std::path::PathBuf;

use super::reproduce_figures::workspace;
use super::{CommandError, output};
use crate::bench_simulation::{self, Options, Sizes, WITH_RAPIER};
use crate::report::Progress;

/// Measure all solvers as ratios to a plain Gauss-Seidel sweep, and print the bars
///
/// It takes several minutes. Prints which bars are met and writes the tables (CSV,
/// JSON, one page) with machine, commit and command. The exit code does not depend
/// on the bars: times belong to a machine. Built with `--features rapier` it runs
/// rapier3d's soft bodies too.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// No scene of a million vertices, fewer runs
    #[arg(long)]
    quick: bool,
    /// Threads of what runs in parallel
    #[arg(long, default_value_t = 2, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    threads: u32,
    /// Folder of the tables [default: out/bench-simulation in the workspace]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Measures, prints and writes.
pub fn run(args: Args) -> Result<(), CommandError> {
    let quick = if args.quick { " --quick" } else { "" };
    let cargo = if cfg!(feature = "rapier") { WITH_RAPIER } else { "cargo xtask" };
    let options = Options {
        sizes: if args.quick { Sizes::quick() } else { Sizes::full() },
        n_threads: usize::try_from(args.threads).unwrap_or(1),
        out: args.out.unwrap_or_else(|| workspace().join("out/bench-simulation")),
        source: workspace(),
        command: format!("{cargo} bench-simulation{quick} --threads {}", args.threads),
    };
    let mut progress = Progress::new();
    let finished = bench_simulation::run(&options, &mut progress)
        .map_err(|error| CommandError::Failed(error.to_string()))?;
    drop(progress);
    let mut text = String::new();
    for table in [&finished.times, &finished.winners, &finished.animation, &finished.drapes, &finished.bars] {
        let _ = writeln!(text, "{}\n\n{}", table.name, super::bench_coloring::aligned(table));
    }
    let _ = writeln!(text, "{}", finished.page.display());
    output::print(&text)
}
