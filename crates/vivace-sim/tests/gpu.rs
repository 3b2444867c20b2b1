//! The same simulation on a GPU. Needs an adapter, if a software one.

#![cfg(feature = "gpu")]

use std::path::Path;

use vivace_sim::gpu::{Gpu, wgpu};
use vivace_sim::scene::tablecloth;
use vivace_sim::{
    Backend, Budget, Framework, LocalStep, Relaxation, SimError, Simulation, Snapshot, Solver, SolverError,
    Vec3, VertexSolve, Wind, device_bytes,
};

fn play(simulation: &mut Simulation, n_frames: u32, iterations: u32) {
    for _ in 0..n_frames {
        simulation.step(Budget::iterations(iterations)).expect("a frame");
    }
}

/// The largest distance after 20 frames of a tablecloth in the wind \[m\].
fn apart(solver: Solver, backend: Backend) -> f32 {
    let mut on_cpu = Simulation::new(&tablecloth(16), solver).expect("a tablecloth");
    let mut on_gpu = Simulation::new_on(&tablecloth(16), solver, backend).expect("a small tablecloth");
    for simulation in [&mut on_cpu, &mut on_gpu] {
        simulation.forces_mut().wind = Some(Wind { velocity: Vec3::new(0.5, 0.0, 2.0), drag: 0.2 });
        play(simulation, 20, 20);
    }
    assert_eq!((on_gpu.frame(), on_gpu.time()), (20, on_cpu.time()));
    let pairs = on_cpu.positions().iter().zip(on_gpu.positions());
    pairs.map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
}

/// Roundings of 10⁻⁷ m grow as the cloth folds: a millimeter of its 1 m after 20 frames.
#[test]
fn a_tablecloth_hangs_as_on_the_cpu() {
    let of = |local, vertex| Framework::ProjectiveDynamics { local, vertex };
    let blocks = of(LocalStep::Fused, VertexSolve::Block);
    for framework in [Framework::default(), Framework::FUSED, blocks, Framework::PositionBased] {
        let solver = Solver { framework, ..Solver::default() };
        let apart = apart(solver, Backend::gpu().unwrap());
        assert!(apart < 1e-3, "{apart} m apart by {solver:?}");
    }
}

#[test]
fn the_callers_device_does() {
    let (device, queue) = pollster::block_on(async {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
        let adapter = instance.request_adapter(&wgpu::RequestAdapterOptions::default()).await.unwrap();
        adapter.request_device(&wgpu::DeviceDescriptor::default()).await.unwrap()
    });
    assert!(apart(Solver::default(), Backend::gpu_from_device(device, queue).unwrap()) < 1e-3);
}

#[test]
fn a_snapshot_resumes_bit_for_bit() {
    let new = || {
        let gpu = Gpu::new().unwrap();
        Simulation::new_on(&tablecloth(12), Solver::default(), gpu.into()).unwrap()
    };
    let (mut whole, mut resumed) = (new(), new());
    let mut text = String::new();
    for frame in 0..6 {
        if frame == 3 {
            text = whole.snapshot().to_json().unwrap();
        }
        whole.step(Budget::iterations(12)).unwrap();
    }
    resumed.restore(&Snapshot::from_json(&text).unwrap()).unwrap();
    play(&mut resumed, 3, 12);
    assert_eq!(resumed.state(), whole.state());
}

fn new_there(n: usize) -> Simulation {
    Simulation::new_on(&tablecloth(n), Solver::default(), Backend::gpu().expect("a device"))
        .expect("a simulation")
}

