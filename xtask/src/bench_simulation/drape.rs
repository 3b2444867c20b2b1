//! Workload C: a cloth falls on a sphere and collides with itself, one thread; how long a frame takes, and where that time goes.

use std::path::Path;
use std::time::Instant;

use vivace_scene::Scene;
use vivace_solver::{Budget, Collisions, Model, Relaxation, Solver, SolverError, State, StepReport, System};

use super::scenes::mean_strain;
use super::sweeps::{gauss_seidel, position_based};
use super::times::{Clock, OverPlain, Reading};
use super::{Pools, Sizes};
use crate::figures::FigureError;
use crate::report::{Table, Value};

/// Phases of a frame.
const PHASES: [&str; 6] = ["predict_ms", "detect_ms", "color_ms", "solve_ms", "guard_ms", "finish_ms"];
/// The solver that a scene has if nothing is said.
pub(super) const DEFAULT: &str = "PD SOR 1.9 split 8, 16 iterations (the default solver)";
/// What is recommended for workload C: nothing jams, and the cloth keeps its length.
pub(super) const RECOMMENDED: &str = "PD direct, 2 substeps of 2";

/// A setting on workload C.
pub(super) struct Drape {
    pub(super) setting: String,
    /// Time of each frame.
    pub(super) times: OverPlain,
    /// Of each phase.
    phases: [OverPlain; PHASES.len()],
    /// The most contacts and colors in a frame.
    contacts: usize,
    colors: u32,
    /// Particles that the guard held back, in all frames.
    held_back: usize,
    /// The worst of all depths \[m\].
    depth: f32,
    /// Mean strain of the edges at the end \[1\].
    pub(super) strain: f64,
}

impl Drape {
    /// Nothing measured yet.
    pub(super) fn new(setting: String) -> Self {
        let (times, phases) = Default::default();
        Self { setting, times, phases, contacts: 0, colors: 0, held_back: 0, depth: 0.0, strain: f64::NAN }
    }

    pub(super) fn push(&mut self, ms: f64, plain: f64) {
        self.times.push(ms, plain);
    }

    fn push_report(&mut self, report: &StepReport, plain: f64) {
        let times = &report.times;
        let phases =
            [times.predict, times.detect, times.color, times.solve, times.guard, times.finish + times.setup];
        for (all, seconds) in self.phases.iter_mut().zip(phases) {
            all.push(seconds * 1e3, plain);
        }
        self.contacts = self.contacts.max(report.contacts.contacts);
        self.colors = self.colors.max(report.colors);
        self.held_back += report.contacts.held_back;
        self.depth = self.depth.max(report.contacts.deepest);
    }

    /// What making contacts constraints takes, coloring included.
    pub(super) fn coloring(&self) -> &OverPlain {
        &self.phases[2]
    }
}

/// Name, iterations and solver.
fn settings() -> [(&'static str, u32, Solver); 6] {
    let direct = Solver { relaxation: Relaxation::Direct, ..gauss_seidel(1.0) };
    let small = |solver: Solver, substeps: u32| Solver { substeps, ..solver };
    [
        (DEFAULT, 16, Solver::default()),
        ("XPBD, 16 substeps of 1", 16, small(position_based(), 16)),
        ("XPBD, 8 substeps of 1", 8, small(position_based(), 8)),
        (RECOMMENDED, 4, small(direct, 2)),
        ("PD direct, 4 substeps of 1", 4, small(direct, 4)),
        ("PD GS, 16 substeps of 1", 16, small(gauss_seidel(1.0), 16)),
    ]
}

/// What the scene collides with, which stands still.
fn collisions(scene: &Scene, model: &Model, state: &State) -> Result<Option<Collisions>, FigureError> {
    let Some(of) = &scene.collisions else { return Ok(None) };
    let mut collisions =
        Collisions::new(model, &state.positions, of.options()).map_err(SolverError::Collision)?;
    *collisions.obstacles_mut() = of.obstacles(Path::new("."))?;
    Ok(Some(collisions))
}

/// Runs all settings, one after another: what one leaves in caches is small beside a frame.
pub(super) fn measure(sizes: &Sizes, pools: &Pools, clock: &mut Clock) -> Result<Vec<Drape>, FigureError> {
    let scene = vivace_scene::drape(sizes.cloths[0]);
    let (model, start) = scene.build(Path::new("."))?;
    let mut all = Vec::new();
    for (name, iterations, solver) in settings() {
        let (mut system, mut state) = (System::new(model.clone(), solver)?, start.clone());
        system.set_collisions(collisions(&scene, &model, &start)?)?;
        let mut drape = Drape::new(name.to_owned());
        for frame in 0..sizes.drape {
            #[cfg(feature = "rapier")]
            if name == RECOMMENDED && frame + 1 == sizes.drape {
                all.push(super::rapier::drape(&scene, &model, &state, clock));
            }
            let budget = Budget::iterations(iterations);
            let (timed, plain) = clock.around(|| {
                let begin = Instant::now();
                let step = || system.step(&mut state, &scene.forces, scene.time_step, budget);
                pools.one.install(step).map(|report| (report, begin.elapsed().as_secs_f64() * 1e3))
            });
            let (report, ms) = timed?;
            // The first makes room.
            if frame > 0 {
                drape.push(ms, plain);
                drape.push_report(&report, plain);
            }
        }
        drape.strain = mean_strain(&model, &state.positions);
        all.push(drape);
    }
    Ok(all)
}

/// A row for each setting.
pub(super) fn table(all: &[Drape]) -> Table {
    let columns = ["setting", "frames", "over_plain", "ms", "ms_p95", "ms_most"]
        .into_iter()
        .chain(PHASES)
        .chain(["contacts", "colors", "held_back", "depth_m", "strain"]);
    let columns: Vec<&str> = columns.collect();
    let name =
        "Workload C on one thread: time of a frame and medians of its phases; most contacts and colors";
    let mut table = Table::new(name, &columns);
    for one in all {
        let measured = |values: &Reading, q: f64| (!values.is_empty()).then(|| values.quantile(q));
        let mut row: Vec<Value> = vec![one.setting.as_str().into(), one.times.ms.len().into()];
        row.push(measured(&one.times.ratio, 0.5).into());
        row.extend([0.5, 0.95, 1.0].map(|q| measured(&one.times.ms, q).into()));
        row.extend(one.phases.iter().map(|phase| measured(&phase.ms, 0.5).into()));
        // A rival does not say.
        let is_ours = !one.phases[0].ms.is_empty();
        row.extend([
            is_ours.then_some(one.contacts).into(),
            is_ours.then_some(one.colors).into(),
            is_ours.then_some(one.held_back).into(),
            is_ours.then_some(one.depth).into(),
            one.strain.into(),
        ]);
        table.push(row);
    }
    table
}
