//! The readings of line 7 of Algorithm 1, and a fixed ω against a picked one.

use vivace_model::State;
use vivace_solver::reference::Answer;
use vivace_solver::{Base, Relaxation, Solver, SolverError};

use super::charts;
use super::methods::Method;
use super::runs::{self, Inside};
use super::scenes::Scene;
use crate::report::{Axis, Chart, Look, Panel, Series, Table, Value};

/// Values of ω, ascending.
const OMEGAS: [f32; 11] = [1.0, 1.1, 1.2, 1.3, 1.4, 1.5, 1.6, 1.7, 1.8, 1.9, 1.95];
/// Sweeps after which they are compared.
const SWEEPS: [u32; 5] = [4, 8, 16, 32, 128];
const READINGS: [(Base, f32, &str); 5] = [
    (Base::Latest, 1.9, "From the latest, 1.9"),
    (Base::PreviousInPlace, 1.9, "From the last sweep, in place, 1.9 (as printed)"),
    (Base::PreviousInPlace, 1.3, "From the last sweep, in place, 1.3"),
    (Base::PreviousAfterSweep, 1.9, "From the last sweep, after a whole one, 1.9"),
    (Base::Latest, 1.7, "From the latest, 1.7"),
];

/// What was measured inside one frame.
pub(super) struct Line7 {
    readings: Vec<(&'static str, f32, Vec<Inside>)>,
    /// A curve for each ω: all from the latest positions.
    omegas: Vec<(f32, Vec<Inside>)>,
}

impl Line7 {
    pub(super) fn measure(
        scene: &Scene,
        start: &State,
        answer: &Answer,
        plain: &Method,
        counts: &[u32],
    ) -> Result<Self, SolverError> {
        let inside = |omega, base, counts: &[u32]| {
            let relaxation = Relaxation::GaussSeidel { omega, base };
            let method = Method { solver: Solver { relaxation, ..plain.solver }, ..*plain };
            runs::inside(scene, start, answer, &method, counts, 1)
        };
        let mut readings = Vec::new();
        for (base, omega, name) in READINGS {
            readings.push((name, omega, inside(omega, base, counts)?));
        }
        let most = counts.last().copied().unwrap_or(1);
        let compared: Vec<u32> = SWEEPS.into_iter().filter(|&n| n <= most).collect();
        let mut omegas = Vec::new();
        for omega in OMEGAS {
            omegas.push((omega, inside(omega, Base::Latest, &compared)?));
        }
        Ok(Self { readings, omegas })
    }

    /// For each number of sweeps the best ω, its error, and that of ω = 1.9.
    pub(super) fn picked(&self) -> Vec<(u32, f32, f64, f64)> {
        let n = self.n_compared();
        let mut rows = Vec::new();
        for k in 0..n {
            let of = |(omega, points): &(f32, Vec<Inside>)| (*omega, points[k]);
            let finite = self.omegas.iter().map(of).filter(|(_, p)| p.error.is_finite());
            let best = finite.min_by(|(_, a), (_, b)| a.error.total_cmp(&b.error));
            let paper = self.omegas.iter().map(of).find(|(omega, _)| *omega == 1.9);
            if let (Some((omega, best)), Some((_, paper))) = (best, paper) {
                rows.push((best.sweeps, omega, best.error, paper.error));
            }
        }
        rows
    }

    /// How many numbers of sweeps all ω were measured at: a curve may end early.
    fn n_compared(&self) -> usize {
        self.omegas.iter().map(|(_, points)| points.len()).min().unwrap_or(0)
    }

    /// The greatest error of the printed reading over its sweeps.
    pub(super) fn printed(&self) -> f64 {
        let points = self.readings.get(1).map_or(&[][..], |(_, _, points)| points);
        points.iter().map(|p| if p.error.is_finite() { p.error } else { f64::INFINITY }).fold(0.0, f64::max)
    }

    /// The error of a reading after the most sweeps.
    pub(super) fn last(&self, reading: usize) -> f64 {
        let points = self.readings.get(reading).and_then(|(_, _, points)| points.last());
        points.map_or(f64::NAN, |p| p.error)
    }

    pub(super) fn chart(&self) -> Chart {
        let errors = self.readings.iter().flat_map(|(_, _, points)| points.iter().map(|p| p.error));
        let mut left = Panel::new("Readings of line 7", Axis::log("Sweeps"), charts::error(errors));
        for (idx, (name, _, points)) in self.readings.iter().enumerate() {
            let points = points.iter().map(|p| (f64::from(p.sweeps), p.error));
            left = left.series(Series::line(name, points).look(Look::nth(idx)));
        }
        let errors = self.omegas.iter().flat_map(|(_, points)| points.iter().map(|p| p.error));
        let mut right = Panel::new(
            "Which \u{3c9}, after how many sweeps",
            Axis::linear("\u{3c9}"),
            charts::error(errors),
        );
        let n = self.n_compared();
        for k in 0..n {
            let points = self.omegas.iter().map(|(omega, points)| (f64::from(*omega), points[k].error));
            let name = format!("{} sweeps", self.omegas[0].1[k].sweeps);
            let look = Look { color: k, marker: k, dash: 4 };
            right = right.series(Series::line(&name, points).look(look));
        }
        Chart::new("Over-relaxation inside one frame", 2).panel(left).panel(right)
    }

    pub(super) fn table(&self) -> Table {
        let columns = ["Sweeps", "Best \u{3c9}", "Its error", "Error of \u{3c9} = 1.9", "Times more"];
        let mut table = Table::new("Fixed \u{3c9} against the picked one (inside one frame)", &columns);
        for (sweeps, omega, best, paper) in self.picked() {
            table.push([
                sweeps.into(),
                Value::Text(format!("{omega}")),
                best.into(),
                paper.into(),
                (paper / best).into(),
            ]);
        }
        table
    }

    pub(super) fn data(&self) -> Table {
        let mut table = Table::new("line7", &["reading", "omega", "sweeps", "error"]);
        let named = self.readings.iter().map(|(name, omega, points)| (*name, *omega, points));
        let swept = self.omegas.iter().map(|(omega, points)| ("From the latest", *omega, points));
        for (name, omega, points) in named.chain(swept) {
            for p in points {
                let omega: Value = format!("{omega}").into();
                table.push([name.into(), omega, p.sweeps.into(), p.error.into()]);
            }
        }
        table
    }
}
