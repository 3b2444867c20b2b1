//! `cargo xtask simulate`: runs a scene; meshes, measures and pictures to a folder.

mod frames;

use std::path::{Path, PathBuf};
use std::time::Instant;

use vivace_sim::{Budget, SimError, Simulation, Snapshot, Solver, StepReport, Stop, TearReport};

use super::{CommandError, output, scene};
use crate::picture::Stage;
use crate::report::Progress;
use crate::strain::Strain;
use frames::{Album, Format};

/// Run a scene: meshes, measures and pictures to a folder
///
/// SCENE is a .ron or .json file, or the name of a ready-made scene: tablecloth,
/// armadillo, beam, curtain, drape, flag, noodles, heap, stack, pinch (their files are in
/// assets/scenes). DIR gets frames.csv, a row for each frame, a mesh of the start and of every
/// Mth frame, and one of each obstacle where it stands, or has moved to. Under --iterations the
/// result is the same on every run and any number of threads.
#[derive(Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Args {
    /// A scene file, or the name of a ready-made scene
    scene: PathBuf,
    /// A ready-made scene of about so many vertices, instead of its own size
    #[arg(long, value_name = "N")]
    vertices: Option<usize>,
    /// How many frames to simulate
    #[arg(long, value_name = "N", default_value_t = 60)]
    frames: u64,
    /// Folder of the results [default: out/simulate in the workspace]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Time for each frame [ms], instead of a number of iterations
    #[arg(long, value_name = "X", conflicts_with = "iterations")]
    budget_ms: Option<f64>,
    /// Iterations for each frame
    #[arg(long, value_name = "K", default_value_t = 20)]
    iterations: u32,
    /// The solver: a .ron or .json file, or JSON like '{"substeps": 4}'
    #[arg(long, value_name = "SOLVER")]
    solver: Option<String>,
    /// Form of the meshes; vtk has the tetrahedra, obj the surface
    #[arg(long, value_enum, default_value_t = Format::Obj)]
    format: Format,
    /// Write every Mth frame
    #[arg(long, value_name = "M", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..))]
    every: u64,
    /// Write a picture (PNG) of every Mth frame
    #[arg(long)]
    pictures: bool,
    /// Write an animation (animation.png, in APNG form) of every Mth frame
    #[arg(long)]
    animation: bool,
    /// Measure objective and residual of each frame, beyond its budget
    #[arg(long)]
    measure: bool,
    /// Keep the end as JSON, for --resume
    #[arg(long, value_name = "FILE")]
    snapshot: Option<PathBuf>,
    /// Go on from a file that --snapshot wrote, in the same scene
    #[arg(long, value_name = "FILE")]
    resume: Option<PathBuf>,
    /// Say nothing
    #[arg(long)]
    quiet: bool,
}

const COLUMNS: [&str; 24] = [
    "frame",
    "time_s",
    "iterations",
    "colors",
    "objective",
    "residual_n",
    "last_move_m",
    "backoffs",
    "solve_ms",
    "total_ms",
    "mean_strain",
    "max_strain",
    "particles",
    "torn_corners",
    "tear_ms",
    "stop",
    "detect_ms",
    "color_ms",
    "guard_ms",
    "contacts",
    "contact_colors",
    "left_out",
    "held_back",
    "deepest_m",
];

