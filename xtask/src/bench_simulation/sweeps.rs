//! Time per iteration of every kind of sweep.

use std::time::Instant;

use rayon::ThreadPool;
use rayon::prelude::*;
use vivace_solver::{
    Base, Budget, Forces, Framework, LocalStep, Model, Relaxation, Solver, State, System, VertexSolve,
};

use super::factor;
use super::plain::Plain;
use super::scenes::{self, Material, STEP};
use super::times::{Reading, Times};
use super::{Pools, Sizes};
use crate::figures::FigureError;

/// Plain Gauss-Seidel by Projective Dynamics.
pub(super) fn gauss_seidel(omega: f32) -> Solver {
    let relaxation = Relaxation::GaussSeidel { omega, base: Base::Latest };
    Solver { framework: Framework::FUSED, relaxation, substeps: 1, safeguard: false }
}

/// As `solver`, with blocks of 3 × 3.
pub(super) fn blocks(solver: Solver) -> Solver {
    let (local, vertex) = (LocalStep::Fused, VertexSolve::Block);
    Solver { framework: Framework::ProjectiveDynamics { local, vertex }, ..solver }
}

/// A local step, then so many sweeps.
pub(super) fn split(sweeps: u32) -> Solver {
    let (local, vertex) = (LocalStep::Split { sweeps }, VertexSolve::Diagonal);
    Solver { framework: Framework::ProjectiveDynamics { local, vertex }, ..gauss_seidel(1.0) }
}

/// Position Based Dynamics.
pub(super) fn position_based() -> Solver {
    Solver { framework: Framework::PositionBased, ..gauss_seidel(1.0) }
}

/// A local step and then only sweeps: there is one for all iterations that are timed.
const FROZEN: u32 = 100_000;

/// rapier's iterations: a substep with new directions and one sweep, and one more sweep.
pub(super) const SUBSTEP: &str = "rapier3d, substep";
/// See [`SUBSTEP`].
pub(super) const SWEEP: &str = "rapier3d, sweep";

/// Time of an iteration \[ms\].
type Timing = dyn FnMut(&ThreadPool) -> Result<f64, FigureError>;

/// What is timed.
pub(super) struct Task {
    workload: &'static str,
    name: &'static str,
    /// Whether it has any use for more than one thread.
    is_parallel: bool,
    time: Box<Timing>,
}

impl Task {
    fn new(
        workload: &'static str,
        name: &'static str,
        (model, start): &(Model, State),
        solver: Solver,
        iterations: u32,
    ) -> Result<Self, FigureError> {
        let mut system = System::new(model.clone(), solver)?;
        let start = start.clone();
        let time = move |pool: &ThreadPool| {
            let (forces, mut state) = (Forces::default(), start.clone());
            let report = pool.install(|| {
                // A few that warm up.
                system.step(&mut state, &forces, STEP, Budget::iterations(2))?;
                system.step(&mut state, &forces, STEP, Budget::iterations(iterations))
            })?;
            Ok(report.times.solve * 1e3 / f64::from(report.iterations.max(1)))
        };
        Ok(Self { workload, name, is_parallel: true, time: Box::new(time) })
    }

    /// What others do on A, on the thread that calls.
    pub(super) fn of_others(name: &'static str, mut time: impl FnMut() -> f64 + 'static) -> Self {
        Self { workload: "A", name, is_parallel: false, time: Box::new(move |_| Ok(time())) }
    }
}

/// All tasks in turns on every pool, PLAIN among them.
fn in_turns(
    tasks: &mut [Task],
    plain: &mut Plain,
    pools: &Pools,
    runs: u32,
    times: &mut Times,
) -> Result<(), FigureError> {
    for _ in 0..runs {
        for (pool, n_threads) in pools.all() {
            times.push(Times::PLAIN.0, Times::PLAIN.1, 1, plain.time());
            for task in tasks.iter_mut().filter(|task| task.is_parallel || n_threads == 1) {
                times.push(task.workload, task.name, n_threads, (task.time)(pool)?);
            }
        }
    }
    Ok(())
}

/// Workload A.
pub(super) fn cloth(sizes: &Sizes, pools: &Pools, times: &mut Times) -> Result<(), FigureError> {
    let scene = scenes::cloth(sizes.cloths[0], 100.0, true)?;
    let springs = scenes::cloth(sizes.cloths[0], 100.0, false)?;
    let fast = gauss_seidel(1.7);
    let safe = Solver { safeguard: true, ..fast };
    let direct = Solver { relaxation: Relaxation::Direct, ..gauss_seidel(1.0) };
    let mut tasks = vec![
        Task::new("A", "PD fused", &scene, gauss_seidel(1.0), 50)?,
        Task::new("A", "PD blocks", &scene, blocks(gauss_seidel(1.0)), 20)?,
        Task::new("A", "PD split", &scene, split(1), 50)?,
        Task::new("A", "PD linear sweep", &scene, split(FROZEN), 50)?,
        Task::new("A", "PD fused, springs only", &springs, gauss_seidel(1.0), 50)?,
        Task::new("A", "XPBD, springs only", &springs, position_based(), 50)?,
        Task::new("A", "XPBD", &scene, position_based(), 20)?,
        Task::new("A", "SOR of 10 iterations", &scene, fast, 10)?,
        Task::new("A", "SOR of 10 iterations, safeguard", &scene, safe, 10)?,
        Task::new("A", "SOR of 50 iterations", &scene, fast, 50)?,
        Task::new("A", "SOR of 50 iterations, safeguard", &scene, safe, 50)?,
        Task::new("A", "PD direct", &scene, direct, 4)?,
    ];
    let mut plain = Plain::new(&scene.0, STEP)?;
    tasks.push(factor::task(&plain)?);
    #[cfg(feature = "rapier")]
    tasks.extend(super::rapier::tasks(&scene));
    in_turns(&mut tasks, &mut plain, pools, sizes.runs, times)
}

