//! The runs.

use std::collections::HashSet;
use std::time::Instant;

use vivace_coloring::{Algorithm, Certificate, ColorOnError, GraphBuffers, GraphView, Vivace, vivace_unseen};
use vivace_gpu::{Gpu, Grids};
use vivace_kernels::Backend;
use vivace_kernels::coloring::{IsColored, SetValue, SetValueUniform, UNCOLORED};
use vivace_tests::workloads::Workload;

use super::{BenchError, Options};
use crate::figures::FigureError;
use crate::report::{Table, quantile};

/// The graphs that are colored: regular, irregular and volumetric, and one that contacts have spoiled.
pub(super) const GRAPHS: [&str; 10] = [
    "cloth-10k",
    "hinge-cloth-10k",
    "tets-10k",
    "cloth-100k",
    "hinge-cloth-100k",
    "tets-100k",
    "cloth-contacts-100k",
    "cloth-1m",
    "hinge-cloth-1m",
    "tets-1m",
];

const GRIDS: [Grids; 2] = [Grids::Indirect, Grids::Bounds];

pub(super) fn name(grids: Grids) -> &'static str {
    match grids {
        Grids::Indirect => "indirect",
        Grids::Bounds => "bounds",
    }
}

fn ms(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e3
}

fn sorted(mut values: Vec<f64>) -> Vec<f64> {
    values.sort_by(f64::total_cmp);
    values
}

/// What a small kernel costs over lists that are empty, full, and much shorter than they could be.
pub(super) fn dispatches() -> Result<Table, BenchError> {
    const N_DISPATCHES: u32 = 1000;
    let mut table = Table::new("Cost of a dispatch", &["elements", "room", "grids", "us", "us_min"]);
    for (len, room) in [
        (0_usize, 256_usize),
        (256, 256),
        (0, 100_000),
        (100_000, 100_000),
        (0, 1_000_000),
        (1_000_000, 1_000_000),
    ] {
        for grids in GRIDS {
            let gpu = Gpu::new()?.with_grids(grids);
            let mut own = gpu.filled(room, UNCOLORED);
            let mut list = gpu.all(room);
            // All or none are uncolored.
            if len == 0 {
                gpu.map::<SetValue>(&list, &SetValueUniform { value: 0 }, (), &mut own);
            }
            gpu.select::<IsColored>(&mut list, &(), (), &mut own);
            gpu.wait()?;
            let n_runs = if room > 1000 { 5 } else { 21 };
            let mut us = Vec::new();
            for _ in 0..n_runs {
                let start = Instant::now();
                for value in 0..N_DISPATCHES {
                    gpu.map::<SetValue>(&list, &SetValueUniform { value }, (), &mut own);
                }
                gpu.wait()?;
                us.push(ms(start) * 1e3 / f64::from(N_DISPATCHES));
            }
            let us = sorted(us);
            table.push(vec![
                len.into(),
                room.into(),
                name(grids).into(),
                quantile(&us, 0.5).into(),
                quantile(&us, 0.0).into(),
            ]);
        }
    }
    Ok(table)
}

/// The columns of [`colorings`].
pub(super) fn colorings_table() -> Table {
    Table::new(
        "Colorings",
        &[
            "graph",
            "vertices",
            "edges",
            "algorithm",
            "grids",
            "runs",
            "ms",
            "ms_min",
            "ms_with_copies",
            "rounds",
            "colors",
            "dispatches",
            "looks",
            "us_per_dispatch",
            "bytes",
        ],
    )
}

