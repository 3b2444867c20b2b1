//! Figure 3: time to complete and number of colors against the number of vertices.
//!
//! Times are of this CPU; rounds and visits, which are the same on every machine, stand for a GPU.
//!
//! - `fig3.csv`, a row for each run: the columns of `fig2.csv`, then `balanced_largest_over_mean`,
//!   `balanced_smallest_over_mean` (class sizes after the balancing pass) and `balance_ms` (its time).
//! - `fig3-summary.csv`, a row for each graph and method: `family`, `vertices`, `method`, `device`, `runs`, `time_ms` (median),
//!   `time_ms_q1`, `time_ms_q3`, `time_over_serial` (over the median of serial first fit), `colors` (median), `colors_min`,
//!   `colors_max`, `rounds`, `visits_per_vertex`, `largest_over_mean`, `balanced_largest_over_mean` (medians).
//! - `fig3-graphs.csv`, a row for each graph: `family`, `source`, `vertices`, `edges`, `elements`, `min_degree`, `mean_degree`,
//!   `max_degree`, `seconds` (reading or generating it, never part of a coloring's time).
//! - `fig3-ablation.csv`: see [`ablation`].

use super::ablation::{self, Ablation};
use super::families::{Family, Model};
use super::fig2;
use super::fig3_charts;
use super::measure::{Devices, Effort, Measured, Method, Run, measure};
use super::{Context, FigureError, claims, device};
use crate::report::{Figure, Table, Value};

/// All that was measured on one graph.
pub struct GraphResult {
    /// Its family.
    pub family: Family,
    /// The graph.
    pub model: Model,
    /// One for each of [`Method::ALL`], and of [`Method::GPU`] if there is one.
    pub measured: Vec<Measured>,
}

impl GraphResult {
    /// The runs of a method.
    pub fn of(&self, method: &Method) -> Option<&Measured> {
        self.measured.iter().find(|m| m.method.name == method.name)
    }

    /// The median of a quantity over the runs of a method; NaN if it was not run.
    pub fn median(&self, method: &Method, of: impl Fn(&Run) -> f64) -> f64 {
        self.of(method).map_or(f64::NAN, |m| m.median(of))
    }
}

/// Makes the figure.
///
/// # Errors
/// What meshes, colorings and pictures run into.
pub fn make(context: &mut Context<'_>, command: &str) -> Result<Figure, FigureError> {
    let sizes = context.sizes.fig3.clone();
    context.progress.figure("fig3", 4 * sizes.len() as u64 + 4);
    let effort = Effort {
        most: context.sizes.seeds,
        fewest: context.sizes.seeds.min(5),
        seconds: context.sizes.seconds,
        balance: true,
    };
    let mut results = Vec::new();
    let mut ablations = Vec::new();
    for n in sizes {
        let shown = Value::from(n).shown();
        context.progress.step(&format!("meshes of about {shown} vertices"));
        let models = context.pool.install(|| context.families.models(n))?;
        for (family, model) in Family::ALL.into_iter().zip(models) {
            context.progress.step(&format!("{shown} vertices: {}", context.families.name(family)));
            let (n_vertices, source) = (model.graph.n_vertices(), &model.source);
            let known = |r: &GraphResult| {
                r.family == family && r.model.graph.n_vertices() == n_vertices && r.model.source == *source
            };
            // Where few meshes exist, two wanted sizes may come to the same file.
            if results.iter().any(known) {
                continue;
            }
            let methods = context.devices().methods(&Method::ALL);
            let measured = measure(context.devices(), &model.graph, &methods, effort, context.seed)?;
            if n == context.sizes.ablation {
                context
                    .progress
                    .step(&format!("ablation on {shown} vertices: {}", context.families.name(family)));
                ablations.push(ablation::measure_on(context, family, &model)?);
            }
            results.push(GraphResult { family, model, measured });
        }
    }
    context.progress.step("charts and tables");
    let mut figure = assemble(context, command, &results, &ablations);
    figure.seconds = Some(context.progress.done());
    Ok(figure)
}

fn assemble(context: &Context<'_>, command: &str, results: &[GraphResult], ablations: &[Ablation]) -> Figure {
    let families = context.families;
    let caption = format!(
        "{}\n\nColoring algorithms compared by time to complete (left) and number of colors (right). Whole lines: the paper\u{2019}s algorithms, which work in rounds; dashed: what is best on a CPU. Times are of this CPU ({}); reading and generating meshes is not part of them. All methods took turns, one run each.\n\n{}\n\nRounds and visits are the same on every machine. On a GPU all vertices of a round act at once, so rounds (kernel launches, each with a wait) and visits (work) tell what to expect there. {}",
        in_short(results, context.pool.current_num_threads()),
        context.machine,
        families.caption(),
        device::sentence(context.gpu),
    );
    let mut figure = Figure::new("fig3", "Figure 3: coloring time and number of colors", command, &caption)
        .chart(fig3_charts::time_and_colors(families, results, context.gpu))
        .chart(fig3_charts::rounds_and_visits(families, results))
        .chart(fig3_charts::balance(families, results))
        .chart(ablation::chart(families, ablations))
        .table(largest(context, results))
        .table(ablation::table(families, ablations))
        .data(runs(context, results))
        .data(summary(context.devices(), results))
        .data(graphs(results))
        .data(ablation::data(ablations))
        .option("seeds, at most", context.sizes.seeds)
        .option("time for one graph [s]", context.sizes.seconds);
    figure.claims = claims::judge(results, ablations, &context.machine);
    figure
}

