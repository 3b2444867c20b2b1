//! Error against time for every setting on a scene, and which to take for a budget.
//!
//! The columns of the data, `tradeoff.csv`, a row for each setting and number of iterations: `family`, `setting`, `iterations`,
//! `time_ms` (least of two), `error` (relative to the prediction's, inside one frame), `is_stable` (in a short animation of as many
//! iterations a frame; empty: not played), `is_best` (none is both faster and more accurate).

pub mod settings;

use vivace_model::State;
use vivace_solver::SolverError;
use vivace_solver::reference::Reference;

use crate::figures::FigureError;
use crate::figures::simulation::methods::Method;
use crate::figures::simulation::runs::{self, Limit, Plan};
use crate::figures::simulation::scenes::{H, Scene};
use crate::report::{Axis, Chart, Figure, Look, Mark, Panel, Progress, Series, Table, Value};
use settings::{Setting, settings};

/// Budgets that a setting is recommended for \[ms\].
pub const BUDGETS: [f64; 6] = [1.0, 2.0, 4.0, 8.0, 16.0, 33.0];

/// How much is done.
#[derive(Debug, Clone, Copy)]
pub struct Effort {
    /// Frames of a converged run before the frame that is measured.
    pub warm_frames: u32,
    /// No frame takes much longer than this \[ms\].
    pub longest_ms: f64,
    /// Frames of the animation that stability is judged by.
    pub stable_frames: u32,
}

/// One measured frame of a setting.
struct Spot<'a> {
    setting: &'a Setting,
    iterations: u32,
    ms: f64,
    error: f64,
    is_stable: Option<bool>,
}

/// Measures all settings on the scene.
///
/// # Errors
/// What solvers refuse.
pub fn make(
    scene: &Scene,
    effort: Effort,
    command: &str,
    progress: &mut Progress,
) -> Result<Figure, FigureError> {
    let all = settings();
    progress.figure("tradeoff", all.len() as u64 + 2);
    progress.step("a converged run");
    let start = runs::converged(scene, effort.warm_frames, 40)?;
    let answer = Reference::new(&scene.model, H.into())?.solve(&start, &scene.forces)?;
    let mut spots = Vec::new();
    for setting in &all {
        progress.step(&setting.name);
        let method = method(setting);
        for exponent in 0..14 {
            let iterations = 1 << exponent;
            let points = runs::inside_of(scene, &start, &answer, &method, &[iterations], 2)?;
            let Some(point) = points.first() else { break };
            let (ms, error) = (point.ms, point.error);
            spots.push(Spot { setting, iterations: point.iterations, ms, error, is_stable: None });
            if !error.is_finite() || ms > 0.5 * effort.longest_ms {
                break;
            }
        }
    }
    progress.step("stability, charts and tables");
    let chosen: Vec<Option<usize>> =
        BUDGETS.iter().map(|&ms| choose(scene, &mut spots, ms, effort)).collect::<Result<_, _>>()?;
    let mut figure = assemble(scene, &start, &spots, &chosen, command);
    figure.seconds = Some(progress.done());
    Ok(figure)
}

fn method(setting: &Setting) -> Method {
    Method { name: "", solver: setting.solver, look: Look::nth(0), sweeps: 1 }
}