/// Workload B.
pub(super) fn bar(sizes: &Sizes, pools: &Pools, times: &mut Times) -> Result<(), FigureError> {
    let volume = scenes::bar(sizes.bar, Material::EdgesAndVolume)?;
    let strain = scenes::bar(sizes.bar, Material::Strain)?;
    let kept = scenes::bar(sizes.bar, Material::Volume)?;
    let mut tasks = vec![
        Task::new("B", "XPBD edges and volume", &volume, position_based(), 10)?,
        Task::new("B", "PD strain, split", &strain, split(1), 10)?,
        Task::new("B", "PD strain, linear sweep", &strain, split(FROZEN), 20)?,
        Task::new("B", "PD strain, fused", &strain, gauss_seidel(1.0), 2)?,
        Task::new("B", "PD strain, split, stretched", &scenes::stretched(&strain), split(1), 4)?,
        Task::new("B", "PD volume, split, stretched", &scenes::stretched(&kept), split(1), 4)?,
        Task::new("B", "PD volume, linear sweep", &kept, split(FROZEN), 20)?,
    ];
    let mut plain = Plain::new(&scenes::cloth(sizes.cloths[0], 100.0, true)?.0, STEP)?;
    in_turns(&mut tasks, &mut plain, pools, sizes.runs, times)
}

/// A sweep's share of the bandwidth of memory.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bandwidth {
    pub(super) n_threads: usize,
    /// Of a copy \[GB/s\].
    pub(super) copy: f64,
    /// Of a sweep \[GB/s\].
    pub(super) sweep: Reading,
}

/// The large cloths.
pub(super) fn large(sizes: &Sizes, pools: &Pools, times: &mut Times) -> Result<Vec<Bandwidth>, FigureError> {
    let runs = (sizes.runs / 3).max(1);
    let mut plain = Plain::new(&scenes::cloth(sizes.cloths[0], 100.0, true)?.0, STEP)?;
    let scene = scenes::cloth(sizes.cloths[1], 100.0, true)?;
    let mut tasks = [
        Task::new("large cloth", "PD fused", &scene, gauss_seidel(1.0), 10)?,
        Task::new("large cloth", "PD linear sweep", &scene, split(FROZEN), 10)?,
    ];
    in_turns(&mut tasks, &mut plain, pools, runs, times)?;
    if sizes.cloths[2] == 0 {
        return Ok(Vec::new());
    }
    drop(tasks);
    let scene = scenes::cloth(sizes.cloths[2], 100.0, true)?;
    let name = "PD linear sweep";
    let bytes = sweep_bytes(&scene.0)?;
    let mut task = Task::new("huge cloth", name, &scene, split(FROZEN), 10)?;
    let mut copied = vec![Vec::new(); 2];
    let mut memory = (vec![1.0_f32; COPIED / 4], vec![0.0_f32; COPIED / 4]);
    for _ in 0..runs {
        for ((pool, n_threads), copied) in pools.all().zip(&mut copied) {
            copied.push(copy(pool, &mut memory));
            times.push("huge cloth", name, n_threads, (task.time)(pool)?);
            copied.push(copy(pool, &mut memory));
        }
    }
    let of = |((_, n_threads), copied): ((&ThreadPool, usize), &Vec<f64>)| Bandwidth {
        n_threads,
        copy: copied.iter().copied().fold(0.0, f64::max),
        sweep: times.ms("huge cloth", name, n_threads).map(|ms| bytes / (ms * 1e6)),
    };
    Ok(pools.all().zip(&copied).map(of).collect())
}

/// What a linear sweep must at least move: each entry's weight; each row's diagonal, weight, anchor and pull; q, read once and written
/// once. Columns, of which most runs of eight entries need one, do not count, nor that neighbors are read again for each color, nor the
/// buffer between threads.
fn sweep_bytes(model: &Model) -> Result<f64, FigureError> {
    const ENTRY: usize = 4;
    const ROW: usize = 4 + 4 + 12 + 12 + 12 + 12;
    Ok((model.graph()?.csr().len() * ENTRY + model.n_particles() * ROW) as f64)
}

/// Bytes of what is copied.
const COPIED: usize = 1 << 27;

/// Bandwidth of a copy, read and written \[GB/s\].
fn copy(pool: &ThreadPool, (from, to): &mut (Vec<f32>, Vec<f32>)) -> f64 {
    let piece = from.len().div_ceil(pool.current_num_threads());
    let start = Instant::now();
    pool.install(|| {
        to.par_chunks_mut(piece).zip(from.par_chunks(piece)).for_each(|(to, from)| to.copy_from_slice(from));
    });
    let seconds = start.elapsed().as_secs_f64();
    std::hint::black_box(to);
    2.0 * COPIED as f64 / seconds / 1e9
}
