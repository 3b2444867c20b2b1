//! Error against time for every setting on a scene, and which to take for a budget.
//!
//! The columns of the data, `tradeoff.csv` (`trade.csv` in the report of the figures), a row for each scene, setting and number of
//! iterations: `scene`, `family`, `setting`, `substeps`, `iterations` (of all small steps together), `time_ms` (least of two),
//! `error` (against the step of implicit Euler, in f64; empty for small steps, which solve another problem), `motion_error` (against
//! the same frame in many small steps, each converged in f64), `is_stable` (in a short animation of as many iterations a frame;
//! empty: not played), `is_best` and `is_best_motion` (none is both faster and more accurate).

mod charts;
pub mod settings;

use vivace_model::State;
use vivace_solver::reference::{Answer, Reference, ReferenceState};
use vivace_solver::{SolverError, System};

use crate::figures::simulation::methods::Method;
use crate::figures::simulation::runs::{self, Limit, Plan};
use crate::figures::simulation::scenes::Scene;
use crate::figures::{Context, FigureError};
use crate::report::{Figure, Look, Progress, Table, Value};
use settings::{Setting, settings};

/// Budgets that a setting is recommended for \[ms\].
pub const BUDGETS: [f64; 6] = [1.0, 2.0, 4.0, 8.0, 16.0, 33.0];

/// How much is done.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// Frames of a converged run before the frame that is measured.
    pub warm_frames: u32,
    /// No frame takes much longer than this \[ms\].
    pub longest_ms: f64,
    /// Frames of the animation that stability is judged by.
    pub stable_frames: u32,
    /// Small steps that the motion is computed with in f64.
    pub fine_steps: u32,
}

impl Effort {
    /// Seconds, on a small scene.
    pub fn quick() -> Self {
        Self { warm_frames: 10, longest_ms: 40.0, stable_frames: 10, fine_steps: 256 }
    }

    /// Some minutes, on a scene of the paper's size.
    pub fn normal() -> Self {
        Self { stable_frames: 30, ..Self::quick() }
    }
}

/// What an error is measured against.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Measure {
    /// The one step of implicit Euler that a frame is.
    Step,
    /// The frame in many small steps.
    Motion,
}

/// One measured frame of a setting.
struct Spot<'a> {
    setting: &'a Setting,
    iterations: u32,
    ms: f64,
    /// Not a number for small steps.
    step_error: f64,
    motion_error: f64,
    is_stable: Option<bool>,
}

impl Spot<'_> {
    fn error(&self, measure: Measure) -> f64 {
        match measure {
            Measure::Step => self.step_error,
            Measure::Motion => self.motion_error,
        }
    }
}

/// A scene, measured.
struct Trade<'a> {
    scene: &'a Scene,
    spots: Vec<Spot<'a>>,
    /// For each budget.
    for_step: Vec<Option<usize>>,
    for_motion: Vec<Option<usize>>,
    /// The motion error of the converged step.
    floor: f64,
    fine_steps: u32,
}

/// The scenes of the report: figure 4's and figure 5's.
///
/// # Errors
/// What scenes and solvers refuse.
pub fn figure(context: &mut Context<'_>, command: &str) -> Result<Figure, FigureError> {
    use crate::figures::simulation::scenes::{armadillo, tablecloth};
    let n = context.sizes.simulation.vertices;
    let (pool, effort, progress) = (context.pool, context.sizes.trade, &mut *context.progress);
    let families = context.families;
    pool.install(|| make("trade", &[tablecloth(n)?, armadillo(families, n)?], effort, command, progress))
}

/// Measures all settings on each scene.
///
/// # Errors
/// What solvers refuse.
pub fn make(
    id: &str,
    scenes: &[Scene],
    effort: Effort,
    command: &str,
    progress: &mut Progress,
) -> Result<Figure, FigureError> {
    let all = settings();
    progress.figure(id, (scenes.len() * (all.len() + 2)) as u64);
    let mut trades = Vec::new();
    for scene in scenes {
        trades.push(Trade::measure(scene, &all, effort, progress)?);
    }
    let names: Vec<&str> = scenes.iter().map(|scene| scene.name.as_str()).collect();
    let title = format!("Error against time: {}", names.join(" and "));
    let mut figure = Figure::new(id, &title, command, &caption(&trades));
    let mut data = Table::new("", &DATA);
    for trade in &trades {
        figure = figure.chart(charts::step(trade)).chart(charts::motion(trade));
        figure = figure.table(trade.choices(Measure::Step)).table(trade.choices(Measure::Motion));
        figure = figure.table(trade.front_table(Measure::Step)).table(trade.front_table(Measure::Motion));
        trade.add_data(&mut data);
    }
    figure = figure.data(data);
    figure.seconds = Some(progress.done());
    Ok(figure)
}

