//! Error against time, a panel for each kind of setting.

use super::settings::SUBSTEPS;
use super::{Measure, Spot, Trade};
use crate::report::{Axis, Chart, Look, Mark, Panel, Series};

/// Black is for the best of all.
const BEST: Look = Look { color: 3, marker: 0, dash: 0 };

/// Against the one step of implicit Euler.
pub(super) fn step(trade: &Trade<'_>) -> Chart {
    let title = format!("Error of the step against time, and the best of all (line): {}", trade.scene.name);
    let mut chart = Chart::new(&title, 2).area(420.0, 300.0);
    let best = line("Best of all", &trade.front(Measure::Step), Measure::Step);
    let mut kinds = Kinds::default();
    for (title, prefixes) in [
        ("Projective Dynamics, fused", &["PD, "][..]),
        ("Projective Dynamics, split, 1 sweep", &["PD split, "]),
        ("Projective Dynamics, split, 8 sweeps", &["PD split 8, "]),
        ("Projective Dynamics, 3x3 blocks", &["PD blocks, "]),
        ("XPBD", &["XPBD, "]),
        ("Global solvers", &[""]),
    ] {
        let kind = |family: &'_ str| {
            let is_global = family.starts_with("Direct") || family.starts_with("CG");
            let found = prefixes.iter().find_map(|prefix| family.strip_prefix(prefix));
            found.filter(|_| is_global == prefixes.contains(&"")).map(str::to_owned)
        };
        let mut panel = panel(title);
        for (kind, points) in grouped(&trade.spots, Measure::Step, kind) {
            panel = panel.series(kinds.dots(&kind, points));
        }
        chart = chart.panel(panel.series(best.clone()));
    }
    chart
}

/// Against the motion.
pub(super) fn motion(trade: &Trade<'_>) -> Chart {
    let title = format!("Error of the motion against time, and the best of all (line): {}", trade.scene.name);
    let mut chart = Chart::new(&title, 2).area(420.0, 300.0);
    let best = line("Best of all", &trade.front(Measure::Motion), Measure::Motion);
    let mut kinds = Kinds::default();
    for substeps in SUBSTEPS {
        let prefix = format!("{substeps} small steps, ");
        let kind = |family: &'_ str| family.strip_prefix(&prefix).map(str::to_owned);
        let mut panel = panel(&format!("{substeps} small steps")).guide_y(trade.floor, "one step, converged");
        for (kind, points) in grouped(&trade.spots, Measure::Motion, kind) {
            panel = panel.series(kinds.dots(&kind, points));
        }
        chart = chart.panel(panel.series(best.clone()));
    }
    chart
}

fn panel(title: &str) -> Panel {
    Panel::new(title, Axis::log("Time").unit("ms"), Axis::log("Relative error").max(2.0))
}

fn line(name: &str, spots: &[&Spot<'_>], measure: Measure) -> Series {
    Series::line(name, spots.iter().map(|spot| (spot.ms, spot.error(measure)))).look(BEST)
}

type Points = Vec<(f64, f64)>;

/// The spots of each kind, in the order of settings.
fn grouped(
    spots: &[Spot<'_>],
    measure: Measure,
    kind: impl Fn(&str) -> Option<String>,
) -> Vec<(String, Points)> {
    let mut groups: Vec<(String, Points)> = Vec::new();
    for spot in spots.iter().filter(|spot| spot.error(measure).is_finite()) {
        let Some(kind) = kind(&spot.setting.family) else { continue };
        let point = (spot.ms, spot.error(measure));
        match groups.iter_mut().find(|(known, _)| *known == kind) {
            Some((_, points)) => points.push(point),
            None => groups.push((kind, vec![point])),
        }
    }
    groups
}

/// One look for each kind in all panels.
#[derive(Default)]
struct Kinds(Vec<String>);

impl Kinds {
    fn dots(&mut self, kind: &str, points: Points) -> Series {
        let known = self.0.iter().position(|known| known == kind);
        let k = known.unwrap_or(self.0.len());
        if known.is_none() {
            self.0.push(kind.to_owned());
        }
        let look = Look { color: if k >= BEST.color { k + 1 } else { k }, marker: k, dash: 0 };
        Series::line(kind, points).mark(Mark::Dots).look(look)
    }
}
