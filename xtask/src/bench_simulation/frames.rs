//! What is left of one frame's error after so many milliseconds.

use vivace_solver::reference::{Answer, Reference, ReferenceState};
use vivace_solver::{Budget, Forces, Model, Preconditioner, Relaxation, Rho, Solver, State, System};

use super::scenes::{self, STEP};
use super::sweeps::{blocks, gauss_seidel, position_based, split};
use super::{Pools, Sizes};
use crate::figures::FigureError;
use crate::report::{Table, Value};

/// What kind of method a setting is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Sweeps and their acceleration.
    Relaxation,
    /// A factor, made before.
    Direct,
    /// Shown for reference.
    Reference,
    /// The solver of others.
    Rival,
}

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Self::Relaxation => "relaxation",
            Self::Direct => "direct",
            Self::Reference => "reference",
            Self::Rival => "rival",
        }
    }
}

/// A setting with its name.
pub(super) struct Setting {
    name: String,
    kind: Kind,
    pub(super) solver: Solver,
}

impl Setting {
    /// The name, and whether it is watched.
    pub(super) fn full_name(&self) -> String {
        full_name(&self.name, self.solver.safeguard)
    }
}

fn full_name(name: &str, has_safeguard: bool) -> String {
    format!("{name}{}", if has_safeguard { ", safeguard" } else { "" })
}

/// Error of one setting after one budget.
#[derive(Clone, Debug)]
pub(super) struct Left {
    /// Of the springs \[N/m\].
    pub(super) stiffness: f32,
    pub(super) setting: String,
    pub(super) has_safeguard: bool,
    pub(super) kind: Kind,
    pub(super) ms_per_iteration: f64,
    /// The budget \[ms\].
    pub(super) ms: f64,
    pub(super) iterations: u32,
    /// NaN where the solver diverged.
    pub(super) error: f64,
    pub(super) backoffs: u32,
}

impl Left {
    /// The setting, and whether it is watched.
    pub(super) fn name(&self) -> String {
        full_name(&self.setting, self.has_safeguard)
    }
}

/// All settings that are compared.
pub(super) fn settings() -> Vec<Setting> {
    let mut all = Vec::new();
    let mut push = |name: String, kind, safeguard, relaxation, base: Solver| {
        all.push(Setting { name, kind, solver: Solver { relaxation, safeguard, ..base } });
    };
    let diagonal = gauss_seidel(1.0);
    let chebyshev = |rho| Relaxation::ChebyshevGaussSeidel { rho: Rho::Given(rho), delay: 0 };
    let sor = |omega| gauss_seidel(omega).relaxation;
    use Kind::{Direct, Reference, Relaxation as Relaxed};
    push("Jacobi 2/3".into(), Relaxed, false, Relaxation::Jacobi { omega: 2.0 / 3.0 }, diagonal);
    for rho in [0.99, 0.999, 0.9992] {
        let relaxation = Relaxation::Chebyshev { rho: Rho::Given(rho), gamma: 0.9, delay: 0 };
        push(format!("Chebyshev-Jacobi {rho}"), Relaxed, true, relaxation, diagonal);
    }
    push("GS".into(), Relaxed, false, sor(1.0), diagonal);
    for omega in [1.7, 1.9] {
        push(format!("SOR {omega}"), Relaxed, true, sor(omega), diagonal);
    }
    for omega in [1.5, 1.7, 1.9] {
        push(format!("SOR {omega}"), Relaxed, false, sor(omega), diagonal);
    }
    for rho in [0.99, 0.995, 0.998, 0.999, 0.9995] {
        push(format!("Chebyshev-GS {rho}"), Relaxed, true, chebyshev(rho), diagonal);
    }
    push("Chebyshev-GS 0.999".into(), Relaxed, false, chebyshev(0.999), diagonal);
    for rho in [0.99, 0.999] {
        let relaxation = Relaxation::SymmetricChebyshev { rho: Rho::Given(rho) };
        push(format!("symmetric Chebyshev-GS {rho}"), Relaxed, true, relaxation, diagonal);
    }
    push("blocks GS".into(), Relaxed, false, sor(1.0), blocks(diagonal));
    for omega in [1.3, 1.5, 1.7, 1.9] {
        push(format!("blocks SOR {omega}"), Relaxed, true, sor(omega), blocks(diagonal));
    }
    push("blocks SOR 1.5".into(), Relaxed, false, sor(1.5), blocks(diagonal));
    for rho in [0.9, 0.95, 0.99, 0.995, 0.998, 0.999] {
        push(format!("blocks Chebyshev-GS {rho}"), Relaxed, true, chebyshev(rho), blocks(diagonal));
    }
    for sweeps in [4, 8, 16] {
        push(format!("split SOR 1.9, {sweeps} sweeps"), Relaxed, true, sor(1.9), split(sweeps));
        for rho in [0.99, 0.999, 0.9995] {
            let name = format!("split Chebyshev-GS {rho}, {sweeps} sweeps");
            push(name, Relaxed, true, chebyshev(rho), split(sweeps));
        }
    }
    push("XPBD GS".into(), Relaxed, false, sor(1.0), position_based());
    for (preconditioner, inner, name) in [
        (Preconditioner::Jacobi, 10, "CG (Jacobi), 10 inner"),
        (Preconditioner::SymmetricGaussSeidel, 10, "CG (symmetric GS), 10 inner"),
    ] {
        let relaxation = Relaxation::ConjugateGradient { preconditioner, inner };
        push(name.into(), Reference, false, relaxation, split(1));
    }
    push("direct".into(), Direct, false, Relaxation::Direct, diagonal);
    all
}

