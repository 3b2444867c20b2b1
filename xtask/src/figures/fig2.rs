//! Figure 2: adjacency matrices before and after coloring.
//!
//! `fig2.csv`, a row for each run: `family`, `source` (file or generator), `vertices`, `edges`, `max_degree`, `elements`
//! (triangles or tetrahedra), `method`, `seed`, `threads` (empty on a GPU), `device` (`cpu`, or the adapter's name), `time_ms` (to
//! complete one coloring), `colors`, `rounds` (empty for a method without), `visits_per_vertex`, `largest_over_mean` and
//! `smallest_over_mean` (class sizes), `stragglers` (vertices colored one by one after the bound on rounds), `at_limit` (vertices
//! with the last of the degree + 1 colors they may have).

use super::families::{Family, Model};
use super::measure::{Devices, Effort, Measured, Method, Run, measure};
use super::{Context, FigureError, device};
use crate::report::{Cell, Figure, PictureGrid, Table, Value, Verdict, spy};

/// Runs of each coloring, as in the paper.
const RUNS: u32 = 30;

/// Columns of `fig2.csv`, which `fig3.csv` begins with, too.
pub(super) const COLUMNS: [&str; 18] = [
    "family",
    "source",
    "vertices",
    "edges",
    "max_degree",
    "elements",
    "method",
    "seed",
    "threads",
    "device",
    "time_ms",
    "colors",
    "rounds",
    "visits_per_vertex",
    "largest_over_mean",
    "smallest_over_mean",
    "stragglers",
    "at_limit",
];

/// A run under [`COLUMNS`].
pub(super) fn row(
    family: Family,
    model: &Model,
    method: &Method,
    devices: Devices<'_>,
    run: &Run,
) -> Vec<Value> {
    let in_rounds = method.is_in_rounds();
    vec![
        family.id().into(),
        model.source.as_str().into(),
        model.graph.n_vertices().into(),
        model.graph.n_edges().into(),
        model.graph.max_degree().into(),
        model.n_elements.into(),
        method.algorithm.name().into(),
        in_rounds.then_some(run.seed).map(|seed| seed.to_string()).into(),
        devices.n_threads(method).into(),
        devices.name(method).into(),
        run.ms.into(),
        run.colors.into(),
        in_rounds.then_some(run.rounds).into(),
        in_rounds.then_some(run.visits).into(),
        run.shares.largest.into(),
        run.shares.smallest.into(),
        run.stragglers.into(),
        run.at_limit.into(),
    ]
}

/// Makes the figure.
///
/// # Errors
/// What meshes, colorings and pictures run into.
pub fn make(context: &mut Context<'_>, command: &str) -> Result<Figure, FigureError> {
    context.progress.figure("fig2", 1 + 2 * Family::ALL.len() as u64);
    context.progress.step(&format!("meshes of about {} vertices", context.sizes.fig2));
    let models = context.pool.install(|| context.families.models(context.sizes.fig2))?;

    let mut columns = vec!["Unordered"];
    columns.extend(Method::PAPER.map(|method| method.name));
    let mut grid = PictureGrid::new("Adjacency matrices before and after coloring", &columns)
        .cell_width(190.0)
        .note("Gray: nonzeros under a pixel, on a logarithmic scale of its own for each matrix. Vertices sorted by color, within a color in the order of the mesh.")
        .note("Blue: the blocks on the diagonal, each an independent set, which hold the diagonal alone. Orange: the bounds between colors.")
        .note(&format!("Over {RUNS} runs, each with a seed of its own. Colors: the most frequent number, and the range. Time: mean, and median with quartiles."));
    let mut runs = Table::new("", &COLUMNS);
    let mut summary = Table::new(
        &format!("Over {RUNS} seeds"),
        &[
            "Graph",
            "Method",
            "Colors",
            "Mean \u{b1} s.d. [ms]",
            "Median (quartiles) [ms]",
            "Rounds",
            "Largest class / mean",
        ],
    );
    for (family, model) in Family::ALL.into_iter().zip(&models) {
        let name = context.families.name(family);
        context.progress.step(&format!("{name}: {RUNS} runs of each coloring"));
        let effort = Effort { most: RUNS, fewest: RUNS, seconds: f64::INFINITY, balance: false };
        let devices = Devices { pool: context.pool, gpu: context.gpu };
        let methods = devices.methods(&Method::PAPER);
        let measured = measure(devices, &model.graph, &methods, effort, context.seed)?;
        let (on_cpu, on_gpu) = measured.split_at(Method::PAPER.len());
        context.progress.step(&format!("{name}: pictures"));
        let n = model.graph.n_vertices();
        let mut cells = vec![unordered(model)?];
        for (idx, m) in on_cpu.iter().enumerate() {
            cells.push(ordered(model, m, on_gpu.get(idx))?);
        }
        for m in &measured {
            for run in &m.runs {
                runs.push(row(family, model, &m.method, devices, run));
            }
            summary.push(summary_row(name, m));
        }
        let label = format!("{} vertices", Value::from(n).shown());
        grid = grid.row((name, &label), cells);
    }
    let checked = Value::from(runs.rows.len()).shown();
    let caption = format!(
        "Constraint graphs as adjacency matrices. Leftmost: the order of the mesh. Others: vertices sorted by color, as each algorithm colored them with the first seed. Under each: colors and time to complete on this CPU ({}), over {RUNS} runs.\n\n{}\n\n{}",
        context.machine,
        device::sentence(context.gpu),
        context.families.caption(),
    );
    let mut figure = Figure::new("fig2", "Figure 2: adjacency matrices", command, &caption)
        .grid(grid)
        .table(summary)
        .data(runs)
        .claim(
            "All the unknowns belonging to the same color can be solved simultaneously in parallel (Sec. 4.2).",
            &format!("Any machine: the certificate of each of {checked} colorings was checked, edge by edge; no edge joins two vertices of one color."),
            Verdict::Held,
        )
        .option("runs", RUNS);
    figure.seconds = Some(context.progress.done());
    Ok(figure)
}