/// The answer in two sentences, for both machines.
fn in_short(results: &[GraphResult], n_threads: usize) -> String {
    let ends = |values: &mut dyn Iterator<Item = f64>| {
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
    };
    let times = |r: &GraphResult| r.median(&Method::VIVACE, ms) / r.median(&Method::SERIAL, ms);
    let (low, high) = ends(&mut results.iter().map(times));
    let rounds = |run: &Run| f64::from(run.rounds);
    let others = [Method::LUBY, Method::JONES_PLASSMANN, Method::LDF];
    let fewest = |r: &GraphResult| others.iter().map(|m| r.median(m, rounds)).fold(f64::INFINITY, f64::min);
    let (low_rounds, high_rounds) =
        ends(&mut results.iter().map(|r| fewest(r) / r.median(&Method::VIVACE, rounds)));
    format!(
        "In short. On this CPU plain first fit, serial on one thread, takes 1/{low:.1} to 1/{high:.1} of the time of Vivace on {n_threads} threads. Where all vertices act at once, Luby, Jones\u{2013}Plassmann and LDF all need at least {low_rounds:.1} to {high_rounds:.1} times the rounds of Vivace."
    )
}

fn ms(run: &Run) -> f64 {
    run.ms
}

/// The largest graph of each family, for a reader.
fn largest(context: &Context<'_>, results: &[GraphResult]) -> Table {
    let mut table = Table::new(
        "The largest graph of each family (medians)",
        &[
            "Graph",
            "Method",
            "Time (quartiles) [ms]",
            "Time / serial first fit",
            "Colors",
            "Rounds",
            "Visits per vertex",
            "Largest class / mean",
            "\u{2026} balanced",
            "Balancing [ms]",
        ],
    );
    for family in Family::ALL {
        let of_family = results.iter().filter(|r| r.family == family);
        let Some(result) = of_family.max_by_key(|r| r.model.graph.n_vertices()) else { continue };
        let n = Value::from(result.model.graph.n_vertices()).shown();
        for m in &result.measured {
            let time = |run: &Run| run.ms;
            let in_rounds = m.method.is_in_rounds();
            table.push([
                format!("{}, {n} vertices", context.families.name(family)).into(),
                m.method.name.into(),
                format!("{} ({})", fig2::digits(m.median(time)), fig2::quartiles(m)).into(),
                (m.median(time) / result.median(&Method::SERIAL, time)).into(),
                fig2::whole(m.median(|run| f64::from(run.colors))),
                if in_rounds { fig2::whole(m.median(|run| f64::from(run.rounds))) } else { Value::Missing },
                in_rounds.then(|| m.median(|run| run.visits)).into(),
                m.median(|run| run.shares.largest).into(),
                balanced(m).into(),
                m.median(|run| run.balance_ms.unwrap_or(f64::NAN)).into(),
            ]);
        }
    }
    table
}

/// Largest class over the mean after balancing, median.
pub(super) fn balanced(m: &Measured) -> f64 {
    m.median(|run| run.balanced.map_or(f64::NAN, |shares| shares.largest))
}

fn runs(context: &Context<'_>, results: &[GraphResult]) -> Table {
    let mut columns = fig2::COLUMNS.to_vec();
    columns.extend(["balanced_largest_over_mean", "balanced_smallest_over_mean", "balance_ms"]);
    let mut table = Table::new("", &columns);
    for result in results {
        for m in &result.measured {
            for run in &m.runs {
                let mut row = fig2::row(result.family, &result.model, &m.method, context.devices(), run);
                row.push(run.balanced.map(|shares| shares.largest).into());
                row.push(run.balanced.map(|shares| shares.smallest).into());
                row.push(run.balance_ms.into());
                table.push(row);
            }
        }
    }
    table
}

fn summary(devices: Devices<'_>, results: &[GraphResult]) -> Table {
    let mut table = Table::new(
        "summary",
        &[
            "family",
            "vertices",
            "method",
            "device",
            "runs",
            "time_ms",
            "time_ms_q1",
            "time_ms_q3",
            "time_over_serial",
            "colors",
            "colors_min",
            "colors_max",
            "rounds",
            "visits_per_vertex",
            "largest_over_mean",
            "balanced_largest_over_mean",
        ],
    );
    for result in results {
        for m in &result.measured {
            let (time, colors) = (|run: &Run| run.ms, |run: &Run| f64::from(run.colors));
            let in_rounds = m.method.is_in_rounds();
            table.push([
                result.family.id().into(),
                result.model.graph.n_vertices().into(),
                m.method.algorithm.name().into(),
                devices.name(&m.method).into(),
                m.runs.len().into(),
                m.median(time).into(),
                m.quantile(0.25, time).into(),
                m.quantile(0.75, time).into(),
                (m.median(time) / result.median(&Method::SERIAL, time)).into(),
                m.median(colors).into(),
                m.quantile(0.0, colors).into(),
                m.quantile(1.0, colors).into(),
                in_rounds.then(|| m.median(|run| f64::from(run.rounds))).into(),
                in_rounds.then(|| m.median(|run| run.visits)).into(),
                m.median(|run| run.shares.largest).into(),
                balanced(m).into(),
            ]);
        }
    }
    table
}

fn graphs(results: &[GraphResult]) -> Table {
    let mut table = Table::new(
        "graphs",
        &[
            "family",
            "source",
            "vertices",
            "edges",
            "elements",
            "min_degree",
            "mean_degree",
            "max_degree",
            "seconds",
        ],
    );
    for GraphResult { family, model, .. } in results {
        table.push([
            family.id().into(),
            model.source.as_str().into(),
            model.graph.n_vertices().into(),
            model.graph.n_edges().into(),
            model.n_elements.into(),
            model.graph.min_degree().into(),
            model.graph.mean_degree().into(),
            model.graph.max_degree().into(),
            model.seconds.into(),
        ]);
    }
    table
}
