//! Animations and single frames, measured.

use glam::Vec3;
use rayon::prelude::*;
use vivace_model::State;
use vivace_solver::reference::{Answer, Reference};
use vivace_solver::{Budget, Ease, SolverError, StepReport, System};

use super::methods::{self, Method};
use super::scenes::Scene;

/// What a frame may cost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Limit {
    /// Time \[ms\].
    Milliseconds(f64),
    /// Sweeps over all particles, the same on every machine.
    Sweeps(u32),
}

impl Limit {
    /// The budget of a method's frame.
    pub fn budget(self, method: &Method) -> Budget {
        match self {
            Self::Milliseconds(ms) => Budget::milliseconds(ms),
            Self::Sweeps(n) => Budget::iterations((n / method.sweeps).max(1)),
        }
    }

    /// In words.
    pub fn name(self) -> String {
        match self {
            Self::Milliseconds(ms) => format!("{ms} ms a frame"),
            Self::Sweeps(n) => format!("{n} sweeps a frame"),
        }
    }
}

/// One measured frame.
#[derive(Debug, Clone, Copy)]
pub struct Frame {
    /// Number, from 1.
    pub frame: u32,
    /// `|x − x*| / |s − x*|` against the answer to the method's own step.
    pub error: f64,
    /// Iterations.
    pub iterations: u32,
    /// Colors.
    pub colors: u32,
    /// Time of the solver \[ms\].
    pub ms: f64,
}

/// An animation by one method.
#[derive(Debug, Clone)]
pub struct Run {
    /// The method.
    pub method: Method,
    /// What a frame may cost.
    pub limit: Limit,
    /// The measured frames.
    pub frames: Vec<Frame>,
    /// The frame that blew up: numbers ran out, or a particle was farther from its start than [`FAR`] times the scene, twice a
    /// free fall and twice what the fastest or the wind covers, together.
    pub blown_up: Option<u32>,
    /// The states after the frames that were kept.
    pub kept: Vec<(u32, State)>,
    /// Mean time of all frames that were played \[ms\].
    pub mean_ms: f64,
}

/// Farther from its start than so many sizes of the scene, beside what it falls or flies, no particle ought to be.
pub const FAR: f32 = 3.0;
/// A measured error above this is unstable: twice as bad as no solver at all.
pub const BAD: f64 = 2.0;

/// Gradient at which the answers on tetrahedra end, as [`Reference::set_tolerance`]: an error is then off by less than 10⁻⁴, and most of
/// the time to the last digit is saved. Elsewhere Newton's steps reach it soon.
pub const SMALL: f64 = 1e-5;
/// A frame that took longer than this is not repeated, since little disturbs it \[ms\].
const LONG: f64 = 500.0;
/// The curve of a method inside one frame ends where a frame takes longer than this \[ms\].
pub const LONGEST: f64 = 5000.0;

impl Run {
    /// Whether nothing blew up, and no measured error is above [`BAD`].
    pub fn is_stable(&self) -> bool {
        self.blown_up.is_none() && self.frames.iter().all(|f| f.error <= BAD)
    }

    /// Median of the measured errors; infinite after blowing up.
    pub fn median(&self) -> f64 {
        if self.blown_up.is_some() {
            return f64::INFINITY;
        }
        let mut errors: Vec<f64> = self.frames.iter().map(|f| f.error).collect();
        errors.sort_by(f64::total_cmp);
        crate::report::quantile(&errors, 0.5)
    }

    /// Mean iterations of the measured frames.
    pub fn iterations(&self) -> f64 {
        self.frames.iter().map(|f| f64::from(f.iterations)).sum::<f64>() / self.frames.len().max(1) as f64
    }
}

/// Which frames are looked at.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Frames of the animation.
    pub n_frames: u32,
    /// One frame of so many is measured.
    pub every: u32,
    /// Frames whose states are kept; they are measured, too.
    pub keep: Vec<u32>,
}

