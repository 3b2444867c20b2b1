//! `cargo xtask reproduce-figures`: the paper's figures, measured anew on this machine.

use std::path::{Path, PathBuf};

use super::{CommandError, n_threads, output};
use crate::figures::{self, Options, Sizes};
use crate::report::Progress;

/// Make the paper's figures anew and write a report
///
/// Without --quick or --full it takes an hour, by estimate, on two idle cores. The report is one page that
/// needs no other file, beside the figures (SVG, PNG) and the data (CSV, JSON).
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Small sizes: some 8 minutes on 2 cores
    #[arg(long, conflicts_with = "full")]
    quick: bool,
    /// Up to a million vertices
    #[arg(long)]
    full: bool,
    /// Make this figure alone; may be given more than once
    #[arg(long, value_name = "NAME", value_parser = figures::names())]
    figure: Vec<String>,
    /// Folder with your own bunny and armadillo: *.obj (closed surfaces) and *.vtk
    /// (tetrahedra), found by name; generated stand-ins otherwise
    #[arg(long, value_name = "DIR")]
    meshes: Option<PathBuf>,
    /// Folder of the report [default: out/figures in the workspace]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Seed of meshes and colorings
    #[arg(long, default_value_t = 2016, value_name = "S")]
    seed: u64,
    /// Add the GPU's curves to figures 2 to 5; the adapter is named
    #[arg(long, value_enum, default_value = "cpu")]
    backend: Backend,
    /// Threads that color [default: all]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    threads: Option<u32>,
}

/// What is measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Backend {
    /// The CPU.
    Cpu,
    /// The CPU and the GPU.
    Gpu,
}

/// Makes the figures and prints where the report is.
pub fn run(args: Args) -> Result<(), CommandError> {
    let sizes = match (args.quick, args.full) {
        (true, _) => Sizes::quick(),
        (_, true) => Sizes::full(),
        _ => Sizes::normal(),
    };
    let options = Options {
        sizes,
        figures: args.figure,
        meshes: args.meshes,
        out: args.out.unwrap_or_else(|| workspace().join("out/figures")),
        seed: args.seed,
        n_threads: n_threads(args.threads),
        with_gpu: args.backend == Backend::Gpu,
        source: workspace(),
    };
    let mut progress = Progress::new();
    let page = figures::reproduce(&options, &mut progress)
        .map_err(|error| CommandError::Failed(error.to_string()))?;
    drop(progress);
    output::print_page(&page)
}

/// The folder of the workspace that this program was built from.
pub(super) fn workspace() -> PathBuf {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    package.parent().unwrap_or(package).to_owned()
}
