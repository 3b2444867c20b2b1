//! Frames of one large cloth, alone or with collisions, which never come to the host but at the end.

use std::path::Path;
use std::time::Instant;

use vivace_coloring::Vivace;
use vivace_gpu::{Footprint, Gpu, Grids, KernelTime};
use vivace_kernels::Backend;
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
            "scene",
            "constraints",
            "particles",
            "recolored",
            "colors",
            "bytes",
            "ms",
            "ms_min",
            "ms_resident",
            "kernels_ms",
            "dispatches",
            "us_per_dispatch",
            "updates_per_s",
            "note",
        ],
    )
}

/// Constraints, about, of cloths that are solved directly: the paper's tablecloth, its noodles. The factor of its heap is more than a
/// device binds at once.
pub(super) const DIRECT: [usize; 2] = [60_000, 160_000];

/// What is timed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Case {
    /// Constraints, about.
    pub(super) n_constraints: usize,
    /// Whether half of them are hinges, as in the paper's cloths, and not all springs.
    pub(super) has_hinges: bool,
    /// Whether each frame colors anew, and who says how large its classes are.
    pub(super) recoloring: Option<Grids>,
    /// Whether each iteration solves with a factor, in place of a sweep.
    pub(super) is_direct: bool,
    /// Whether the cloth falls on a ball, and collides with it and with itself; else it hangs on two corners.
    pub(super) is_drape: bool,
}

/// The paper's heap of cloths: its constraints, recolored in every frame or not.
pub(super) fn heap() -> [Case; 3] {
    let case = |recoloring| Case { has_hinges: true, recoloring, ..Case::springs(324_000) };
    [None, Some(Grids::Indirect), Some(Grids::Bounds)].map(case)
}

impl Case {
    /// A cloth of springs that keeps its coloring.
    pub(super) fn springs(n_constraints: usize) -> Self {
        Self { n_constraints, has_hinges: false, recoloring: None, is_direct: false, is_drape: false }
    }

    /// A cloth of springs and hinges with collisions.
    pub(super) fn drape(n_constraints: usize) -> Self {
        Self { has_hinges: true, is_drape: true, ..Self::springs(n_constraints) }
    }

    /// A cloth of springs and hinges, by the direct solver.
    pub(super) fn direct(n_constraints: usize) -> Self {
        Self { has_hinges: true, is_direct: true, ..Self::springs(n_constraints) }
    }

    fn scene(self) -> &'static str {
        match self {
            Self { is_drape: true, .. } => "falls on a ball, with collisions",
            Self { is_direct: true, .. } => "springs and hinges, direct solves",
            Self { has_hinges: true, .. } => "springs and hinges",
            _ => "springs",
        }
    }

    fn recolored(self) -> &'static str {
        self.recoloring.map_or("no", super::measure::name)
    }

    fn build(self) -> Result<(Model, State), FigureError> {
        if self.is_drape {
            Ok(drape(width(self.n_constraints / 2)).build(Path::new("."))?)
        } else {
            cloth(self)
        }
    }

    /// Lets the model collide, if it does.
    fn collide(self, system: &mut System, state: &State) -> Result<(), SolverError> {
        let of = drape(width(state.positions.len() * 3)).collisions.filter(|_| self.is_drape);
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

/// A square cloth of about so many constraints, two corners pinned.
fn cloth(case: Case) -> Result<(Model, State), FigureError> {
    // As many hinges as springs.
    let n = width(if case.has_hinges { case.n_constraints / 2 } else { case.n_constraints });
    let mesh = cloths::regular(n, n, 1.0 / (n as f32 - 1.0))?;
    let mut builder = ModelBuilder::new();
    builder.cloth(&mesh, 0.2)?;
    builder.springs(0, &mesh.edges(), 1000.0)?;
    if case.has_hinges {
        builder.hinges(0, &mesh.hinges(), 1e-5, false)?;
    }
    builder.pin(0)?;
    builder.pin(u32::try_from(n - 1).unwrap_or(u32::MAX))?;
    Ok(builder.build()?)
}

/// Plain sweeps, projections and all, or a local step and a solve; with nobody looking in between.
fn solver(case: Case) -> Solver {
    let sweep = Relaxation::GaussSeidel { omega: 1.0, base: Base::Latest };
    Solver {
        framework: Framework::FUSED,
        relaxation: if case.is_direct { Relaxation::Direct } else { sweep },
        safeguard: false,
        ..Solver::default()
    }
}

fn frame(system: &mut System, state: &mut State) -> Result<(), SolverError> {
    system.step(state, &Forces::default(), STEP, Budget::iterations(SWEEPS)).map(drop)
}

/// The model on a device.
fn system<B: Backend + Send + 'static>(
    model: &Model,
    state: &State,
    case: Case,
    backend: B,
) -> Result<System, SolverError> {
    let mut system = System::on(model.clone(), solver(case), backend)?;
    case.collide(&mut system, state)?;
    system.set_recoloring(case.recoloring.map(|_| Vivace::DEFAULT))?;
    Ok(system)
}