/// Plays the animation on the CPU; errors are measured afterwards, so that they take nothing from the time budget.
///
/// # Errors
/// What the solver refuses, beside a step that diverged, which is data.
pub fn animate(scene: &Scene, method: &Method, limit: Limit, plan: &Plan) -> Result<Run, SolverError> {
    let mut system = System::new(scene.model.clone(), method.solver)?;
    animate_in(&mut system, scene, method, limit, plan)
}

/// As [`animate`], in a system of the scene's model that may have another solver.
///
/// # Errors
/// As [`animate`].
pub fn animate_in(
    system: &mut System,
    scene: &Scene,
    method: &Method,
    limit: Limit,
    plan: &Plan,
) -> Result<Run, SolverError> {
    take(system, method)?;
    let budget = limit.budget(method);
    // The first step prepares what later ones use.
    let warm = system.step(&mut scene.state.clone(), &scene.forces, scene.h, Budget::iterations(1));
    warm.map(drop).or_else(forgive)?;
    system.set_solver(method.solver)?;
    let _ = system.step(&mut scene.state.clone(), &scene.forces, scene.h, Budget::iterations(0));
    let size = size(&scene.state.positions);
    let wind = scene.forces.wind.map_or(0.0, |wind| wind.velocity.length());
    let fastest = scene.state.velocities.iter().map(|v| v.length()).fold(wind, f32::max);
    let mut state = scene.state.clone();
    let mut run =
        Run { method: *method, limit, frames: Vec::new(), blown_up: None, kept: Vec::new(), mean_ms: 0.0 };
    let mut looked_at = Vec::new();
    for frame in 1..=plan.n_frames {
        let is_measured = frame.is_multiple_of(plan.every) || plan.keep.contains(&frame);
        let before = is_measured.then(|| state.clone());
        let report = match system.step(&mut state, &scene.forces, scene.h, budget) {
            Ok(report) => report,
            Err(error) => {
                forgive(error)?;
                run.blown_up = Some(frame);
                break;
            }
        };
        let ms = milliseconds(&report);
        run.mean_ms += (ms - run.mean_ms) / f64::from(frame);
        if let Some(before) = before {
            let colors = report.colors;
            let iterations = report.iterations;
            run.frames.push(Frame { frame, error: f64::NAN, iterations, colors, ms });
            looked_at.push((before, state.positions.clone()));
        }
        if plan.keep.contains(&frame) {
            run.kept.push((frame, state.clone()));
        }
        let t = frame as f32 * scene.h;
        if reach(scene, &state) > FAR * size + 2.0 * fastest * t + scene.forces.gravity.length() * t * t {
            run.blown_up = Some(frame);
            break;
        }
    }
    let errors: Vec<Result<f64, SolverError>> = looked_at
        .par_iter()
        .map_init(
            || Reference::new(&scene.model, scene.h.into()),
            |reference, (before, after)| match reference {
                Ok(reference) => {
                    if scene.has_tetrahedra() {
                        reference.set_tolerance(SMALL);
                    }
                    Ok(reference.solve(before, &scene.forces)?.error(after))
                }
                Err(error) => Err(SolverError::Factor { reason: error.to_string() }),
            },
        )
        .collect();
    for (frame, error) in run.frames.iter_mut().zip(errors) {
        frame.error = error.or_else(|error| forgive(error).map(|()| f64::NAN))?;
    }
    // Beyond all bounds there is no error to speak of.
    run.frames.retain(|f| f.error.is_finite());
    Ok(run)
}

/// Lets a system have a method's solver, if it has another.
fn take(system: &mut System, method: &Method) -> Result<(), SolverError> {
    if system.solver() == method.solver { Ok(()) } else { system.set_solver(method.solver) }
}

/// A step that diverged, or a state beyond all bounds, is a result; anything else is not.
fn forgive(error: SolverError) -> Result<(), SolverError> {
    match error {
        SolverError::Diverged { .. } | SolverError::Model(_) => Ok(()),
        error => Err(error),
    }
}