impl<'a> Trade<'a> {
    fn measure(
        scene: &'a Scene,
        all: &'a [Setting],
        effort: Effort,
        progress: &mut Progress,
    ) -> Result<Self, SolverError> {
        progress.step(&format!("{}: answers in f64", scene.name));
        let start = runs::converged(scene, effort.warm_frames, 40)?;
        let answer = Reference::new(&scene.model, scene.h.into())?.solve(&start, &scene.forces)?;
        let motion = motion(scene, &start, &answer, effort.fine_steps)?;
        let ended: Vec<_> = answer.positions.iter().map(|x| x.as_vec3()).collect();
        let floor = motion.error(&ended);
        let mut spots = Vec::new();
        for setting in all {
            progress.step(&format!("{}: {}", scene.name, setting.name));
            let mut system = System::new(scene.model.clone(), setting.solver)?;
            for exponent in 0..14 {
                let iterations = setting.solver.substeps << exponent;
                let Some((ms, end)) = runs::frame(&mut system, scene, &start, iterations, 2)? else { break };
                let is_step = setting.solver.substeps == 1;
                let step_error = if is_step { answer.error(&end.positions) } else { f64::NAN };
                let motion_error = motion.error(&end.positions);
                spots.push(Spot { setting, iterations, ms, step_error, motion_error, is_stable: None });
                if !motion_error.is_finite() || ms > 0.5 * effort.longest_ms {
                    break;
                }
            }
        }
        progress.step(&format!("{}: stability", scene.name));
        let (for_step, for_motion) = (Vec::new(), Vec::new());
        let mut trade = Self { scene, spots, for_step, for_motion, floor, fine_steps: effort.fine_steps };
        for ms in BUDGETS {
            let (step, motion) =
                (trade.choose(Measure::Step, ms, effort)?, trade.choose(Measure::Motion, ms, effort)?);
            trade.for_step.push(step);
            trade.for_motion.push(motion);
        }
        Ok(trade)
    }

    /// The most accurate spot within `ms` that is stable in an animation.
    fn choose(&mut self, measure: Measure, ms: f64, effort: Effort) -> Result<Option<usize>, SolverError> {
        let spots = &mut self.spots;
        let is_useful = |spot: &Spot<'_>| spot.ms <= ms && spot.error(measure) < 1.0;
        let mut order: Vec<usize> = (0..spots.len()).filter(|&k| is_useful(&spots[k])).collect();
        order.sort_by(|&a, &b| spots[a].error(measure).total_cmp(&spots[b].error(measure)));
        for k in order {
            let spot = &mut spots[k];
            let is_stable = match spot.is_stable {
                Some(known) => known,
                None => {
                    let plan = Plan { n_frames: effort.stable_frames, every: u32::MAX, keep: Vec::new() };
                    let limit = Limit::Sweeps(spot.iterations);
                    runs::animate(self.scene, &method(spot.setting), limit, &plan)?.is_stable()
                }
            };
            spot.is_stable = Some(is_stable);
            if is_stable {
                return Ok(Some(k));
            }
        }
        Ok(None)
    }