fn unordered(model: &Model) -> Result<Cell, FigureError> {
    let graph = &model.graph;
    let lines = [
        format!("{} edges", Value::from(graph.n_edges()).shown()),
        format!("degree {} to {}", graph.min_degree(), graph.max_degree()),
    ];
    Ok(spy(graph.n_vertices(), nonzeros(model, |v| v as usize), &[], &lines)?)
}

/// The matrix as a method sorts it; `on_gpu` is the same method there, whose colors are the same.
fn ordered(model: &Model, measured: &Measured, on_gpu: Option<&Measured>) -> Result<Cell, FigureError> {
    let partitions = measured.first.partitions();
    let mut place = vec![0; model.graph.n_vertices()];
    for (idx, &v) in partitions.csr().items().iter().enumerate() {
        place[v as usize] = idx;
    }
    let sizes: Vec<usize> = partitions.csr().rows().map(<[u32]>::len).collect();
    let time = |run: &Run| run.ms;
    let mut lines = vec![
        format!("{} colors", colors(measured)),
        format!("mean {} ms", digits(measured.mean(time))),
        format!("median {} ({}) ms", digits(measured.median(time)), quartiles(measured)),
    ];
    lines.extend(
        on_gpu.map(|gpu| format!("GPU: median {} ({}) ms", digits(gpu.median(time)), quartiles(gpu))),
    );
    Ok(spy(model.graph.n_vertices(), nonzeros(model, |v| place[v as usize]), &sizes, &lines)?)
}

/// Y's nonzeros: each edge twice, and the diagonal.
fn nonzeros(model: &Model, place: impl Fn(u32) -> usize) -> impl Iterator<Item = (usize, usize)> {
    let diagonal = (0..model.graph.n_vertices()).map(|v| (v, v));
    let edges = model.graph.edges().map(move |[u, v]| (place(u), place(v)));
    diagonal.chain(edges.flat_map(|(u, v)| [(u, v), (v, u)]))
}

/// The most frequent number of colors and, where they differ, the range.
fn colors(measured: &Measured) -> String {
    let mut counts: Vec<u32> = measured.runs.iter().map(|run| run.colors).collect();
    counts.sort_unstable();
    let times = |c: u32| counts.iter().filter(|&&other| other == c).count();
    let Some(mode) = counts.iter().copied().max_by_key(|&c| (times(c), std::cmp::Reverse(c))) else {
        return "no".to_owned();
    };
    let (few, many) = (counts[0], counts[counts.len() - 1]);
    if few == many { mode.to_string() } else { format!("{mode} ({few}\u{2013}{many})") }
}

/// A median of whole numbers without needless digits.
#[expect(clippy::cast_possible_truncation, reason = "a whole number of colors or rounds")]
pub(super) fn whole(number: f64) -> Value {
    if number.fract() == 0.0 { Value::Int(number as i64) } else { number.into() }
}

fn deviation(measured: &Measured) -> f64 {
    let mean = measured.mean(|run| run.ms);
    let n = measured.runs.len().max(2) as f64;
    (measured.samples(|run| (run.ms - mean).powi(2)).iter().sum::<f64>() / (n - 1.0)).sqrt()
}

/// Of the time, `low–high` \[ms\].
pub(super) fn quartiles(measured: &Measured) -> String {
    let at = |q| digits(measured.quantile(q, |run| run.ms));
    format!("{}\u{2013}{}", at(0.25), at(0.75))
}

/// A time \[ms\] in about three digits.
pub(super) fn digits(ms: f64) -> String {
    let decimals = if ms < 0.1 {
        3
    } else if ms < 100.0 {
        2
    } else {
        0
    };
    format!("{ms:.decimals$}")
}

fn summary_row(name: &str, m: &Measured) -> Vec<Value> {
    let time = |run: &Run| run.ms;
    vec![
        name.into(),
        m.method.name.into(),
        colors(m).into(),
        format!("{} \u{b1} {}", digits(m.mean(time)), digits(deviation(m))).into(),
        format!("{} ({})", digits(m.median(time)), quartiles(m)).into(),
        whole(m.median(|run| f64::from(run.rounds))),
        m.median(|run| run.shares.largest).into(),
    ]
}
