//! What each method survives: small scenes with one thing taken to its end.
//!
//! The columns of the data, `extremes.csv`, a row for each case and method: `group`, `case`, `method`, `verdict` (`converges`,
//! `bounded` or `fails`; of the group `bad input` `refused` or `taken`), `detail` (why it failed, or what was said in refusing), `left`
//! (movement of the last iteration of one more, long frame over that of its first iteration; empty for bad input).

pub mod cases;

use glam::Vec3;
use rayon::prelude::*;
use vivace_model::{Forces, ModelError, State};
use vivace_solver::{Budget, Relaxation, SolverError, System};

use crate::figures::simulation::methods::{Method, with_position_based};
use crate::figures::simulation::runs::size;
use crate::figures::{Context, FigureError};
use crate::report::{Figure, Table, Value};
use cases::Case;

/// How a case ended.
#[derive(Debug, Clone, PartialEq)]
pub enum Outcome {
    /// Never out of bounds; and in one more frame the iterations come to rest.
    Converges,
    /// Never out of bounds.
    Bounded,
    /// Numbers ran out, or a particle left the bounds.
    Fails(String),
}

impl Outcome {
    /// One word.
    pub fn word(&self) -> &'static str {
        match self {
            Self::Converges => "converges",
            Self::Bounded => "bounded",
            Self::Fails(_) => "fails",
        }
    }
}

/// What the words mean.
pub const DEFINITION: &str = "Fails: a step ended beyond the range of numbers, or a particle was farther from its start than 100 sizes of the scene and twice a free fall. Bounded: never that. Converges: bounded, and in one more frame iteration 400 moves the particles by less than 1/100 of what the first iteration did (or by less than a millionth of the scene\u{2019}s size).";

/// Iterations of the last frame.
const LONG: u32 = 400;

/// Plays a case with a method.
///
/// # Errors
/// What the solver refuses before the first step.
pub fn play(case: &Case, method: &Method) -> Result<(Outcome, f64), SolverError> {
    let mut solver = method.solver;
    if let Some(wanted) = case.omega {
        match &mut solver.relaxation {
            Relaxation::Jacobi { omega } | Relaxation::GaussSeidel { omega, .. } => *omega = wanted,
            _ => {}
        }
    }
    let mut system = System::new(case.model.clone(), solver)?;
    let forces = Forces::default();
    let mut state = case.state.clone();
    let scene = size(&state.positions).max(0.1);
    for frame in 1..=case.n_frames {
        if let Err(error) = system.step(&mut state, &forces, case.h, Budget::iterations(case.iterations)) {
            return Ok((Outcome::Fails(format!("frame {frame}: {error}")), f64::NAN));
        }
        let t = case.h * frame as f32;
        let far = reach(&case.state, &state);
        if !(0.0..=100.0 * scene + forces.gravity.length() * t * t).contains(&far) {
            return Ok((Outcome::Fails(format!("frame {frame}: a particle {far:.1e} m away")), f64::NAN));
        }
    }
    let long = |system: &mut System, iterations| {
        let budget = Budget { iterations: Some(iterations), tolerance: Some(0.0), seconds: None };
        system
            .step(&mut state.clone(), &forces, case.h, budget)
            .map(|report| report.last_move.map_or(f64::NAN, f64::from))
    };
    let (Ok(first), Ok(last)) = (long(&mut system, 1), long(&mut system, LONG)) else {
        return Ok((Outcome::Fails("the last frame ends beyond the range of numbers".to_owned()), f64::NAN));
    };
    let rests = last <= 0.01 * first || last <= 1e-6 * f64::from(scene);
    let left = if first > 0.0 { last / first } else { 0.0 };
    Ok((if rests { Outcome::Converges } else { Outcome::Bounded }, left))
}

/// How far the farthest particle is from its start \[m\]; NaN where it is nowhere.
fn reach(start: &State, state: &State) -> f32 {
    let distance = |(a, b): (&Vec3, &Vec3)| a.distance(*b);
    state
        .positions
        .iter()
        .zip(&start.positions)
        .map(distance)
        .fold(0.0, |a, b| if b >= a { b } else { a.max(b) })
}

