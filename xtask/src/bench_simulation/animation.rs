//! Three seconds of a falling cloth: how far its edges are stretched at the end, and what a frame costs.

use std::time::Instant;

use glam::Vec3;
use rayon::ThreadPool;
use vivace_solver::{Budget, Forces, Relaxation, Solver, SolverError, State, System};

use super::scenes;
use super::sweeps::{blocks, gauss_seidel, position_based};
use super::times::{Clock, OverPlain, Times};
use super::{Pools, Sizes};
use crate::figures::FigureError;
use crate::report::{Table, Value};

/// A setting, animated.
pub(super) struct Animation {
    pub(super) setting: String,
    /// Steps per second.
    pub(super) rate: u32,
    /// Time per 1/60 s.
    pub(super) times: OverPlain,
    /// Mean strain of the edges at the end \[1\]; infinite if it diverged.
    pub(super) strain: f64,
}

/// What can be animated.
pub(super) trait Animated {
    /// Makes a step of `h` \[s\]. Its time \[ms\] without what is done once and for all; nothing if it diverged.
    fn step(&mut self, pool: &ThreadPool, h: f32) -> Result<Option<f64>, FigureError>;

    /// Where the particles are \[m\].
    fn positions(&self) -> Vec<Vec3>;
}

struct Ours {
    system: System,
    state: State,
    iterations: u32,
}

impl Animated for Ours {
    fn step(&mut self, pool: &ThreadPool, h: f32) -> Result<Option<f64>, FigureError> {
        let Self { system, state, iterations } = self;
        let begin = Instant::now();
        let result =
            pool.install(|| system.step(state, &Forces::default(), h, Budget::iterations(*iterations)));
        let seconds = begin.elapsed().as_secs_f64();
        match result {
            // The factor is made once, in the first step.
            Ok(report) => Ok(Some((seconds - report.times.setup) * 1e3)),
            Err(SolverError::Diverged { .. }) => Ok(None),
            Err(other) => Err(other.into()),
        }
    }

    fn positions(&self) -> Vec<Vec3> {
        self.state.positions.clone()
    }
}

/// A setting that is being animated.
pub(super) struct Running {
    name: String,
    rate: u32,
    body: Box<dyn Animated>,
    is_lost: bool,
}

impl Running {
    pub(super) fn new(name: String, rate: u32, body: impl Animated + 'static) -> Self {
        Self { name, rate, body: Box::new(body), is_lost: false }
    }

    /// Times of the frames of a turn, per 1/60 s \[ms\]; none any more once it has diverged.
    fn turn(&mut self, pool: &ThreadPool) -> Result<Vec<f64>, FigureError> {
        let mut all = Vec::new();
        for _ in 0..TURN * self.rate / 60 {
            if self.is_lost {
                break;
            }
            match self.body.step(pool, 1.0 / self.rate as f32)? {
                Some(ms) => all.push(ms * f64::from(self.rate) / 60.0),
                None => self.is_lost = true,
            }
        }
        Ok(all)
    }
}

/// Frames that one setting runs before the next has its turn: caches are its own after the first.
const TURN: u32 = 10;

/// Name, steps per second, iterations of a step, solver; and whether the cloth resists bending.
fn settings() -> Vec<(String, u32, u32, Solver, bool)> {
    let direct = Solver { relaxation: Relaxation::Direct, ..gauss_seidel(1.0) };
    let mut all = Vec::new();
    for rate in [60, 30] {
        for iterations in [1, 2, 4] {
            all.push((format!("PD direct, {iterations}"), rate, iterations, direct, true));
        }
    }
    all.push(("PD direct, 2 substeps of 1".to_owned(), 60, 2, Solver { substeps: 2, ..direct }, true));
    all.push(("PD direct, 20 (converged)".to_owned(), 60, 20, direct, true));
    for substeps in [10, 20, 30] {
        let kinds = [
            ("XPBD springs only", position_based(), false),
            ("XPBD", position_based(), true),
            ("PD GS", gauss_seidel(1.0), true),
            ("PD blocks GS", blocks(gauss_seidel(1.0)), true),
        ];
        for (name, solver, is_bending) in kinds {
            let solver = Solver { substeps, ..solver };
            all.push((format!("{name}, {substeps} substeps of 1"), 60, substeps, solver, is_bending));
        }
    }
    all.push((
        "PD SOR 1.7, 20, safeguard".to_owned(),
        60,
        20,
        Solver { safeguard: true, ..gauss_seidel(1.7) },
        true,
    ));
    all
}

/// Animates all settings in turns.
pub(super) fn measure(
    sizes: &Sizes,
    pools: &Pools,
    clock: &mut Clock,
) -> Result<Vec<Animation>, FigureError> {
    let (model, start) = scenes::cloth(sizes.cloths[0], 100.0, true)?;
    let (springs, _) = scenes::cloth(sizes.cloths[0], 100.0, false)?;
    let mut running = Vec::new();
    for (name, rate, iterations, solver, is_bending) in settings() {
        let model = if is_bending { &model } else { &springs };
        let system = System::new(model.clone(), solver)?;
        running.push(Running::new(name, rate, Ours { system, state: start.clone(), iterations }));
    }
    #[cfg(feature = "rapier")]
    running.extend(super::rapier::animations(&model, &start));
    let mut times = Times::default();
    for _ in 0..sizes.animation.div_ceil(TURN) {
        for one in &mut running {
            let key = format!("{} {}", one.name, one.rate);
            let (ms, plain) = clock.around(|| one.turn(&pools.one));
            ms?.into_iter().for_each(|ms| times.push("A", &key, 1, ms, plain));
        }
    }
    let finished = |one: Running| {
        let key = format!("{} {}", one.name, one.rate);
        let strain = scenes::mean_strain(&model, &one.body.positions());
        Animation {
            times: times.of("A", &key, 1),
            strain: if one.is_lost { f64::INFINITY } else { strain },
            setting: one.name,
            rate: one.rate,
        }
    };
    Ok(running.into_iter().map(finished).collect())
}

/// A row for each setting.
pub(super) fn table(all: &[Animation]) -> Table {
    let columns = ["setting", "rate", "ms", "over_plain", "over_plain_q1", "over_plain_q3", "strain"];
    let mut table = Table::new("Animation of A: time per 1/60 s, mean strain at the end", &columns);
    for one in all {
        let ratio = &one.times.ratio;
        let row: [Value; 7] = [
            one.setting.as_str().into(),
            one.rate.into(),
            one.times.ms.median().into(),
            ratio.median().into(),
            ratio.quantile(0.25).into(),
            ratio.quantile(0.75).into(),
            one.strain.into(),
        ];
        table.push(row);
    }
    table
}
