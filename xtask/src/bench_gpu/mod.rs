//! The GPU, measured: what a dispatch costs, and every coloring on the graphs of [`vivace_tests::workloads`].
//!
//! `dispatches.csv`: `elements` (length of the list), `room` (the most it could hold), `grids` (who says how large the dispatch
//! is), `us` (median over runs of a thousand dispatches, per dispatch), `us_min`. `colorings.csv`, a row for each graph, algorithm
//! and `grids`: `graph`, `vertices`, `edges`, `algorithm`, `grids`, `runs`, `ms` (median; the graph lies on the device, and the
//! colors stay there), `ms_min`, `ms_with_copies` (median, from the host to the host), `rounds`, `colors`, `dispatches`, `looks`
//! (how often the host waited to see lengths), `us_per_dispatch`, `bytes` (allocated on the device).

mod measure;

use std::path::PathBuf;

use vivace_gpu::{Gpu, GpuError};
use vivace_tests::workloads::Workload;

use crate::figures::FigureError;
use crate::report::{Figure, Progress, Report, RunInfo, Table};

/// What a run is asked for.
#[derive(Clone, Debug)]
pub struct Options {
    /// Vertices of the largest graph.
    pub most_vertices: usize,
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
    /// Cost of a dispatch.
    pub dispatches: Table,
    /// Time of each coloring.
    pub colorings: Table,
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
    let adapter = adapter(&Gpu::new()?);
    let workloads: Vec<Workload> = Workload::up_to(options.most_vertices)
        .filter(|workload| measure::GRAPHS.contains(&workload.name))
        .collect();
    progress.figure("bench-gpu", 1 + workloads.len() as u64);
    progress.step("dispatches");
    let dispatches = measure::dispatches()?;
    let mut colorings = measure::colorings_table();
    for workload in workloads {
        progress.step(workload.name);
        measure::colorings(options, &workload, &mut colorings)?;
    }
    let caution =
        "Times of a software adapter are those of a CPU that plays a GPU: they say what works, not how fast.";
    let mut info = RunInfo::new("Vivace: the GPU measured", &options.command, options.seed, &options.source)
        .paragraph(&format!("Adapter: {adapter}. {caution}"));
    info.machine.adapters = vec![adapter.clone()];
    let mut figure = Figure::new(
        "gpu",
        &format!("Colorings on {adapter}"),
        &options.command,
        "Each coloring was checked. Times are of whole colorings: recording, running, and the waits in between.",
    )
    .table(dispatches.clone())
    .table(colorings.clone())
    .data(Table { name: "dispatches".to_owned(), ..dispatches.clone() })
    .data(Table { name: "colorings".to_owned(), ..colorings.clone() });
    figure.seconds = Some(progress.done());
    let mut report = Report::create(&options.out, info).map_err(FigureError::from)?;
    report.add(figure).map_err(FigureError::from)?;
    Ok(Finished { page: report.finish().map_err(FigureError::from)?, adapter, dispatches, colorings })
}
