//! The same simulation on a GPU. Needs an adapter, if a software one.

#![cfg(feature = "gpu")]

use vivace_sim::gpu::{Gpu, wgpu};
use vivace_sim::scene::tablecloth;
use vivace_sim::{
    Backend, Budget, Framework, LocalStep, Relaxation, SimError, Simulation, Snapshot, Solver, SolverError,
    Vec3, VertexSolve, Wind,
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