/// Not a number, fed into frame 100: what is said, where it is refused with the particle's number, the state is left as it was, and the
/// frame after is that of a run that was fed nothing; what went wrong otherwise.
///
/// # Errors
/// What the solver refuses before the first step.
pub fn refuse_nan(case: &Case, method: &Method) -> Result<Result<String, String>, SolverError> {
    let (mut system, mut alone) =
        (System::new(case.model.clone(), method.solver)?, System::new(case.model.clone(), method.solver)?);
    let (forces, fed) = (Forces::default(), 7);
    let step = |system: &mut System, state: &mut State| {
        system.step(state, &forces, case.h, Budget::iterations(4)).map_err(|error| error.to_string())
    };
    let mut state = case.state.clone();
    let mut undisturbed = state.clone();
    let bits = |s: &State| -> Vec<[u32; 3]> {
        s.positions.iter().chain(&s.velocities).map(|v| v.to_array().map(f32::to_bits)).collect()
    };
    let mut play = || {
        for _ in 0..100 {
            step(&mut system, &mut state)?;
            step(&mut alone, &mut undisturbed)?;
        }
        let good = std::mem::replace(&mut state.positions[fed].y, f32::NAN);
        let before = bits(&state);
        let said = match system.step(&mut state, &forces, case.h, Budget::iterations(4)) {
            Err(error @ SolverError::Model(ModelError::NotFinite { particle, .. })) if particle == fed => {
                error.to_string()
            }
            Err(error) => return Err(format!("refused for another reason: {error}")),
            Ok(_) => return Err("no error".to_owned()),
        };
        if bits(&state) != before {
            return Err("the state has changed".to_owned());
        }
        state.positions[fed].y = good;
        step(&mut system, &mut state)?;
        step(&mut alone, &mut undisturbed)?;
        if bits(&state) == bits(&undisturbed) { Ok(said) } else { Err("it has left a trace".to_owned()) }
    };
    Ok(play())
}

/// The table of the report.
///
/// # Errors
/// What models and solvers refuse.
pub fn figure(context: &mut Context<'_>, command: &str) -> Result<Figure, FigureError> {
    context.progress.figure("extremes", 1);
    context.progress.step("all cases with all methods");
    let is_reduced = context.sizes.is_reduced;
    let figure = context.pool.install(|| make(command, is_reduced));
    context.progress.done();
    figure
}

/// Plays all cases with all methods, on the threads of the pool it is called in.
///
/// # Errors
/// What models and solvers refuse.
pub fn make(command: &str, reduced: bool) -> Result<Figure, FigureError> {
    let started = std::time::Instant::now();
    let (methods, cases) = (with_position_based(), cases::cases(reduced)?);
    let jobs: Vec<(&Case, &Method)> =
        cases.iter().flat_map(|case| methods.iter().map(move |m| (case, m))).collect();
    let played: Result<Vec<_>, SolverError> =
        jobs.par_iter().map(|(case, method)| play(case, method)).collect();
    let played = played?;
    let mut columns = vec!["What".to_owned(), "Case".to_owned()];
    columns.extend(methods.iter().map(|m| m.name.to_owned()));
    let mut table = Table { name: "Verdicts".to_owned(), columns, rows: Vec::new() };
    let mut data = Table::new("", &["group", "case", "method", "verdict", "detail", "left"]);
    for (case, outcomes) in cases.iter().zip(played.chunks(methods.len())) {
        let words = outcomes.iter().map(|(outcome, _)| Value::from(outcome.word()));
        table.push([case.group.into(), case.name.as_str().into()].into_iter().chain(words));
        for (method, (outcome, left)) in methods.iter().zip(outcomes) {
            let detail = if let Outcome::Fails(why) = outcome { Some(why.as_str()) } else { None };
            data.push([
                case.group.into(),
                case.name.as_str().into(),
                method.name.into(),
                outcome.word().into(),
                detail.into(),
                (*left).into(),
            ]);
        }
    }
    let case = cases::usual()?;
    let mut words = vec![case.group.into(), case.name.as_str().into()];
    let refused: Result<Vec<_>, SolverError> = methods.par_iter().map(|m| refuse_nan(&case, m)).collect();
    for (method, refused) in methods.iter().zip(refused?) {
        let (word, detail) = match refused {
            Ok(said) => ("refused", said),
            Err(why) => ("taken", why),
        };
        words.push(word.into());
        data.push([
            case.group.into(),
            case.name.as_str().into(),
            method.name.into(),
            word.into(),
            detail.into(),
            Value::from(None::<f64>),
        ]);
    }
    table.push(words);
    let summary = summary(&methods, &cases, &played);
    let caption = format!(
        "In short. {}\n\nEach case is a cloth of 12 x 12 particles or a beam of 4 x 2 x 2 cells with one thing taken to its end; where not said otherwise h = 1/30 s, 30 frames of 20 iterations, 100 N/m, 10\u{2075} Pa. {DEFINITION} Not a number, fed in at frame 100, is \u{201c}refused\u{201d} if the error names the particle, the state stays as it was bit by bit, and the frame after it is that of a run that was fed nothing. Methods named \u{201c}safe\u{201d} watch the objective; \u{3c9} is set in methods that have one.",
        first_to_fail(&methods, &played)
    );
    let mut figure = Figure::new("extremes", "Extremes: what each method survives", command, &caption)
        .table(summary)
        .table(table)
        .data(data);
    figure.seconds = Some(started.elapsed().as_secs_f64());
    Ok(figure)
}