/// Every setting at every budget, for two stiffnesses.
pub(super) fn measure(sizes: &Sizes, pools: &Pools) -> Result<Vec<Left>, FigureError> {
    let mut all = Vec::new();
    for stiffness in [100.0, 10.0] {
        let (model, start) = scenes::cloth(sizes.cloths[0], stiffness, true)?;
        let (state, answer) = target(&model, &start, sizes.frames_before)?;
        let mut systems = Vec::new();
        for setting in settings() {
            let system = System::new(model.clone(), setting.solver)?;
            systems.push((setting, system, f64::INFINITY));
        }
        for _ in 0..sizes.runs.div_ceil(3) {
            for (setting, system, least) in &mut systems {
                let ms = pools.one.install(|| time(system, &state, setting))?;
                *least = least.min(ms);
            }
        }
        for (setting, system, ms_per_iteration) in &mut systems {
            for &ms in &sizes.budgets {
                let iterations = fitting(ms, *ms_per_iteration);
                let (error, backoffs) = pools.one.install(|| error(system, &state, &answer, iterations))?;
                all.push(Left {
                    stiffness,
                    setting: setting.name.clone(),
                    has_safeguard: setting.solver.safeguard,
                    kind: setting.kind,
                    ms_per_iteration: *ms_per_iteration,
                    ms,
                    iterations,
                    error,
                    backoffs,
                });
            }
        }
        #[cfg(feature = "rapier")]
        all.extend(super::rapier::errors(sizes, stiffness, (&model, &start), &state, &answer));
    }
    Ok(all)
}

/// How many iterations of `each` \[ms\] fit into `ms`, at least one.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates; times are positive")]
pub(super) fn fitting(ms: f64, each: f64) -> u32 {
    ((ms / each) as u32).clamp(1, 100_000)
}

/// The state after `n` converged frames, and the answer of the next.
fn target(model: &Model, start: &State, n: u32) -> Result<(State, Answer), FigureError> {
    let mut reference = Reference::new(model, f64::from(STEP))?;
    let forces = Forces::default();
    let mut exact = ReferenceState::from(start);
    for _ in 0..n {
        reference.step(&mut exact, &forces)?;
    }
    let state = State {
        positions: exact.positions.iter().map(|q| q.as_vec3()).collect(),
        velocities: exact.velocities.iter().map(|v| v.as_vec3()).collect(),
    };
    let answer = reference.solve(&state, &forces)?;
    Ok((state, answer))
}

/// Time of an iteration with its share of all that a step needs beside set-up \[ms\].
fn time(system: &mut System, state: &State, setting: &Setting) -> Result<f64, FigureError> {
    let n = if setting.kind == Kind::Relaxation { 40 } else { 4 };
    let mut state = state.clone();
    // One that diverges takes as long as any.
    let report = system.step(&mut state, &Forces::default(), STEP, Budget::iterations(n)).unwrap_or_default();
    let times = report.times;
    let seconds = times.predict + times.solve + times.finish;
    let ms = seconds * 1e3 / f64::from(n);
    Ok(if ms > 0.0 { ms } else { f64::INFINITY })
}

fn error(
    system: &mut System,
    state: &State,
    answer: &Answer,
    iterations: u32,
) -> Result<(f64, u32), FigureError> {
    // What earlier steps taught the safeguard is forgotten.
    system.set_solver(system.solver())?;
    let mut state = state.clone();
    match system.step(&mut state, &Forces::default(), STEP, Budget::iterations(iterations)) {
        Ok(report) => Ok((answer.error(&state.positions), report.backoffs)),
        Err(vivace_solver::SolverError::Diverged { .. }) => Ok((f64::NAN, 0)),
        Err(other) => Err(other.into()),
    }
}

/// The best of a kind after a budget.
pub(super) fn best<'a>(
    all: impl IntoIterator<Item = &'a Left>,
    stiffness: f32,
    ms: f64,
    kind: Kind,
) -> Option<&'a Left> {
    all.into_iter()
        .filter(|left| left.stiffness == stiffness && left.ms == ms && left.kind == kind)
        .filter(|left| !left.error.is_nan())
        .min_by(|a, b| a.error.total_cmp(&b.error))
}

/// A row for each setting and budget.
pub(super) fn table(all: &[Left]) -> Table {
    let columns = [
        "stiffness",
        "setting",
        "safeguard",
        "kind",
        "ms_per_iteration",
        "ms",
        "iterations",
        "error",
        "backoffs",
    ];
    let mut table = Table::new("", &columns);
    for left in all {
        let row: [Value; 9] = [
            left.stiffness.into(),
            left.setting.as_str().into(),
            left.has_safeguard.into(),
            left.kind.name().into(),
            left.ms_per_iteration.into(),
            left.ms.into(),
            left.iterations.into(),
            left.error.into(),
            left.backoffs.into(),
        ];
        table.push(row);
    }
    table
}

/// The best setting of each kind, for each budget.
pub(super) fn winners(all: &[Left], budgets: &[f64]) -> Table {
    let mut table = Table::new("Least error of one frame", &["stiffness", "ms", "kind", "setting", "error"]);
    for stiffness in [100.0, 10.0] {
        for &ms in budgets {
            for kind in [Kind::Relaxation, Kind::Direct, Kind::Reference, Kind::Rival] {
                if let Some(left) = best(all, stiffness, ms, kind) {
                    let row: [Value; 5] = [
                        stiffness.into(),
                        ms.into(),
                        kind.name().into(),
                        left.name().into(),
                        left.error.into(),
                    ];
                    table.push(row);
                }
            }
        }
    }
    table
}