/// What the frames of a model will have allocated on a device, without one.
fn bytes(model: &Model, state: &State, case: Case) -> Result<u64, SolverError> {
    let device = Footprint::new();
    let mut system = system(model, state, case, device.clone())?;
    // Lists of a frame go when the next has its own.
    frame(&mut system, &mut state.clone())?;
    frame(&mut system, &mut state.clone())?;
    Ok(device.allocated())
}

/// Adds the frames of a cloth of about so many constraints; what the device refuses is noted.
pub(super) fn frames(
    case: Case,
    copies: Copies,
    table: &mut Table,
    by_kernel: &mut Table,
) -> Result<(), BenchError> {
    let (model, state) = case.build()?;
    let (n_constraints, n_particles) = (model.constraints().len(), model.n_particles());
    let bytes = bytes(&model, &state, case).map_err(FigureError::from)?;
    let row = |colors: usize, numbers: [f64; 7], note: String| {
        let mut row = vec![
            case.scene().into(),
            n_constraints.into(),
            n_particles.into(),
            case.recolored().into(),
            colors.into(),
            (bytes as f64).into(),
        ];
        row.extend(numbers.map(Into::into));
        row.push(note.into());
        row
    };
    match measured(&model, state, case) {
        Ok(run) => {
            let updates = (n_particles * SWEEPS as usize) as f64 / run.ms_resident * 1e3;
            let kernels_ms = run.kernels.iter().map(|kernel| kernel.seconds * 1e3).sum();
            let us = run.ms_resident * 1e3 / run.dispatches;
            let numbers = [run.ms, run.ms_min, run.ms_resident, kernels_ms, run.dispatches, us, updates];
            table.push(row(run.colors, numbers, String::new()));
            let (scene, recolored) = (case.scene(), case.recolored());
            let work = format!("frame of {n_constraints} {scene}, recolored: {recolored}");
            kernels::push(&work, &run.kernels, copies, by_kernel);
            Ok(())
        }
        Err(SolverError::Device(error)) => {
            table.push(row(0, [f64::NAN; 7], format!("refused: {error}")));
            Ok(())
        }
        Err(error) => Err(FigureError::from(error).into()),
    }
}

struct Frames {
    colors: usize,
    ms: f64,
    ms_min: f64,
    /// Without reading back.
    ms_resident: f64,
    dispatches: f64,
    /// Of one frame; none without a clock.
    kernels: Vec<KernelTime>,
}

fn measured(model: &Model, mut state: State, case: Case) -> Result<Frames, SolverError> {
    let gpu = Gpu::new().map_err(|error| SolverError::Device(Box::new(error)))?;
    let mut system = system(model, &state, case, gpu.with_grids(case.recoloring.unwrap_or_default()))?;
    // The first frames make pipelines and buffers; the ball is met after nine.
    let n_first = if case.is_drape { 20 } else { 2 };
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
    let mut resident = Vec::new();
    for _ in 0..N_FRAMES {
        let start = Instant::now();
        system.advance(&Forces::default(), STEP, Budget::iterations(SWEEPS))?;
        let waited = system.resident::<Gpu>().map_or(Ok(()), |at| at.backend.wait());
        waited.map_err(|error| SolverError::Device(Box::new(error)))?;
        resident.push(start.elapsed().as_secs_f64() * 1e3);
    }
    resident.sort_by(f64::total_cmp);
    system.store(&mut state)?;
    let kernels = profiled(&mut system, &mut state)?;
    Ok(Frames {
        colors: system.n_colors(),
        ms: quantile(&times, 0.5),
        ms_min: quantile(&times, 0.0),
        ms_resident: quantile(&resident, 0.5),
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
        for (has_hinges, least) in [(false, 100), (true, 1000)] {
            for n in [least, 10 * least, 100 * least] {
                let (model, _) = cloth(Case { has_hinges, ..Case::springs(n) }).unwrap();
                let found = model.constraints().len();
                assert!(found.abs_diff(n) < n / 4, "{found} for {n}");
            }
        }
    }

    #[test]
    fn bytes_grow_with_the_cloth() {
        let [small, large] = [100, 10_000].map(|n| {
            let case = Case::springs(n);
            let (model, state) = cloth(case).unwrap();
            bytes(&model, &state, case).unwrap()
        });
        assert!(large > small && large < 50_000_000, "{small} {large}");
    }
}