fn count(played: &[(Outcome, f64)], n: usize, method: usize, word: &str) -> usize {
    played.iter().skip(method).step_by(n).filter(|(outcome, _)| outcome.word() == word).count()
}

fn first_to_fail(methods: &[Method], played: &[(Outcome, f64)]) -> String {
    let fails: Vec<usize> = (0..methods.len()).map(|m| count(played, methods.len(), m, "fails")).collect();
    let most = fails.iter().copied().max().unwrap_or(0);
    let names = |wanted: &dyn Fn(usize) -> bool| {
        let chosen = methods.iter().zip(&fails).filter(|(_, n)| wanted(**n)).map(|(m, _)| m.name);
        chosen.collect::<Vec<_>>().join(", ")
    };
    let never = names(&|n| n == 0);
    if most == 0 {
        return "No method failed in any case.".to_owned();
    }
    format!(
        "Never failed: {}. Gives up first: {} ({most} of {} cases).",
        if never.is_empty() { "none" } else { &never },
        names(&|n| n == most),
        played.len() / methods.len().max(1)
    )
}

fn summary(methods: &[Method], cases: &[Case], played: &[(Outcome, f64)]) -> Table {
    let columns = ["Method", "Converges", "Bounded", "Fails", "Fails where"];
    let mut table = Table::new("Cases by verdict", &columns);
    for (idx, method) in methods.iter().enumerate() {
        let n = methods.len();
        let own = played.iter().skip(idx).step_by(n);
        let failed = cases.iter().zip(own).filter(|(_, (outcome, _))| outcome.word() == "fails");
        let names: Vec<&str> = failed.map(|(case, _)| case.name.as_str()).collect();
        table.push([
            method.name.into(),
            count(played, n, idx, "converges").into(),
            count(played, n, idx, "bounded").into(),
            count(played, n, idx, "fails").into(),
            names.join("; ").into(),
        ]);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::simulation::methods::is_shipped;

    #[test]
    fn shipped_settings_never_fail() {
        let cases = cases::cases(true).unwrap();
        assert!(cases.len() > 20);
        for method in with_position_based().iter().filter(|m| is_shipped(m)) {
            for case in &cases {
                let (outcome, _) = play(case, method).unwrap();
                assert!(!matches!(outcome, Outcome::Fails(_)), "{}, {}: {outcome:?}", method.name, case.name);
            }
        }
    }

    #[test]
    fn what_is_not_a_number_is_refused() {
        let case = cases::usual().unwrap();
        for method in with_position_based().iter().filter(|m| is_shipped(m)) {
            let said = refuse_nan(&case, method).unwrap().unwrap();
            assert!(said.contains("particle 7:"), "{}: {said}", method.name);
        }
    }
}
