//! `cargo xtask bench-gpu`: the GPU, measured in one run.

use std::fmt::Write as _;
use std::path::PathBuf;

use super::reproduce_figures::workspace;
use super::{CommandError, output};
use crate::bench_gpu::{self, Options};
use crate::report::Progress;

/// Measure dispatches, copies, kernels, frames and colorings on the GPU
///
/// Prints the tables and writes them (CSV, JSON, one page) with adapter, machine,
/// commit and command. A software adapter is named as such: its times are those of
/// a CPU.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Graphs of up to 100K vertices, fewer runs
    #[arg(long)]
    quick: bool,
    /// Constraints of the cloths whose frames are timed, up to some 10M [default: 10K to 10M;
    /// on a software adapter to 1M]
    #[arg(long, value_name = "N", value_delimiter = ',', value_parser = clap::value_parser!(u32).range(8..=100_000_000))]
    constraints: Vec<u32>,
    /// Seed of the colorings
    #[arg(long, default_value_t = 2016, value_name = "S")]
    seed: u64,
    /// Folder of the tables [default: out/bench-gpu in the workspace]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Measures, prints and writes.
pub fn run(args: Args) -> Result<(), CommandError> {
    let quick = if args.quick { " --quick" } else { "" };
    let mut command = format!("cargo xtask bench-gpu{quick} --seed {}", args.seed);
    if !args.constraints.is_empty() {
        let constraints: Vec<String> = args.constraints.iter().map(u32::to_string).collect();
        let _ = write!(command, " --constraints {}", constraints.join(","));
    }
    let options = Options {
        most_vertices: if args.quick { 100_000 } else { usize::MAX },
        constraints: args.constraints.iter().map(|&n| n as usize).collect(),
        runs: if args.quick { 5 } else { 15 },
        seed: args.seed,
        out: args.out.unwrap_or_else(|| workspace().join("out/bench-gpu")),
        source: workspace(),
        command,
    };
    let mut progress = Progress::new();
    let finished =
        bench_gpu::run(&options, &mut progress).map_err(|error| CommandError::Failed(error.to_string()))?;
    drop(progress);
    let mut text = format!("{}\n\n", finished.adapter);
    finished.notes.iter().for_each(|note| output::field(&mut text, "note", note));
    for table in &finished.tables {
        let _ = writeln!(text, "{}\n\n{}", table.name, super::bench_coloring::aligned(table));
    }
    let _ = writeln!(text, "{}", finished.page.display());
    output::print(&text)
}
