//! The GPU, measured: what a dispatch costs, what a copy reaches and how long each kernel takes, and every coloring on the graphs of
//! [`vivace_tests::workloads`].
//!
//! `dispatches.csv`: `elements` (length of the list), `room` (the most it could hold), `grids` (who says how large the dispatch
//! is), `us` (median over runs of a thousand dispatches, per dispatch), `us_min`. `colorings.csv`, a row for each graph, algorithm
//! and `grids`: `graph`, `vertices`, `edges`, `algorithm`, `grids`, `runs`, `ms` (median; the graph lies on the device, and the
//! colors stay there), `ms_min`, `ms_with_copies` (median, from the host to the host), `rounds`, `colors`, `dispatches`, `looks`
//! (how often the host waited to see lengths), `us_per_dispatch`, `bytes` (allocated on the device). `copies.csv`: `bytes` of an
//! array, and the rate at which copies of it read and write, `gb_per_s` (best run) and `gb_per_s_median`. `kernels.csv`, by the
//! device's own clock, if it has one, while each dispatch has a pass of its own: `work`, `kernel`, `dispatches`, `us_per_dispatch`
//! (mean), `ms` (all of them), `share_of_time` (of all kernels of the work), `gb_per_s` (the bytes that a profile counts, see
//! [`vivace_gpu::KernelTime::bytes`], over time), `share_of_copy` (that over the best copy's rate; above 1 where caches help, and
//! where a list is much shorter than it could be). `frames.csv`, fused sweeps of Projective Dynamics, a row for each size of a cloth
//! of springs, and three for as many springs and hinges as the paper's heap of cloths has: `scene`, `constraints`, `particles`,
//! `recolored` (`no`, or who says how large the classes of each frame's own coloring are), `colors` (of which some classes may be
//! empty, if recolored), `bytes` (as known before the device is asked), `ms` (median of a frame, positions and velocities read
//! back), `ms_min`, `ms_resident` (median of a frame that stays on the device), `kernels_ms` (of all kernels of a frame, by the
//! device's clock), `dispatches` (of a frame), `us_per_dispatch` (of `ms_resident`), `updates_per_s` (particles times sweeps over
//! `ms_resident`), `note` (why the device refused it). The algorithm `vivace, unseen` of `colorings.csv` is the paper's in a fixed
//! number of rounds, of which nobody looks how many were needed.

mod frames;
mod kernels;
mod measure;

use std::path::PathBuf;

use frames::Case;
use vivace_gpu::{Gpu, GpuError};
use vivace_tests::workloads::Workload;

use crate::figures::FigureError;
use crate::report::{Figure, Progress, Report, RunInfo, Table, Value};

/// What a run is asked for.
#[derive(Clone, Debug)]
pub struct Options {
    /// Vertices of the largest graph.
    pub most_vertices: usize,
    /// Constraints of the cloths whose frames are timed; what the adapter does in a minute or two if there are none.
    pub constraints: Vec<usize>,
    /// Runs of each coloring.
    pub runs: u32,
    /// Seed of the first run.
    pub seed: u64,
    /// The folder for the tables.
    pub out: PathBuf,
    /// Folder of the source, for the commit.
    pub source: PathBuf,
    /// The command that repeats the run.
    pub command: String,
}

/// Where the report is and what it says.
pub struct Finished {
    /// The page.
    pub page: PathBuf,
    /// The adapter, in words.
    pub adapter: String,
    /// What is to be said about the numbers.
    pub notes: Vec<String>,
    /// Cost of a dispatch, rate of a copy, time by kernel, frames, time of each coloring.
    pub tables: Vec<Table>,
}

