//! Whether a cloth is ever torn apart by its solver.

use rayon::prelude::*;
use vivace_solver::{Budget, Forces, Solver, SolverError, System};

use super::scenes::{self, STEP};
use super::{Pools, Sizes, frames};
use crate::figures::FigureError;
use crate::report::{Table, Value};

/// The fastest that any particle was.
#[derive(Clone, Debug)]
pub(super) struct Fastest {
    pub(super) setting: &'static str,
    stiffness: f32,
    iterations: u32,
    /// \[m/s\], infinite if it diverged.
    pub(super) speed: f64,
}

/// What must hold: all with the safeguard, where it is more than a plain sweep.
const GUARDED: [&str; 12] = [
    "SOR 1.7, safeguard",
    "SOR 1.9, safeguard",
    "Chebyshev-GS 0.99, safeguard",
    "Chebyshev-GS 0.999, safeguard",
    "symmetric Chebyshev-GS 0.999, safeguard",
    "Chebyshev-Jacobi 0.99, safeguard",
    "blocks SOR 1.5, safeguard",
    "blocks SOR 1.9, safeguard",
    "blocks Chebyshev-GS 0.99, safeguard",
    "split SOR 1.9, 8 sweeps, safeguard",
    "split SOR 1.9, 16 sweeps, safeguard",
    "XPBD GS",
];

/// What need not: why there is a safeguard.
const UNGUARDED: [&str; 3] = ["SOR 1.5", "SOR 1.7", "SOR 1.9"];

fn names() -> impl Iterator<Item = &'static str> {
    GUARDED.into_iter().chain(UNGUARDED)
}

/// All settings, stiffnesses and numbers of iterations; as many at once as there are threads.
pub(super) fn measure(sizes: &Sizes, pools: &Pools) -> Result<Vec<Fastest>, FigureError> {
    let (n_frames, iterations, stiffnesses) = &sizes.stability;
    let settings = frames::settings();
    let mut cases = Vec::new();
    for name in names() {
        for setting in settings.iter().filter(|setting| setting.full_name() == name) {
            for &stiffness in stiffnesses {
                cases.extend(iterations.iter().map(|&n| (name, setting.solver, stiffness, n)));
            }
        }
    }
    let animate =
        |(setting, solver, stiffness, iterations): (&'static str, Solver, f32, u32)| -> Result<Fastest, FigureError> {
            let (model, mut state) = scenes::cloth(sizes.cloths[0], stiffness, true)?;
            let mut system = System::new(model, solver)?;
            let mut speed = 0.0_f64;
            for _ in 0..*n_frames {
                match system.step(&mut state, &Forces::default(), STEP, Budget::iterations(iterations)) {
                    Ok(_) => {}
                    Err(SolverError::Diverged { .. }) => speed = f64::INFINITY,
                    Err(other) => return Err(other.into()),
                }
                speed = state.velocities.iter().fold(speed, |most, v| most.max(f64::from(v.length())));
                // Long past any bound: what follows only takes time.
                if speed > 1e6 {
                    break;
                }
            }
            Ok(Fastest { setting, stiffness, iterations, speed })
        };
    pools.many.install(|| cases.into_par_iter().map(animate).collect())
}

/// What became of one setting.
pub(super) struct Worst {
    pub(super) setting: &'static str,
    /// Whether it must hold.
    pub(super) is_guarded: bool,
    /// \[m/s\].
    pub(super) speed: f64,
    /// How many cases passed the limit.
    pub(super) n_fast: usize,
}

/// The worst of each setting, the limit being `limit` \[m/s\].
pub(super) fn worst(all: &[Fastest], limit: f64) -> Vec<Worst> {
    let of = |setting: &'static str| {
        let mine = all.iter().filter(|one| one.setting == setting);
        let n_fast = mine.clone().filter(|one| one.speed >= limit).count();
        let speed = mine.map(|one| one.speed).fold(0.0, f64::max);
        Worst { setting, is_guarded: GUARDED.contains(&setting), speed, n_fast }
    };
    names().map(of).collect()
}

/// A row for each setting, a column for each case.
pub(super) fn summary(all: &[Fastest]) -> Table {
    let mut table = Table::new("Largest speed [m/s], by stiffness [N/m] and iterations", &["setting"]);
    let first = |one: &&Fastest| one.setting == GUARDED[0];
    table
        .columns
        .extend(all.iter().filter(first).map(|one| format!("{} / {}", one.stiffness, one.iterations)));
    for setting in names() {
        let speeds = all.iter().filter(|one| one.setting == setting).map(|one| Value::from(one.speed));
        table.push(std::iter::once(Value::from(setting)).chain(speeds));
    }
    table
}

/// A row for each case.
pub(super) fn table(all: &[Fastest]) -> Table {
    let mut table = Table::new("", &["setting", "stiffness", "iterations", "speed"]);
    for one in all {
        let row: [Value; 4] =
            [one.setting.into(), one.stiffness.into(), one.iterations.into(), one.speed.into()];
        table.push(row);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_is_a_setting_whose_error_is_measured() {
        let known: Vec<String> = frames::settings().iter().map(frames::Setting::full_name).collect();
        for name in names() {
            assert!(known.iter().any(|known| known == name), "{name}");
        }
    }
}
