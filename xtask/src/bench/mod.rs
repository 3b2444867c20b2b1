//! The colorings on the graphs of [`vivace_tests::workloads`], in one run, as ratios to serial first fit in natural order (SFF)
//! on one thread; and the bars that the project holds itself to.
//!
//! `runs.csv`, a row for each graph and task: `graph`, `vertices`, `edges`, `max_degree`, `task`, `threads`, `runs`, `ms`
//! (median), `ms_q1`, `ms_q3`, `ms_min`, `over_sff` (ratio of the medians), `over_sff_min` (of the minima), `colors`,
//! `colors_max`, `rounds`, `rounds_max`, `visits_per_vertex`, `largest_over_mean`, `smallest_over_mean` (medians; empty where
//! they mean nothing). `bars.csv`: `bar`, `limit`, `reached`, `met`, `where` (the graph that decided).

mod bars;
mod changes;
mod measure;
mod tables;

use std::path::PathBuf;

use vivace_tests::workloads::Workload;

use crate::figures::FigureError;
use crate::report::{Figure, Progress, Report, RunInfo, Table};

pub use measure::{GraphBench, Sample, Task, TaskBench};

/// What a run is asked for.
#[derive(Clone, Debug)]
pub struct Options {
    /// Vertices of the largest graph.
    pub most_vertices: usize,
    /// Time for the runs on one graph \[s\].
    pub seconds: f64,
    /// Runs of each task on one graph, at least and at most.
    pub runs: (u32, u32),
    /// Threads of what runs in parallel.
    pub n_threads: usize,
    /// Seed of colorings and changes.
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
    /// Ratios of each graph and task.
    pub ratios: Table,
    /// Bars, and whether they are met.
    pub bars: Table,
}

/// Measures everything.
///
/// # Errors
/// A coloring that is not proper; what cannot be written.
pub fn run(options: &Options, progress: &mut Progress) -> Result<Finished, FigureError> {
    let workloads: Vec<Workload> = Workload::up_to(options.most_vertices).collect();
    progress.figure("bench", 2 * workloads.len() as u64);
    let pools = measure::Pools::new(options.n_threads)?;
    let mut benches = Vec::new();
    for workload in workloads {
        progress.step(&format!("{}: made", workload.name));
        let graph = workload.shared();
        progress.step(&format!("{}: colored", workload.name));
        benches.push(measure::graph(options, &pools, &workload, graph)?);
    }
    let bars = bars::judge(&benches, options.n_threads);
    let ratios = tables::ratios(&benches, options.n_threads);
    let info = RunInfo::new("Vivace: colorings measured", &options.command, options.seed, &options.source)
        .option("Threads", options.n_threads)
        .paragraph("Ratios of medians to serial first fit in natural order (SFF) on one thread, on the same graph in the same run. All tasks took turns.");
    let mut figure = Figure::new(
        "bench",
        "Colorings on the CPU",
        &options.command,
        "All times of a graph were taken in turns. Reduction, balancing and recoloring start from a coloring made before and are timed alone. A change takes away half a percent of the edges and adds as many; the time to apply it to the graph is a row of its own.",
    )
    .table(bars.clone())
    .table(ratios.clone())
    .data(Table { name: "runs".to_owned(), ..tables::runs(&benches) })
    .data(Table { name: "bars".to_owned(), ..bars.clone() });
    figure.seconds = Some(progress.done());
    let mut report = Report::create(&options.out, info)?;
    report.add(figure)?;
    Ok(Finished { page: report.finish()?, ratios, bars })
}