/// Adds a row for each algorithm that runs in rounds.
pub(super) fn colorings(options: &Options, workload: &Workload, table: &mut Table) -> Result<(), BenchError> {
    let graph = workload.shared();
    for algorithm in Algorithm::ALL.into_iter().filter(Algorithm::is_seeded) {
        for grids in GRIDS {
            let gpu = Gpu::new()?.with_grids(grids);
            let csr = graph.csr();
            let (offsets, neighbors) = (gpu.upload(csr.offsets()), gpu.upload(csr.items()));
            let view = GraphView::<vivace_gpu::GpuMemory> {
                offsets: &offsets,
                neighbors: &neighbors,
                n_vertices: graph.n_vertices(),
                n_neighbors: csr.len(),
            };
            let (mut resident, mut copied, mut counts) = (Vec::new(), Vec::new(), Vec::new());
            // The first run makes pipelines and buffers.
            for idx in 0..=u64::from(options.runs) {
                let algorithm = algorithm.with_seed(options.seed + idx);
                let (dispatches, looks) = (gpu.n_dispatches(), gpu.n_looks());
                let start = Instant::now();
                drop(algorithm.run(&gpu, view));
                gpu.wait()?;
                let resident_ms = ms(start);
                let (dispatches, looks) = (gpu.n_dispatches() - dispatches, gpu.n_looks() - looks);
                let start = Instant::now();
                let outcome = match algorithm.color_on(&gpu, graph) {
                    Ok(outcome) => outcome,
                    Err(ColorOnError::Backend(error)) => return Err(error.into()),
                    Err(ColorOnError::NotInRounds(_)) => return Ok(()),
                };
                if idx > 0 {
                    copied.push(ms(start));
                    resident.push(resident_ms);
                    counts.push((dispatches, looks, outcome.rounds, outcome.coloring.n_colors()));
                }
                Certificate::check(graph, outcome.coloring.colors()).map_err(|violation| {
                    FigureError::Coloring { method: algorithm.name().to_owned(), violation }
                })?;
            }
            let (resident, copied) = (sorted(resident), sorted(copied));
            let median = |of: fn(&(u64, u64, u32, u32)) -> f64| {
                quantile(&sorted(counts.iter().map(of).collect()), 0.5)
            };
            let dispatches = median(|counts| counts.0 as f64);
            table.push(vec![
                workload.name.into(),
                graph.n_vertices().into(),
                graph.n_edges().into(),
                algorithm.name().into(),
                name(grids).into(),
                options.runs.into(),
                quantile(&resident, 0.5).into(),
                quantile(&resident, 0.0).into(),
                quantile(&copied, 0.5).into(),
                median(|counts| f64::from(counts.2)).into(),
                median(|counts| f64::from(counts.3)).into(),
                dispatches.into(),
                median(|counts| counts.1 as f64).into(),
                (quantile(&resident, 0.5) * 1e3 / dispatches).into(),
                (gpu.allocated() as f64).into(),
            ]);
        }
    }
    unseen(options, workload, table)
}

/// Rounds of a coloring that nobody looks at, as in frames that are colored anew.
const N_UNSEEN: u32 = 20;

/// Adds a row for the paper's coloring in rounds that nobody looks at.
fn unseen(options: &Options, workload: &Workload, table: &mut Table) -> Result<(), BenchError> {
    let (gpu, graph) = (Gpu::new()?, workload.shared());
    let n = graph.n_vertices();
    let on_device = GraphBuffers::upload(&gpu, graph);
    let (mut proposal, mut color) = (gpu.filled(n, 0), gpu.filled(n, 0));
    let (mut times, mut copied, mut n_colors) = (Vec::new(), Vec::new(), Vec::new());
    let mut dispatches = 0;
    for idx in 0..=u64::from(options.runs) {
        let vivace = Vivace { seed: options.seed + idx, ..Vivace::DEFAULT };
        let before = gpu.n_dispatches();
        let start = Instant::now();
        vivace_unseen(&gpu, on_device.view(&gpu), &vivace, N_UNSEEN, &mut proposal, &mut color);
        gpu.wait()?;
        let resident = ms(start);
        dispatches = gpu.n_dispatches() - before;
        let colors = gpu.read_back(&color)?.wait()?;
        if idx > 0 {
            times.push(resident);
            copied.push(ms(start));
        }
        Certificate::check(graph, &colors)
            .map_err(|violation| FigureError::Coloring { method: "vivace, unseen".to_owned(), violation })?;
        n_colors.push(colors.into_iter().collect::<HashSet<u32>>().len() as f64);
    }
    let [times, copied, n_colors] = [times, copied, n_colors].map(sorted);
    table.push(vec![
        workload.name.into(),
        n.into(),
        graph.n_edges().into(),
        "vivace, unseen".into(),
        "ranges".into(),
        options.runs.into(),
        quantile(&times, 0.5).into(),
        quantile(&times, 0.0).into(),
        quantile(&copied, 0.5).into(),
        N_UNSEEN.into(),
        quantile(&n_colors, 0.5).into(),
        (dispatches as f64).into(),
        0_u32.into(),
        (quantile(&times, 0.5) * 1e3 / dispatches as f64).into(),
        (gpu.allocated() as f64).into(),
    ]);
    Ok(())
}
