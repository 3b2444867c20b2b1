//! `cargo xtask tradeoff`: which solver for which budget.

use std::path::PathBuf;

use super::reproduce_figures::{n_threads, workspace};
use super::{CommandError, output};
use crate::figures::families::Families;
use crate::figures::simulation::scenes;
use crate::report::{Progress, Report, RunInfo};
use crate::tradeoff::{self, Effort};

/// Measure error against time of every solver on a scene and say which to take
///
/// For budgets of 1 to 33 ms: the most accurate setting that is stable in a short
/// animation, with the line of Rust that sets it. Some minutes.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The scene
    #[arg(value_enum, default_value = "tablecloth")]
    scene: SceneName,
    /// A smaller scene, and fewer frames
    #[arg(long)]
    quick: bool,
    /// Vertices of the scene, about [default: 10000, with --quick 900]
    #[arg(long, value_name = "N")]
    vertices: Option<u32>,
    /// Frames of a converged run before the frame that is measured
    #[arg(long, default_value_t = 10, value_name = "N")]
    warm_frames: u32,
    /// Folder of the report [default: out/tradeoff in the workspace]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Threads [default: all]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    threads: Option<u32>,
}

/// The scenes that are ready.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum SceneName {
    /// A cloth held at two corners
    Tablecloth,
    /// The stand-in of the armadillo, its feet held
    Armadillo,
}

/// Measures, and prints where the report is.
pub fn run(args: Args) -> Result<(), CommandError> {
    let n_threads = n_threads(args.threads);
    let failed = |error: &dyn std::fmt::Display| CommandError::Failed(error.to_string());
    let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().map_err(|e| failed(&e))?;
    let n = args.vertices.unwrap_or(if args.quick { 900 } else { 10_000 }) as usize;
    let name = format!("{:?}", args.scene).to_lowercase();
    let quick = if args.quick { " --quick" } else { "" };
    let warm_frames = args.warm_frames;
    let command = format!(
        "cargo xtask tradeoff {name}{quick} --vertices {n} --warm-frames {warm_frames} --threads {n_threads}"
    );
    let scene = match args.scene {
        SceneName::Tablecloth => scenes::tablecloth(n),
        SceneName::Armadillo => {
            Families::stand_ins(2016).and_then(|families| pool.install(|| scenes::armadillo(&families, n)))
        }
    };
    let scene = scene.map_err(|e| failed(&e))?;
    let effort = Effort { warm_frames, longest_ms: 40.0, stable_frames: if args.quick { 10 } else { 30 } };
    let info = RunInfo::new("Vivace: which solver for which budget", &command, 2016, &workspace());
    let out = args.out.unwrap_or_else(|| workspace().join("out/tradeoff"));
    let mut report = Report::create(&out, info)?;
    let mut progress = Progress::new();
    let figure =
        pool.install(|| tradeoff::make(&scene, effort, &command, &mut progress)).map_err(|e| failed(&e))?;
    drop(progress);
    report.add(figure)?;
    let page = report.finish()?;
    output::print(&format!("{}\n", page.canonicalize().unwrap_or(page).display()))
}