/// Frames that the host does not see are those that it would have seen; what it reads aside is of the frame that it asked in.
#[test]
fn frames_that_nobody_sees_are_the_same() {
    let (mut seen, mut unseen) = (new_there(12), new_there(12));
    let mut pending = Vec::new();
    for _ in 0..4 {
        seen.step(Budget::iterations(12)).unwrap();
        unseen.advance(Budget::iterations(12)).unwrap();
        pending.push((unseen.read_positions().unwrap(), seen.positions().to_vec()));
    }
    assert_eq!(unseen.positions(), Simulation::new(&tablecloth(12), Solver::default()).unwrap().positions());
    assert_eq!(unseen.snapshot().frame, 0, "as the host has seen it");
    for (pending, expected) in pending {
        assert_eq!(pending.wait().unwrap(), expected);
    }
    unseen.sync().unwrap();
    assert_eq!((unseen.state(), unseen.frame()), (seen.state(), 4));
    assert_eq!(unseen.snapshot(), seen.snapshot());
    // A step, another solver and another state go on from where it is.
    let fused = Solver { framework: Framework::FUSED, ..Solver::default() };
    for simulation in [&mut seen, &mut unseen] {
        let state = simulation.state().clone();
        simulation.step(Budget::iterations(12)).unwrap();
        simulation.set_solver(fused).unwrap();
        simulation.step(Budget::iterations(12)).unwrap();
        simulation.set_state(state).unwrap();
    }
    seen.step(Budget::iterations(12)).unwrap();
    unseen.advance(Budget::iterations(12)).unwrap();
    unseen.step(Budget::iterations(12)).unwrap();
    seen.step(Budget::iterations(12)).unwrap();
    assert_eq!(unseen.state(), seen.state());
    assert_eq!(unseen.read_positions().unwrap().try_read().unwrap().as_deref(), Some(seen.positions()));
}

/// What has gone wrong where nobody looked takes the simulation back to what the host has seen.
#[test]
fn what_is_lost_unseen_is_told_when_looked_at() {
    let mut simulation = new_there(8);
    simulation.step(Budget::iterations(4)).unwrap();
    let before = simulation.snapshot();
    simulation.advance(Budget::iterations(4)).unwrap();
    simulation.forces_mut().gravity = Vec3::splat(1e38);
    simulation.advance(Budget::iterations(4)).unwrap();
    let error = simulation.sync().unwrap_err();
    assert!(matches!(error, SimError::Solver(SolverError::Diverged { .. })), "{error}");
    simulation.forces_mut().gravity = before.forces.gravity;
    assert_eq!(simulation.snapshot(), before);
    simulation.advance(Budget::iterations(4)).unwrap();
    simulation.sync().unwrap();
    assert_eq!(simulation.frame(), 2);
}

/// On the CPU nothing is out of sight.
#[test]
fn the_cpu_sees_what_it_advances() {
    let mut simulation = Simulation::new(&tablecloth(6), Solver::default()).unwrap();
    simulation.advance(Budget::iterations(3)).unwrap();
    assert_eq!(simulation.read_positions().unwrap().wait().unwrap(), simulation.positions());
    assert!(simulation.resident().is_none() && simulation.snapshot().frame == 1);
}

#[test]
fn bytes_are_known_before_a_device_is_asked() {
    let position_based = Solver { framework: Framework::PositionBased, ..Solver::default() };
    let direct = Solver { relaxation: Relaxation::Direct, ..Solver::default() };
    for (solver, iterations) in [(Solver::default(), 12), (position_based, 3), (direct, 2)] {
        let budget = Budget::iterations(iterations);
        let bytes = device_bytes(&tablecloth(20), Path::new("."), solver, budget).unwrap();
        let mut simulation = Simulation::new_on(&tablecloth(20), solver, Backend::gpu().unwrap()).unwrap();
        for _ in 0..2 {
            simulation.step(budget).unwrap();
            assert_eq!(simulation.resident().unwrap().backend.allocated(), bytes, "{solver:?}");
        }
    }
}

#[test]
fn what_is_not_done_there_is_refused() {
    let solver = Solver { relaxation: Relaxation::Lexicographic { omega: 1.0 }, ..Solver::default() };
    let refused = Simulation::new_on(&tablecloth(4), solver, Backend::gpu().unwrap());
    assert!(matches!(refused, Err(SimError::Solver(SolverError::NotOnDevice { .. }))));
}

/// Wherever it runs, it may move to another thread, and be looked at from several.
#[test]
fn simulations_may_be_shared() {
    fn shared<T: Send + Sync>() {}
    shared::<Simulation>();
}