/// Diagonal of the bounding box \[m\].
pub fn size(positions: &[Vec3]) -> f32 {
    let least = positions.iter().copied().fold(Vec3::INFINITY, Vec3::min);
    let most = positions.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
    least.distance(most)
}

/// How far the farthest particle is from its start \[m\].
fn reach(scene: &Scene, state: &State) -> f32 {
    let pairs = state.positions.iter().zip(&scene.state.positions);
    pairs.map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
}

/// The error after so many iterations of one frame.
#[derive(Debug, Clone, Copy)]
pub struct Inside {
    /// Iterations.
    pub iterations: u32,
    /// Sweeps.
    pub sweeps: u32,
    /// Time of the solver \[ms\]: the least of the repeats.
    pub ms: f64,
    /// `|x − x*| / |s − x*|`; not a number where it diverged.
    pub error: f64,
}

/// The state after `n_frames` of a converged run.
///
/// # Errors
/// A model without a factor.
pub fn converged(scene: &Scene, n_frames: u32, iterations: u32) -> Result<State, SolverError> {
    let mut state = scene.state.clone();
    let Some(direct) = methods::named(methods::DIRECT) else { return Ok(state) };
    let mut system = System::new(scene.model.clone(), direct.solver)?;
    for _ in 0..n_frames {
        system.step(&mut state, &scene.forces, scene.h, Budget::iterations(iterations))?;
    }
    Ok(state)
}

/// Convergence inside the frame that begins at `start` and ought to end at `answer`: as many points as there are numbers of sweeps,
/// or fewer where a frame takes seconds.
///
/// # Errors
/// What the solver refuses.
pub fn inside(
    scene: &Scene,
    start: &State,
    answer: &Answer,
    method: &Method,
    sweeps: &[u32],
    repeats: u32,
) -> Result<Vec<Inside>, SolverError> {
    let mut system = System::new(scene.model.clone(), method.solver)?;
    inside_of(&mut system, scene, start, answer, method, sweeps, repeats)
}

/// As [`inside`], in a system of the scene's model that may have another solver.
///
/// # Errors
/// As [`inside`].
pub fn inside_of(
    system: &mut System,
    scene: &Scene,
    start: &State,
    answer: &Answer,
    method: &Method,
    sweeps: &[u32],
    repeats: u32,
) -> Result<Vec<Inside>, SolverError> {
    take(system, method)?;
    let mut points = Vec::new();
    for &n in sweeps {
        let iterations = (n / method.sweeps).max(1);
        let end = frame(system, scene, start, iterations, repeats)?;
        let (ms, error) =
            end.map_or((f64::INFINITY, f64::NAN), |(ms, end)| (ms, answer.error(&end.positions)));
        points.push(Inside { iterations, sweeps: iterations * method.sweeps, ms, error });
        if ms.is_finite() && ms > LONGEST {
            break;
        }
    }
    Ok(points)
}

/// One frame of so many iterations that begins at `start`: its time \[ms\], the least of the repeats (one is enough where it is long),
/// and where it ends; nothing if it diverged.
///
/// # Errors
/// What the solver refuses.
pub fn frame(
    system: &mut System,
    scene: &Scene,
    start: &State,
    iterations: u32,
    repeats: u32,
) -> Result<Option<(f64, State)>, SolverError> {
    let mut best: Option<(f64, State)> = None;
    for _ in 0..repeats.max(1) {
        let mut state = start.clone();
        // The safeguard forgets what it learned.
        system.set_ease(Ease::default());
        match system.step(&mut state, &scene.forces, scene.h, Budget::iterations(iterations)) {
            Ok(report) => {
                let ms = milliseconds(&report);
                let least = best.map_or(f64::INFINITY, |(ms, _)| ms);
                best = Some((least.min(ms), state));
                if ms > LONG {
                    break;
                }
            }
            Err(error) => forgive(error)?,
        }
    }
    Ok(best)
}

/// Time of a step without what is prepared once.
fn milliseconds(report: &StepReport) -> f64 {
    1e3 * (report.times.predict + report.times.solve + report.times.finish)
}