/// Why nothing was measured.
#[derive(Debug, thiserror::Error)]
pub enum BenchError {
    /// The device.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// A wrong coloring, or a report that cannot be written.
    #[error(transparent)]
    Figure(#[from] FigureError),
}

/// The adapter of a device, in words; a software one is called that.
pub fn adapter(gpu: &Gpu) -> String {
    let info = gpu.adapter();
    let kind = if gpu.is_software() { "SOFTWARE adapter, no GPU" } else { "GPU" };
    format!("{} ({:?}, {} {}; {kind})", info.name, info.backend, info.driver, info.driver_info)
}

/// Measures everything.
///
/// # Errors
/// No adapter; a device that fails; a coloring that is not proper; what cannot be written.
pub fn run(options: &Options, progress: &mut Progress) -> Result<Finished, BenchError> {
    let gpu = Gpu::new()?;
    let adapter = adapter(&gpu);
    let workloads: Vec<Workload> = Workload::up_to(options.most_vertices)
        .filter(|workload| measure::GRAPHS.contains(&workload.name))
        .collect();
    let sizes = sizes(options, &gpu);
    let of_sizes = sizes.into_iter().flat_map(|n| [Case::springs(n), Case::drape(n)]);
    let cases: Vec<Case> = of_sizes.chain(frames::heap()).chain(frames::DIRECT.map(Case::direct)).collect();
    progress.figure("bench-gpu", 2 + 2 * workloads.len() as u64 + cases.len() as u64);
    progress.step("dispatches");
    let dispatches = measure::dispatches()?;
    progress.step("copies");
    let copies = kernels::copies(&gpu)?;
    let mut by_kernel = kernels::table();
    for workload in &workloads {
        progress.step(&format!("kernels on {}", workload.name));
        kernels::coloring(&gpu, workload, options.seed, copies, &mut by_kernel)?;
    }
    gpu.trim();
    let mut frames = frames::table();
    for case in cases {
        progress.step(&format!("frames of {} constraints", Value::from(case.n_constraints).shown()));
        frames::frames(case, copies, &mut frames, &mut by_kernel)?;
    }
    let mut colorings = measure::colorings_table();
    for workload in workloads {
        progress.step(workload.name);
        measure::colorings(options, &workload, &mut colorings)?;
    }
    let tables = [
        ("dispatches", dispatches),
        ("copies", copies.table()),
        ("kernels", by_kernel),
        ("frames", frames),
        ("colorings", colorings),
    ];
    let notes = notes(&gpu);
    let mut info = RunInfo::new("Vivace: the GPU measured", &options.command, options.seed, &options.source)
        .paragraph(&format!("Adapter: {adapter}. {}", notes.join(" ")));
    info.machine.adapters = vec![adapter.clone()];
    let mut figure = Figure::new(
        "gpu",
        &format!("Kernels, frames and colorings on {adapter}"),
        &options.command,
        "Each coloring was checked. Times of colorings are of whole ones: recording, running, and the waits in between. Times of kernels are the device's own.",
    );
    for (file, table) in &tables {
        figure = figure.table(table.clone()).data(Table { name: (*file).to_owned(), ..table.clone() });
    }
    figure.seconds = Some(progress.done());
    let mut report = Report::create(&options.out, info).map_err(FigureError::from)?;
    report.add(figure).map_err(FigureError::from)?;
    let page = report.finish().map_err(FigureError::from)?;
    Ok(Finished { page, adapter, notes, tables: tables.map(|(_, table)| table).into() })
}

/// Constraints of the cloths. A software adapter does a million in some ten seconds.
fn sizes(options: &Options, gpu: &Gpu) -> Vec<usize> {
    const ALL: [usize; 6] = [10_000, 100_000, 300_000, 1_000_000, 3_000_000, 10_000_000];
    if !options.constraints.is_empty() {
        return options.constraints.clone();
    }
    let most = if gpu.is_software() { 1_000_000 } else { usize::MAX };
    ALL.into_iter().filter(|&n| n <= most.min(3 * options.most_vertices.min(usize::MAX / 3))).collect()
}

/// What whoever reads the numbers has to know about this device.
fn notes(gpu: &Gpu) -> Vec<String> {
    let software =
        "A CPU plays the GPU here: these times say what works, and are no claim of speed.".to_owned();
    let clock = "This device has no timestamp queries: kernels were not timed.".to_owned();
    let notes = [(gpu.is_software(), software), (!gpu.has_timestamps(), clock)];
    notes.into_iter().filter_map(|(is_so, note)| is_so.then_some(note)).collect()
}
