//! Frames of one large cloth, alone or with collisions, which never come to the host but at the end.

use std::path::Path;
use std::time::Instant;

use vivace_gpu::{Footprint, Gpu, KernelTime};
use vivace_mesh::cloth as cloths;
use vivace_model::{Forces, Model, ModelBuilder, State};
use vivace_scene::drape;
use vivace_solver::{Base, Budget, Collisions, Framework, Relaxation, Solver, SolverError, System};

use super::BenchError;
use super::kernels::{self, Copies};
use crate::figures::FigureError;
use crate::report::{Table, quantile};

/// Sweeps of a frame, as in the paper's tables.
const SWEEPS: u32 = 15;
const STEP: f32 = 1.0 / 60.0;
/// Frames that are timed.
const N_FRAMES: usize = 10;

/// The columns of [`frames`].
pub(super) fn table() -> Table {
    Table::new(
        "Frames of a cloth, 15 sweeps each",
        &[
            "constraints",
            "particles",
            "colors",
            "bytes",
            "ms",
            "ms_min",
            "kernels_ms",
            "dispatches",
            "us_per_dispatch",
            "updates_per_s",
            "note",
        ],
    )
}

/// What is simulated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Scene {
    /// A cloth that hangs on two corners.
    Cloth,
    /// A cloth that falls on a ball, and collides with it and with itself.
    Drape,
}

impl Scene {
    /// About so many constraints.
    fn build(self, n_constraints: usize) -> Result<(Model, State), FigureError> {
        match self {
            Self::Cloth => cloth(n_constraints),
            Self::Drape => Ok(drape(width(n_constraints / 2)).build(Path::new("."))?),
        }
    }

    /// Lets the model collide, if it does.
    fn collide(self, system: &mut System, state: &State) -> Result<(), SolverError> {
        let of = drape(width(state.positions.len() * 3)).collisions.filter(|_| self == Self::Drape);
        let Some(of) = of else { return Ok(()) };
        let mut collisions = Collisions::new(system.model(), &state.positions, of.options())?;
        // No files: a ball and the floor.
        collisions.obstacles_mut().extend(of.obstacles(Path::new(".")).unwrap_or_default());
        system.set_collisions(Some(collisions))
    }
}

/// Particles along a side of a square cloth of about so many springs: three a particle; the root, to the nearest number.
fn width(n_springs: usize) -> usize {
    (4 * n_springs / 3).isqrt().div_ceil(2).max(2)
}

/// A square cloth of springs of about so many constraints, two corners pinned.
fn cloth(n_constraints: usize) -> Result<(Model, State), FigureError> {
    let n = width(n_constraints);
    let mesh = cloths::regular(n, n, 1.0 / (n as f32 - 1.0))?;
    let mut builder = ModelBuilder::new();
    builder.cloth(&mesh, 0.2)?;
    builder.springs(0, &mesh.edges(), 1000.0)?;
    builder.pin(0)?;
    builder.pin(u32::try_from(n - 1).unwrap_or(u32::MAX))?;
    Ok(builder.build()?)
}

/// Plain sweeps, projections and all, with nobody looking in between.
fn solver() -> Solver {
    Solver {
        framework: Framework::FUSED,
        relaxation: Relaxation::GaussSeidel { omega: 1.0, base: Base::Latest },
        safeguard: false,
        ..Solver::default()
    }
}

fn frame(system: &mut System, state: &mut State) -> Result<(), SolverError> {
    system.step(state, &Forces::default(), STEP, Budget::iterations(SWEEPS)).map(drop)
}

/// What the frames of a model will have allocated on a device, without one.
fn bytes(scene: Scene, model: &Model, state: &State) -> Result<u64, SolverError> {
    let device = Footprint::new();
    let mut system = System::on(model.clone(), solver(), device.clone())?;
    scene.collide(&mut system, state)?;
    frame(&mut system, &mut state.clone())?;
    Ok(device.allocated())
}

