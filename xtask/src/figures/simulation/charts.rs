//! The charts of figures 4 and 5.

use super::Comparison;
use super::runs::{Inside, Limit};
use crate::report::{Axis, Chart, Panel, Series};

/// The error over the animation, a panel for each limit of a kind.
pub(super) fn animation(title: &str, of: &Comparison, timed: bool) -> Chart {
    let mut chart = Chart::new(title, 2);
    for limit in of.limits() {
        if timed != matches!(limit, Limit::Milliseconds(_)) {
            continue;
        }
        let runs = || of.all_runs().filter(|run| run.limit == limit);
        let errors = runs().flat_map(|run| run.frames.iter().map(|f| f.error));
        let mut panel = Panel::new(&limit.name(), Axis::linear("Frame").min(0.0), error(errors));
        for run in runs() {
            let mut series = Series::new(run.method.name).look(run.method.look);
            for f in &run.frames {
                series = series.point(f64::from(f.frame), f.error);
            }
            if let Some(frame) = run.blown_up {
                series = series.point(f64::from(frame), f64::NAN);
            }
            panel = panel.series(series);
        }
        chart = chart.panel(panel);
    }
    chart
}

/// The error inside one frame, against work and against time.
pub(super) fn inside(of: &Comparison) -> Chart {
    let axis = || error(of.all_frames().flat_map(|(_, points)| points.iter().map(|p| p.error)));
    let mut work = Panel::new("By work", Axis::log("Sweeps"), axis());
    let mut time = Panel::new("By time on this machine", Axis::log("Time").unit("ms"), axis());
    for (method, points) in of.all_frames() {
        let series = |of: fn(&Inside) -> f64| {
            let points = points.iter().map(|p| (of(p), p.error));
            Series::line(method.name, points).look(method.look)
        };
        work = work.series(series(|p| f64::from(p.sweeps)));
        if of.place(method).1 {
            time = time.series(series(|p| p.ms));
        }
    }
    Chart::new("Convergence inside one frame, after ten frames of a converged run", 2).panel(work).panel(time)
}

/// The axis of errors: what is far above 1 is not worth the room.
pub(super) fn error(errors: impl Iterator<Item = f64>) -> Axis {
    let greatest = errors.filter(|error| error.is_finite()).fold(0.0, f64::max);
    let axis = Axis::log("Relative error");
    if greatest > MOST { axis.max(MOST) } else { axis }
}

const MOST: f64 = 10.0;
