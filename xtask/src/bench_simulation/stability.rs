//! Whether a cloth is ever torn apart by its solver.

use rayon::prelude::*;
use vivace_solver::{Budget, Forces, Relaxation, Solver, SolverError, System};

use super::scenes::{self, STEP};
use super::sweeps::{blocks, gauss_seidel, position_based};
use super::{Pools, Sizes};
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
const SETTINGS: [&str; 9] = [
    "SOR 1.7",
    "SOR 1.9",
    "Chebyshev-GS 0.99",
    "Chebyshev-GS 0.999",
    "symmetric Chebyshev-GS 0.999",
    "Chebyshev-Jacobi 0.99",
    "blocks SOR 1.5",
    "blocks Chebyshev-GS 0.99",
    "XPBD GS",
];

fn solver(name: &str) -> Solver {
    let sor = |omega| Solver { safeguard: true, ..gauss_seidel(omega) };
    let with = |relaxation| Solver { relaxation, ..sor(1.0) };
    let chebyshev = |rho| with(Relaxation::ChebyshevGaussSeidel { rho, delay: 0 });
    match name {
        "SOR 1.9" => sor(1.9),
        "Chebyshev-GS 0.99" => chebyshev(0.99),
        "Chebyshev-GS 0.999" => chebyshev(0.999),
        "symmetric Chebyshev-GS 0.999" => with(Relaxation::SymmetricChebyshev { rho: 0.999 }),
        "Chebyshev-Jacobi 0.99" => with(Relaxation::Chebyshev { rho: 0.99, gamma: 0.9, delay: 0 }),
        "blocks SOR 1.5" => blocks(sor(1.5)),
        "blocks Chebyshev-GS 0.99" => blocks(chebyshev(0.99)),
        "XPBD GS" => position_based(),
        _ => sor(1.7),
    }
}

/// All settings, stiffnesses and numbers of iterations; as many at once as there are threads.
pub(super) fn measure(sizes: &Sizes, pools: &Pools) -> Result<Vec<Fastest>, FigureError> {
    let (n_frames, iterations, stiffnesses) = &sizes.stability;
    let mut cases = Vec::new();
    for setting in SETTINGS {
        for &stiffness in stiffnesses {
            cases.extend(iterations.iter().map(|&n| (setting, stiffness, n)));
        }
    }
    let animate =
        |(setting, stiffness, iterations): (&'static str, f32, u32)| -> Result<Fastest, FigureError> {
            let (model, mut state) = scenes::cloth(sizes.cloths[0], stiffness, true)?;
            let mut system = System::new(model, solver(setting))?;
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

/// The worst of each setting \[m/s\], and how many cases passed `limit` \[m/s\].
pub(super) fn worst(all: &[Fastest], limit: f64) -> Vec<(&'static str, f64, usize)> {
    let of = |setting: &'static str| {
        let mine = all.iter().filter(|one| one.setting == setting);
        let fast = mine.clone().filter(|one| one.speed >= limit).count();
        (setting, mine.map(|one| one.speed).fold(0.0, f64::max), fast)
    };
    SETTINGS.map(of).to_vec()
}

/// A row for each setting, a column for each case.
pub(super) fn summary(all: &[Fastest]) -> Table {
    let mut table = Table::new("Largest speed [m/s], by stiffness [N/m] and iterations", &["setting"]);
    let first = |one: &&Fastest| one.setting == SETTINGS[0];
    table
        .columns
        .extend(all.iter().filter(first).map(|one| format!("{} / {}", one.stiffness, one.iterations)));
    for setting in SETTINGS {
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