    /// Whether none is both faster and more accurate.
    fn is_best(&self, measure: Measure, k: usize) -> bool {
        let (ms, error) = (self.spots[k].ms, self.spots[k].error(measure));
        let beats = |s: &Spot<'_>| {
            let other = s.error(measure);
            s.ms <= ms && other <= error && (s.ms < ms || other < error)
        };
        error < 1.0 && !self.spots.iter().any(beats)
    }

    /// The Pareto front, by time.
    fn front(&self, measure: Measure) -> Vec<&Spot<'a>> {
        let best = (0..self.spots.len()).filter(|&k| self.is_best(measure, k));
        let mut front: Vec<&Spot<'_>> = best.map(|k| &self.spots[k]).collect();
        front.sort_by(|a, b| a.ms.total_cmp(&b.ms));
        front
    }

    fn chosen(&self, measure: Measure) -> &[Option<usize>] {
        match measure {
            Measure::Step => &self.for_step,
            Measure::Motion => &self.for_motion,
        }
    }

    fn in_short(&self, measure: Measure) -> String {
        let part = |(ms, chosen): (&f64, &Option<usize>)| {
            let spot = &self.spots[(*chosen)?];
            Some(format!(
                "{ms} ms: {} (error {})",
                spot.setting.name,
                Value::Real(spot.error(measure)).shown()
            ))
        };
        let parts: Vec<String> = BUDGETS.iter().zip(self.chosen(measure)).filter_map(part).collect();
        if parts.is_empty() { "nothing is better than no solver".to_owned() } else { parts.join("; ") }
    }

    fn choices(&self, measure: Measure) -> Table {
        let columns = ["Budget [ms]", "Setting", "Iterations", "Time [ms]", "Error", "Rust"];
        let title = format!("What to take for {}: {}", self.scene.name, measure.name());
        let mut table = Table::new(&title, &columns);
        for (ms, chosen) in BUDGETS.iter().zip(self.chosen(measure)) {
            let Some(spot) = chosen.map(|k| &self.spots[k]) else {
                table.push([(*ms).into(), "none is stable and better than no solver".into()]);
                continue;
            };
            table.push([
                (*ms).into(),
                spot.setting.name.as_str().into(),
                spot.iterations.into(),
                spot.ms.into(),
                spot.error(measure).into(),
                spot.setting.rust().into(),
            ]);
        }
        table
    }

    fn front_table(&self, measure: Measure) -> Table {
        let columns = ["Time [ms]", "Error", "Setting", "Iterations"];
        let title = format!("The best of all for {}: {}", self.scene.name, measure.name());
        let mut table = Table::new(&title, &columns);
        for spot in self.front(measure) {
            table.push([
                spot.ms.into(),
                spot.error(measure).into(),
                spot.setting.name.as_str().into(),
                spot.iterations.into(),
            ]);
        }
        table
    }

    fn add_data(&self, table: &mut Table) {
        for (k, spot) in self.spots.iter().enumerate() {
            let is_step = spot.setting.solver.substeps == 1;
            table.push([
                self.scene.name.as_str().into(),
                spot.setting.family.as_str().into(),
                spot.setting.name.as_str().into(),
                spot.setting.solver.substeps.into(),
                spot.iterations.into(),
                spot.ms.into(),
                is_step.then_some(spot.step_error).into(),
                spot.motion_error.into(),
                spot.is_stable.into(),
                self.is_best(Measure::Step, k).into(),
                self.is_best(Measure::Motion, k).into(),
            ]);
        }
    }
}

const DATA: [&str; 11] = [
    "scene",
    "family",
    "setting",
    "substeps",
    "iterations",
    "time_ms",
    "error",
    "motion_error",
    "is_stable",
    "is_best",
    "is_best_motion",
];

impl Measure {
    fn name(self) -> &'static str {
        match self {
            Self::Step => "the step of implicit Euler",
            Self::Motion => "the motion, small steps too",
        }
    }
}

fn method(setting: &Setting) -> Method {
    Method { name: "", solver: setting.solver, look: Look::nth(0), sweeps: 1 }
}

/// The frame of `answer` in many small steps instead of one.
fn motion(scene: &Scene, start: &State, answer: &Answer, n_steps: u32) -> Result<Answer, SolverError> {
    let mut reference = Reference::new(&scene.model, f64::from(scene.h) / f64::from(n_steps))?;
    let mut state = ReferenceState::from(start);
    for _ in 0..n_steps {
        reference.step(&mut state, &scene.forces)?;
    }
    Ok(Answer { positions: state.positions, ..answer.clone() })
}

fn caption(trades: &[Trade<'_>]) -> String {
    let mut text = "In short.".to_owned();
    for trade in trades {
        text += &format!(
            " {}, the step of implicit Euler: {}. The motion, small steps too: {}.",
            trade.scene.name,
            trade.in_short(Measure::Step),
            trade.in_short(Measure::Motion)
        );
    }
    text += "\n\nEach spot is one frame from the same state of a converged run, solved with so many iterations: its time on this machine, the least of two, and its distance to the answer over that of the prediction: 1 is as good as no solver. All settings run under the safeguard. A setting is recommended if none is more accurate within the budget and an animation with as many iterations a frame blows up nowhere.";
    text += "\n\nThere are two answers, because small steps solve another problem. The first is the minimum of the one step of implicit Euler that a frame is, in f64, as everywhere else in this report; small steps have no error against it. XPBD has: its constraints mean the same, but what it leaves out (inertia in the multipliers) stays as error.";
    for trade in trades {
        text += &format!(
            " The second is the same frame of {} in {} steps, each solved to the end in f64: it tells who comes near the motion itself, and there the one step of implicit Euler, solved to the end, still has an error of {} (it is damped). Its own error is about that of 64 small steps over four.",
            trade.scene.name,
            trade.fine_steps,
            Value::Real(trade.floor).shown()
        );
    }
    for trade in trades {
        text += &format!("\n\n{}", trade.scene.caption);
    }
    text
}