/// The most accurate spot within `ms` that is stable in an animation.
fn choose(
    scene: &Scene,
    spots: &mut [Spot<'_>],
    ms: f64,
    effort: Effort,
) -> Result<Option<usize>, SolverError> {
    let mut order: Vec<usize> =
        (0..spots.len()).filter(|&k| spots[k].ms <= ms && spots[k].error < 1.0).collect();
    order.sort_by(|&a, &b| spots[a].error.total_cmp(&spots[b].error));
    for k in order {
        if spots[k].is_stable.is_none() {
            let plan = Plan { n_frames: effort.stable_frames, every: u32::MAX, keep: Vec::new() };
            let limit = Limit::Sweeps(spots[k].iterations);
            let run = runs::animate(scene, &method(spots[k].setting), limit, &plan)?;
            spots[k].is_stable = Some(run.is_stable());
        }
        if spots[k].is_stable == Some(true) {
            return Ok(Some(k));
        }
    }
    Ok(None)
}

/// Whether none is both faster and more accurate.
fn is_best(spots: &[Spot<'_>], k: usize) -> bool {
    let own = &spots[k];
    let beats =
        |s: &Spot<'_>| s.ms <= own.ms && s.error <= own.error && (s.ms < own.ms || s.error < own.error);
    own.error.is_finite() && own.error < 1.0 && !spots.iter().any(beats)
}

fn assemble(
    scene: &Scene,
    start: &State,
    spots: &[Spot<'_>],
    chosen: &[Option<usize>],
    command: &str,
) -> Figure {
    let mut front: Vec<usize> = (0..spots.len()).filter(|&k| is_best(spots, k)).collect();
    front.sort_by(|&a, &b| spots[a].ms.total_cmp(&spots[b].ms));
    let mut parts = Vec::new();
    let columns = ["Budget [ms]", "Setting", "Iterations", "Time [ms]", "Error", "Rust"];
    let mut table = Table::new("What to take", &columns);
    for (ms, chosen) in BUDGETS.iter().zip(chosen) {
        let Some(spot) = chosen.map(|k| &spots[k]) else {
            table.push([(*ms).into(), "none is stable and better than no solver".into()]);
            continue;
        };
        parts.push(format!("{ms} ms: {} (error {})", spot.setting.name, Value::Real(spot.error).shown()));
        table.push([
            (*ms).into(),
            spot.setting.name.as_str().into(),
            spot.iterations.into(),
            spot.ms.into(),
            spot.error.into(),
            spot.setting.rust().into(),
        ]);
    }
    let caption = format!(
        "In short. {}.\n\n{} {} particles.\n\nEach spot is one frame (h = 1/30 s) from the same state of a converged run, solved with so many iterations: its time on this machine, the least of two, and its distance to the answer over that of the prediction. All settings run under the safeguard. A setting is recommended if none is more accurate within the budget and an animation with as many iterations a frame blows up nowhere. XPBD is measured against the same answer: its constraints mean the same, but what it leaves out (inertia in the multipliers) stays as error. Small steps are left out: they solve another problem, with less damping.",
        parts.join("; "),
        scene.caption,
        start.positions.len()
    );
    Figure::new("tradeoff", &format!("Error against time: {}", scene.id), command, &caption)
        .chart(chart(spots, &front))
        .table(table)
        .table(front_table(spots, &front))
        .data(data(spots))
}

fn chart(spots: &[Spot<'_>], front: &[usize]) -> Chart {
    let axis = || Axis::log("Relative error").max(2.0);
    let mut by_family: Vec<(&str, Vec<(f64, f64)>)> = Vec::new();
    for spot in spots {
        let point = (spot.ms, spot.error);
        match by_family.iter_mut().find(|(family, _)| *family == spot.setting.family) {
            Some((_, points)) => points.push(point),
            None => by_family.push((&spot.setting.family, vec![point])),
        }
    }
    let mut chart =
        Chart::new("Error against time of one frame, and the best of all (line)", 2).area(420.0, 300.0);
    let best = front.iter().map(|&k| (spots[k].ms, spots[k].error));
    let best = Series::line("Best of all", best).look(Look { color: 3, marker: 0, dash: 0 });
    let mut kinds: Vec<&str> = Vec::new();
    for (title, prefixes) in [
        ("Projective Dynamics, fused", &["PD, "][..]),
        ("Projective Dynamics, split (1 or 4 sweeps)", &["PD split, ", "PD split 4, "]),
        ("Projective Dynamics, 3x3 blocks", &["PD blocks, "]),
        ("XPBD", &["XPBD, "]),
        ("Global solvers", &[""]),
    ] {
        let mut panel = Panel::new(title, Axis::log("Time").unit("ms"), axis());
        for (family, points) in &by_family {
            let is_global = family.starts_with("Direct") || family.starts_with("CG");
            let found = prefixes.iter().find_map(|p| family.strip_prefix(p));
            let Some(kind) = found.filter(|_| is_global == prefixes.contains(&"")) else { continue };
            if !kinds.contains(&kind) {
                kinds.push(kind);
            }
            let k = kinds.iter().position(|known| *known == kind).unwrap_or(0);
            // Black is for the best of all.
            let look = Look { color: if k >= 3 { k + 1 } else { k }, marker: k, dash: 0 };
            panel = panel.series(Series::line(kind, points.iter().copied()).mark(Mark::Dots).look(look));
        }
        chart = chart.panel(panel.series(best.clone()));
    }
    chart
}

fn front_table(spots: &[Spot<'_>], front: &[usize]) -> Table {
    let columns = ["Time [ms]", "Error", "Setting", "Iterations"];
    let mut table = Table::new("The best of all, by time", &columns);
    for spot in front.iter().map(|&k| &spots[k]) {
        table.push([
            spot.ms.into(),
            spot.error.into(),
            spot.setting.name.as_str().into(),
            spot.iterations.into(),
        ]);
    }
    table
}

fn data(spots: &[Spot<'_>]) -> Table {
    let columns = ["family", "setting", "iterations", "time_ms", "error", "is_stable", "is_best"];
    let mut table = Table::new("", &columns);
    for (k, spot) in spots.iter().enumerate() {
        table.push([
            spot.setting.family.as_str().into(),
            spot.setting.name.as_str().into(),
            spot.iterations.into(),
            spot.ms.into(),
            spot.error.into(),
            spot.is_stable.into(),
            is_best(spots, k).into(),
        ]);
    }
    table
}
