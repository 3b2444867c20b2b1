//! What a reader and a program see of the runs.

use super::measure::{GraphBench, Sample, Task, TaskBench};
use crate::report::{Table, Value};

/// A row for each graph and task, under the columns named at the head of this module's parent.
pub(super) fn runs(benches: &[GraphBench]) -> Table {
    let mut table = Table::new(
        "",
        &[
            "graph",
            "vertices",
            "edges",
            "max_degree",
            "task",
            "threads",
            "runs",
            "ms",
            "ms_q1",
            "ms_q3",
            "ms_min",
            "over_sff",
            "over_sff_min",
            "colors",
            "colors_max",
            "rounds",
            "rounds_max",
            "visits_per_vertex",
            "largest_over_mean",
            "smallest_over_mean",
        ],
    );
    for bench in benches {
        for t in &bench.tasks {
            table.push(row(bench, t));
        }
    }
    table
}

fn row(bench: &GraphBench, t: &TaskBench) -> Vec<Value> {
    let ms = |s: &Sample| s.ms;
    let (colors, rounds) = (|s: &Sample| f64::from(s.colors), |s: &Sample| f64::from(s.rounds));
    let sff_min = bench.of(Task::SFF, 1).map_or(f64::NAN, |sff| sff.quantile(0.0, ms));
    let is_coloring = t.samples.iter().any(|s| s.colors > 0);
    let in_rounds = t.samples.iter().any(|s| s.rounds > 0);
    let share = |of: fn(&Sample) -> f64| is_coloring.then(|| t.median(of)).into();
    vec![
        bench.workload.name.into(),
        bench.workload.n_vertices.into(),
        bench.n_edges.into(),
        bench.max_degree.into(),
        t.task.name().into(),
        t.n_threads.into(),
        t.samples.len().into(),
        t.median(ms).into(),
        t.quantile(0.25, ms).into(),
        t.quantile(0.75, ms).into(),
        t.quantile(0.0, ms).into(),
        bench.ratio(t.task, t.n_threads).into(),
        (t.quantile(0.0, ms) / sff_min).into(),
        is_coloring.then(|| t.median(colors)).into(),
        is_coloring.then(|| t.quantile(1.0, colors)).into(),
        in_rounds.then(|| t.median(rounds)).into(),
        in_rounds.then(|| t.quantile(1.0, rounds)).into(),
        in_rounds.then(|| t.median(|s| s.visits)).into(),
        share(|s| s.shares.map_or(f64::NAN, |shares| shares.largest)),
        share(|s| s.shares.map_or(f64::NAN, |shares| shares.smallest)),
    ]
}

/// A row for each task, a column for each graph: ratio to SFF and colors; for SFF itself milliseconds.
pub(super) fn ratios(benches: &[GraphBench], n_threads: usize) -> Table {
    let mut table = Table::new("Time over SFF / colors (SFF: milliseconds / colors)", &["Task", "Threads"]);
    table.columns.extend(benches.iter().map(|bench| bench.workload.name.to_owned()));
    let Some(first) = benches.first() else { return table };
    for t in &first.tasks {
        let mut row: Vec<Value> = vec![t.task.name().into(), t.n_threads.into()];
        for bench in benches {
            let colors = bench.colors(t.task, t.n_threads);
            let time = if t.task == Task::SFF {
                format!("{:.3} ms", bench.ms(t.task, 1))
            } else {
                format!("{:.2}", bench.ratio(t.task, t.n_threads))
            };
            row.push(if colors > 0.0 { format!("{time} / {colors}") } else { time }.into());
        }
        table.push(row);
    }
    if n_threads > 1 {
        speedups(&mut table, benches, n_threads);
    }
    table
}

/// Rows with the gain of more threads.
fn speedups(table: &mut Table, benches: &[GraphBench], n_threads: usize) {
    let tasks: Vec<Task> = benches[0].tasks.iter().filter(|t| t.n_threads > 1).map(|t| t.task).collect();
    for task in tasks.into_iter().filter(|&task| benches[0].of(task, 1).is_some()) {
        let mut row: Vec<Value> = vec![format!("{}: times faster", task.name()).into(), n_threads.into()];
        row.extend(
            benches
                .iter()
                .map(|bench| format!("{:.2}", bench.ms(task, 1) / bench.ms(task, n_threads)).into()),
        );
        table.push(row);
    }
}