/// Adds the frames of a cloth of about so many constraints; what the device refuses is noted.
pub(super) fn frames(
    scene: Scene,
    n_constraints: usize,
    copies: Copies,
    table: &mut Table,
    by_kernel: &mut Table,
) -> Result<(), BenchError> {
    let (model, state) = scene.build(n_constraints)?;
    let (n_constraints, n_particles) = (model.constraints().len(), model.n_particles());
    let bytes = bytes(scene, &model, &state).map_err(FigureError::from)?;
    let row = |colors: usize, numbers: [f64; 6], note: String| {
        let mut row = vec![n_constraints.into(), n_particles.into(), colors.into(), (bytes as f64).into()];
        row.extend(numbers.map(Into::into));
        row.push(note.into());
        row
    };
    let with = if scene == Scene::Drape { "falls on a ball, with collisions" } else { "" };
    match measured(scene, model, state) {
        Ok(run) => {
            let updates = (n_particles * SWEEPS as usize) as f64 / run.ms * 1e3;
            let kernels_ms = run.kernels.iter().map(|kernel| kernel.seconds * 1e3).sum();
            let us = run.ms * 1e3 / run.dispatches;
            let numbers = [run.ms, run.ms_min, kernels_ms, run.dispatches, us, updates];
            table.push(row(run.colors, numbers, with.to_owned()));
            let name = format!("frame of {n_constraints} constraints {with}");
            kernels::push(name.trim_end(), &run.kernels, copies, by_kernel);
            Ok(())
        }
        Err(SolverError::Device(error)) => {
            table.push(row(0, [f64::NAN; 6], format!("refused: {error}")));
            Ok(())
        }
        Err(error) => Err(FigureError::from(error).into()),
    }
}

struct Frames {
    colors: usize,
    ms: f64,
    ms_min: f64,
    dispatches: f64,
    /// Of one frame; none without a clock.
    kernels: Vec<KernelTime>,
}

fn measured(scene: Scene, model: Model, mut state: State) -> Result<Frames, SolverError> {
    let gpu = Gpu::new().map_err(|error| SolverError::Device(Box::new(error)))?;
    let mut system = System::on(model, solver(), gpu)?;
    scene.collide(&mut system, &state)?;
    // The first frames make pipelines and buffers; the ball is met after nine.
    let n_first = if scene == Scene::Drape { 20 } else { 2 };
    (0..n_first).try_for_each(|_| frame(&mut system, &mut state))?;
    let count = |system: &mut System| system.resident::<Gpu>().map_or(0, |at| at.backend.n_dispatches());
    let before = count(&mut system);
    let mut times = Vec::new();
    for _ in 0..N_FRAMES {
        let start = Instant::now();
        frame(&mut system, &mut state)?;
        times.push(start.elapsed().as_secs_f64() * 1e3);
    }
    let dispatches = (count(&mut system) - before) as f64 / N_FRAMES as f64;
    times.sort_by(f64::total_cmp);
    let kernels = profiled(&mut system, &mut state)?;
    Ok(Frames {
        colors: system.n_colors(),
        ms: quantile(&times, 0.5),
        ms_min: quantile(&times, 0.0),
        dispatches,
        kernels,
    })
}

/// The kernels of one more frame.
fn profiled(system: &mut System, state: &mut State) -> Result<Vec<KernelTime>, SolverError> {
    let is_timed = system.resident::<Gpu>().is_some_and(|at| at.backend.begin_profile().is_ok());
    frame(system, state)?;
    let Some(at) = system.resident::<Gpu>().filter(|_| is_timed) else { return Ok(Vec::new()) };
    let profile = at.backend.end_profile().map_err(|error| SolverError::Device(Box::new(error)))?;
    Ok(profile.kernels().to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cloths_have_about_so_many_constraints() {
        for n in [100, 1000, 10_000] {
            let (model, _) = cloth(n).unwrap();
            let found = model.constraints().springs.len();
            assert!(found.abs_diff(n) < n / 5, "{found} for {n}");
        }
    }

    #[test]
    fn bytes_grow_with_the_cloth() {
        let [small, large] = [100, 10_000].map(|n| {
            let (model, state) = cloth(n).unwrap();
            bytes(Scene::Cloth, &model, &state).unwrap()
        });
        assert!(large > small && large < 50_000_000, "{small} {large}");
    }
}
