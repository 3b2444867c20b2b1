//! `cargo xtask tradeoff`: which solver for which budget.

use std::path::PathBuf;

use super::reproduce_figures::workspace;
use super::{CommandError, output, pool, scene};
use crate::figures::quoted;
use crate::figures::simulation::scenes::Scene;
use crate::report::{Progress, Report, RunInfo};
use crate::tradeoff::{self, Effort};

/// Measure error against time of every solver on a scene and say which to take
///
/// SCENE is a .ron or .json file, or the name of a ready-made scene: tablecloth,
/// armadillo, beam, curtain (none with collisions). For budgets of 1 to 33 ms: the most accurate setting that
/// is stable in a short animation, with the line of Rust that sets it. Some minutes.
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Args {
    /// A scene file, or the name of a ready-made scene
    #[arg(default_value = "tablecloth")]
    scene: PathBuf,
    /// Stability over 10 frames instead of 30
    #[arg(long)]
    quick: bool,
    /// Vertices of tablecloth or armadillo, about [default: 10000]
    #[arg(long, value_name = "N")]
    vertices: Option<usize>,
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

/// Measures, and prints where the report is.
pub fn run(args: Args) -> Result<(), CommandError> {
    let pool = pool(args.threads)?;
    let (scene, folder) = scene::load(&args.scene, args.vertices)?;
    let named =
        |error: &dyn std::fmt::Display| CommandError::Failed(format!("{}: {error}", args.scene.display()));
    if scene.collisions.is_some() {
        let words =
            "the answer that errors are measured against has no contacts; take `collisions` out of the scene";
        return Err(named(&words));
    }
    if scene.bodies.iter().any(|body| !body.drags.is_empty()) {
        let words = "the answer that errors are measured against holds still what it holds; take `drags` out of the scene";
        return Err(named(&words));
    }
    let scene = pool.install(|| Scene::build(&scene, &folder)).map_err(|e| named(&e))?;
    if scene.model.can_tear() {
        let words = "the answer that errors are measured against does not tear; take `tear` out of the scene";
        return Err(named(&words));
    }
    let mut command = format!("cargo xtask tradeoff {}", quoted(&args.scene));
    if args.quick {
        command += " --quick";
    }
    if let Some(n) = args.vertices {
        command += &format!(" --vertices {n}");
    }
    command += &format!(" --warm-frames {} --threads {}", args.warm_frames, pool.current_num_threads());
    let effort = if args.quick { Effort::quick() } else { Effort::normal() };
    let effort = Effort { warm_frames: args.warm_frames, ..effort };
    let info = RunInfo::new("Vivace: which solver for which budget", &command, 2016, &workspace());
    let out = args.out.unwrap_or_else(|| workspace().join("out/tradeoff"));
    let mut report = Report::create(&out, info)?;
    let mut progress = Progress::new();
    let figure = pool
        .install(|| tradeoff::make("tradeoff", &[scene], effort, &command, &mut progress))
        .map_err(|e| named(&e))?;
    drop(progress);
    report.add(figure)?;
    output::print_page(&report.finish()?)
}