/// Reads, simulates, writes.
///
/// # Errors
/// A scene, solver or snapshot that is refused; a step that diverges; a file that cannot be written.
pub fn run(args: Args) -> Result<(), CommandError> {
    let mut progress = if args.quiet { Progress::silent() } else { Progress::new() };
    let solver = args.solver.as_deref().map_or_else(|| Ok(Solver::default()), solver)?;
    let (scene, folder) = scene::load(&args.scene, args.vertices)?;
    let mut simulation =
        Simulation::new_in(&scene, &folder, solver).map_err(|error| failed(&args.scene, &error))?;
    simulation.set_measuring(args.measure);
    let mut strain = Strain::at_rest(simulation.model(), simulation.positions());
    if let Some(path) = &args.resume {
        let text = std::fs::read_to_string(path).map_err(|error| {
            CommandError::Failed(format!(
                "cannot read {}: {error}; give --resume a file that --snapshot wrote",
                path.display()
            ))
        })?;
        let restored = Snapshot::from_json(&text).and_then(|snapshot| simulation.restore(&snapshot));
        restored.map_err(|error| failed(path, &error))?;
        strain = strain.torn(simulation.model());
    }
    let budget = match args.budget_ms {
        Some(ms) => Budget::milliseconds(ms),
        None => Budget::iterations(args.iterations),
    };
    budget.check().map_err(|error| CommandError::Usage(error.to_string()))?;

    let out = args.out.clone().unwrap_or_else(|| super::reproduce_figures::workspace().join("out/simulate"));
    std::fs::create_dir_all(&out).map_err(|error| cannot_write(&out, &error))?;
    let stage = Stage::new(&scene, &folder, simulation.model(), simulation.positions());
    let stage = stage.map_err(|error| failed(&args.scene, &error.into()))?;
    let mut album = Album::new(&out, args.format, args.pictures, args.animation, stage);
    let path = out.join("frames.csv");
    let csv_failed = |error: csv::Error| cannot_write(&out.join("frames.csv"), &error);
    let mut table = csv::Writer::from_path(&path).map_err(csv_failed)?;
    table.write_record(COLUMNS).map_err(csv_failed)?;

    // A line for each frame would be too many where there is no bar.
    let stride = args.frames.div_ceil(50).max(1);
    let name = if scene.name.is_empty() { "simulate" } else { &scene.name };
    progress.figure(name, args.frames.div_ceil(stride));
    album.add(&simulation)?;
    for done in 0..args.frames {
        let frame = simulation.frame() + 1;
        if done % stride == 0 {
            progress.step(&format!("frame {frame}"));
        }
        let start = Instant::now();
        let report = simulation.step(budget).map_err(|error| {
            CommandError::Failed(format!(
                "frame {frame}: {error}. {} holds the frames before",
                path.display()
            ))
        })?;
        let total = start.elapsed().as_secs_f64();
        if report.tears != TearReport::default() {
            strain = strain.torn(simulation.model());
        }
        let row = row(&simulation, &report, total, strain.measure(simulation.positions()));
        table.write_record(row).map_err(csv_failed)?;
        if (done + 1) % args.every == 0 {
            album.add(&simulation)?;
        }
    }
    table.flush().map_err(|error| cannot_write(&path, &error))?;
    album.finish(&simulation, args.every, &mut progress)?;
    if let Some(path) = &args.snapshot {
        let text = simulation.snapshot().to_json().map_err(|error| failed(path, &error))?;
        std::fs::write(path, text).map_err(|error| cannot_write(path, &error))?;
    }
    progress.done();
    drop(progress);
    if args.quiet { Ok(()) } else { output::print(&format!("{}\n", path.display())) }
}

fn row(simulation: &Simulation, report: &StepReport, total: f64, [mean, max]: [f64; 2]) -> [String; 24] {
    let stop = match report.stop {
        Stop::Iterations => "iterations",
        Stop::Time => "time",
        Stop::Tolerance => "tolerance",
    };
    let contacts = &report.contacts;
    // What was not measured stays empty.
    let number = |value: f64| if value.is_nan() { String::new() } else { format!("{value}") };
    let measured = |value: Option<f64>| value.map_or_else(String::new, number);
    [
        simulation.frame().to_string(),
        number(simulation.time()),
        report.iterations.to_string(),
        report.colors.to_string(),
        measured(report.objective),
        measured(report.residual),
        measured(report.last_move.map(f64::from)),
        report.backoffs.to_string(),
        number(report.times.solve * 1e3),
        number(total * 1e3),
        number(mean),
        number(max),
        simulation.positions().len().to_string(),
        report.tears.triangles.to_string(),
        number(report.times.tear * 1e3),
        stop.to_owned(),
        number(report.times.detect * 1e3),
        number(report.times.color * 1e3),
        number(report.times.guard * 1e3),
        contacts.contacts.to_string(),
        contacts.colors.to_string(),
        contacts.left_out.to_string(),
        contacts.held_back.to_string(),
        contacts.deepest.to_string(),
    ]
}

/// A solver from a file or from the argument itself.
fn solver(argument: &str) -> Result<Solver, CommandError> {
    let text = argument.trim();
    let refused = |reason: String| {
        CommandError::Usage(format!(
            "--solver {text}: {reason}; give a .ron or .json file, or JSON like '{{\"substeps\": 4}}'"
        ))
    };
    if text.starts_with('{') {
        return serde_json::from_str(text).map_err(|error| refused(error.to_string()));
    }
    let content = std::fs::read_to_string(text).map_err(|error| refused(error.to_string()))?;
    if Path::new(text).extension().is_some_and(|extension| extension.eq_ignore_ascii_case("ron")) {
        ron::from_str(&content).map_err(|error| refused(error.to_string()))
    } else {
        serde_json::from_str(&content).map_err(|error| refused(error.to_string()))
    }
}

fn failed(path: &Path, error: &SimError) -> CommandError {
    CommandError::Failed(format!("{}: {error}", path.display()))
}

fn cannot_write(path: &Path, error: &dyn std::fmt::Display) -> CommandError {
    CommandError::Failed(format!(
        "cannot write {}: {error}; is the folder writable, and is there space left?",
        path.display()
    ))
}
