//! A coloring anew in every frame, on the device.

use vivace_coloring::Vivace;
use vivace_cpu::Cpu;
use vivace_gpu::{Gpu, Grids};
use vivace_kernels::Backend;
use vivace_model::{Forces, State};
use vivace_solver::{Budget, Framework, Relaxation, Solver, SolverError, System};
use vivace_tests::naive::Naive;
use vivace_tests::scenes::{Bodies, STEP, Scene, cloth, gauss_seidel, jitter, plain, projective_dynamics};

use crate::gpu;

/// Where some frames end that are colored anew, or not.
fn frames<B: Backend + Send + 'static>(
    backend: B,
    scene: &Scene,
    solver: Solver,
    recoloring: Option<Vivace>,
    iterations: u32,
) -> State {
    let (model, mut state) = scene.clone();
    let mut system = System::on(model, solver, backend).expect("a device");
    system.set_recoloring(recoloring).expect("a device");
    for _ in 0..4 {
        system.step(&mut state, &Forces::default(), STEP, Budget::iterations(iterations)).expect("a device");
    }
    state
}

fn distance(a: &State, b: &State) -> f32 {
    a.positions.iter().zip(&b.positions).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
}

fn scene() -> Scene {
    let mut scene = Bodies { cloth: 9, bar: [3, 1, 1], ..Bodies::default() }.build();
    jitter(&scene.0, &mut scene.1, 0.002, 1);
    scene
}

/// Each class sees nothing of itself (the naive backend refuses what does), and all devices sweep in the same order.
#[test]
fn frames_colored_anew_are_the_same_everywhere() {
    let scene = scene();
    for framework in projective_dynamics() {
        let solver = Solver { framework, ..plain(gauss_seidel(1.4)) };
        let options = Some(Vivace { seed: 3, ..Vivace::DEFAULT });
        let expected = frames(Cpu::new(), &scene, solver, options, 6);
        assert_eq!(frames(Naive::default(), &scene, solver, options, 6), expected, "{framework:?}");
        let apart = distance(&frames(gpu(), &scene, solver, options, 6), &expected);
        assert!(apart < 1e-5, "{apart} m: {framework:?}");
        // Another seed, another order.
        let other = frames(Cpu::new(), &scene, solver, Some(Vivace { seed: 9, ..Vivace::DEFAULT }), 6);
        assert_ne!(other, expected, "{framework:?}");
        assert_ne!(frames(Cpu::new(), &scene, solver, None, 6), expected, "{framework:?}");
    }
}

/// Whatever the order, sweeps end where the objective is least.
#[test]
fn another_order_ends_in_the_same_place() {
    let scene = cloth(8, 100.0, Some(1e-5));
    let solver = Solver { framework: Framework::FUSED, ..plain(gauss_seidel(1.0)) };
    let once = frames(Cpu::new(), &scene, solver, None, 400);
    let anew = frames(Cpu::new(), &scene, solver, Some(Vivace::DEFAULT), 400);
    let apart = distance(&once, &anew);
    assert!(apart < 1e-4, "{apart} m");
}

/// A coloring that does not end within its rounds is not taken: the frame has that of the system. (A palette of one color without a rule
/// for conflicts never ends.)
#[test]
fn a_coloring_that_is_none_is_not_taken() {
    let conflict = vivace_coloring::ConflictRule::None;
    let endless = Vivace { shrink: f32::INFINITY, conflict, ..Vivace::DEFAULT };
    let scene = cloth(8, 100.0, Some(1e-5));
    let solver = Solver { framework: Framework::FUSED, ..plain(gauss_seidel(1.4)) };
    let expected = frames(Cpu::new(), &scene, solver, None, 6);
    assert_eq!(frames(Cpu::new(), &scene, solver, Some(endless), 6), expected);
    let device = gpu();
    let is_software = device.is_software();
    let there = frames(device, &scene, solver, Some(endless), 6);
    assert!(distance(&there, &expected) < 1e-5 && (!is_software || there == expected));
}

/// Two runs a round, seven more for the rest and the sort, and no byte more from frame to frame. The host never looks.
#[test]
fn its_cost_is_known() {
    for grids in [Grids::Indirect, Grids::Bounds] {
        let (model, state) = cloth(40, 100.0, Some(1e-5));
        let solver = Solver { framework: Framework::FUSED, ..plain(gauss_seidel(1.0)) };
        let mut system = System::on(model, solver, gpu().with_grids(grids)).unwrap();
        let count = |system: &mut System| {
            let gpu = system.resident::<Gpu>().unwrap().backend;
            (gpu.n_dispatches(), gpu.allocated(), gpu.n_looks())
        };
        let frame = |system: &mut System| {
            let before = count(system);
            system.advance(&Forces::default(), STEP, Budget::iterations(15)).unwrap();
            let after = count(system);
            (after.0 - before.0, after.1 - before.1, after.2 - before.2)
        };
        system.load(&state).unwrap();
        frame(&mut system);
        let n_colors = system.n_colors() as u64;
        assert_eq!(frame(&mut system), (3 + 15 * n_colors, 0, 0), "{grids:?}");
        system.set_recoloring(Some(Vivace::DEFAULT)).unwrap();
        frame(&mut system);
        frame(&mut system);
        let n_classes = system.n_colors() as u64;
        // Palettes of six particles' neighbors, what is fed, and some to spare: many are empty.
        assert!((n_colors..16).contains(&n_classes), "{n_classes} for {n_colors}");
        assert_eq!(frame(&mut system), (3 + 2 * 20 + 7 + 15 * n_classes, 0, 0), "{grids:?}");
    }
}

#[test]
fn where_it_cannot_be_it_is_refused() {
    let (model, _) = cloth(6, 100.0, None);
    let based = Solver { framework: Framework::PositionBased, ..Solver::default() };
    let refused = |mut system: System| {
        let error = system.set_recoloring(Some(Vivace::DEFAULT)).unwrap_err();
        assert!(matches!(error, SolverError::NoRecoloring { .. }), "{error}");
        system.set_recoloring(None).unwrap();
    };
    refused(System::new(model.clone(), Solver::default()).unwrap());
    refused(System::on(model.clone(), based, Cpu::new()).unwrap());
    refused(System::on(model, plain(Relaxation::Jacobi { omega: 0.5 }), Cpu::new()).unwrap());
}
