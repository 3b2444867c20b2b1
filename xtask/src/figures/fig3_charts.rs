//! The charts of figure 3.

use vivace_gpu::Gpu;

use super::families::{Families, Family};
use super::fig3::{GraphResult, balanced};
use super::measure::{Measured, Method, Run};
use crate::report::{Axis, Chart, Look, Panel, Series};

/// As the paper shows it: a row for each family.
pub(super) fn time_and_colors(families: &Families, results: &[GraphResult], gpu: Option<&Gpu>) -> Chart {
    let on_gpu: &[Method] = if gpu.is_some() { &Method::GPU } else { &[] };
    let timed = [&Method::ALL, on_gpu].concat();
    let mut chart = Chart::new("Time to complete and number of colors against size", 2);
    for family in Family::ALL {
        let name = families.name(family);
        let colors = Axis::linear("Number of colors").whole();
        chart = chart
            .panel(panel(name, family, Axis::log("Time").unit("ms"), results, &timed, |run| run.ms))
            .panel(apart(panel(name, family, colors, results, &Method::ALL, |run| f64::from(run.colors))));
    }
    let times = gpu.map_or_else(
        || "Times: this CPU.".to_owned(),
        |gpu| format!("Dotted lines: {}. Other times: this CPU.", crate::bench_gpu::adapter(gpu)),
    );
    chart.note("Curves of the right column are moved a little to the left or right, so that equal numbers of colors stay visible.").note(&format!("Whole lines work in rounds (on a GPU all vertices of a round act at once); dashed lines are for a CPU. {times}"))
}

/// What is the same on every machine.
pub(super) fn rounds_and_visits(families: &Families, results: &[GraphResult]) -> Chart {
    let mut chart = Chart::new("The same on every machine: rounds, and visits per vertex", 2);
    for family in Family::ALL {
        let name = families.name(family);
        let visits = Axis::linear("Visits per vertex").min(0.0);
        chart = chart
            .panel(panel(name, family, Axis::log("Rounds"), results, &Method::PAPER, |run| {
                f64::from(run.rounds)
            }))
            .panel(panel(name, family, visits, results, &Method::PAPER, |run| run.visits));
    }
    chart.note("A round is a fixed number of kernel launches, each waiting for the last; a visit is one uncolored vertex that acts in one round.")
}

/// Largest class over the mean, and what the balancing pass makes of it.
pub(super) fn balance(families: &Families, results: &[GraphResult]) -> Chart {
    let mut chart = Chart::new("Largest class over the mean size, before and after balancing", 3);
    let chart_look = Look { color: 6, marker: 6, dash: 3 };
    for family in Family::ALL {
        let axis = Axis::linear("Largest class / mean").min(0.9);
        let mut panel =
            panel(families.name(family), family, axis, results, &Method::ALL, |run| run.shares.largest);
        let worst = |r: &GraphResult| r.measured.iter().map(balanced).fold(f64::NEG_INFINITY, f64::max);
        let points = results
            .iter()
            .filter(|r| r.family == family)
            .map(|r| (r.model.graph.n_vertices() as f64, worst(r)));
        panel = panel.series(Series::line("After balancing, worst of all", points).look(chart_look));
        chart = chart.panel(panel);
    }
    chart.area(270.0, 200.0)
}

/// Moves the curves a little to the left and right of their places: whole numbers would hide one another.
fn apart(mut panel: Panel) -> Panel {
    let middle = (panel.series.len() as f64 - 1.0) / 2.0;
    for (idx, series) in panel.series.iter_mut().enumerate() {
        let factor = (0.05 * (idx as f64 - middle)).exp();
        series.points.iter_mut().for_each(|point| point.x *= factor);
    }
    panel
}

fn panel(
    title: &str,
    family: Family,
    y: Axis,
    results: &[GraphResult],
    methods: &[Method],
    of: impl Fn(&Run) -> f64,
) -> Panel {
    let mut panel = Panel::new(title, Axis::log("Vertices").compact(), y);
    for method in methods {
        let mut series = Series::new(method.name).look(method.look);
        for result in results.iter().filter(|r| r.family == family) {
            let samples = result.of(method).map_or_else(Vec::new, |m: &Measured| m.samples(&of));
            series = series.samples(result.model.graph.n_vertices() as f64, &samples);
        }
        panel = panel.series(series);
    }
    panel
}
