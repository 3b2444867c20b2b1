//! Whole frames on the GPU: against the same kernels on the CPU, bit for bit where the adapter rounds alike, and against the CPU's own
//! engine, which adds up in another order.

#![expect(clippy::unwrap_used, reason = "what fails here fails a test")]

use glam::Vec3;
use vivace_cpu::Cpu;
use vivace_gpu::{Footprint, Gpu, GpuError, wgpu};
use vivace_kernels::Backend;
use vivace_model::{Forces, State, Wind};
use vivace_solver::{
    Budget, Ease, Framework, PinMove, Relaxation, Rho, Solver, SolverError, StepReport, System,
};
use vivace_tests::naive::Naive;
use vivace_tests::scenes::{
    Bodies, Kind, STEP, Scene, cloth, gauss_seidel, jitter, linear_relaxations, plain, projective_dynamics,
    relaxations,
};

use crate::gpu;

/// Relaxations that a device does, in every framework that it does.
fn solvers() -> Vec<Solver> {
    let is_parallel = |relaxation: &Relaxation| !matches!(relaxation, Relaxation::Lexicographic { .. });
    let relaxations: Vec<_> = relaxations().into_iter().filter(is_parallel).collect();
    let with =
        |framework| relaxations.iter().map(move |&relaxation| Solver { framework, ..plain(relaxation) });
    projective_dynamics()
        .into_iter()
        .flat_map(with)
        .chain(linear_relaxations().into_iter().map(plain))
        .collect()
}

/// What acts, with wind or without.
fn forces(is_windy: bool) -> Forces {
    let wind = Some(Wind { velocity: Vec3::new(1.0, 0.5, -4.0), drag: 0.3 });
    Forces { wind: wind.filter(|_| is_windy), damping: 0.1, ..Forces::default() }
}

/// Where three frames of nine iterations end, and what the last of them reports.
fn frames(system: &mut System, mut state: State, forces: &Forces) -> (State, StepReport) {
    system.set_measuring(true);
    let mut report = StepReport::default();
    for _ in 0..3 {
        let budget = Budget::tolerance(0.0).and_iterations(9);
        report = system.step(&mut state, forces, STEP, budget).unwrap();
    }
    (state, report)
}

fn on<B: Backend + Send + 'static>(
    backend: B,
    scene: &Scene,
    solver: Solver,
    forces: &Forces,
) -> (State, StepReport) {
    frames(&mut System::on(scene.0.clone(), solver, backend).unwrap(), scene.1.clone(), forces)
}

/// A system on the GPU, which keeps its pipelines from solver to solver.
fn on_gpu(scene: &Scene) -> System {
    System::on(scene.0.clone(), plain(gauss_seidel(1.0)), gpu()).unwrap()
}

/// The largest distance \[m\].
fn distance(a: &State, b: &State) -> f32 {
    a.positions.iter().zip(&b.positions).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
}

/// What differs between a scene's frames on the GPU and elsewhere. Bound of positions: 2·10⁻⁴ m over three frames of nine iterations in
/// scenes of 1 m; a rounding of 10⁻⁷ m in a position is one of 3·10⁻⁶ m/s in a velocity.
fn mismatch(
    system: &mut System,
    scene: &Scene,
    solver: Solver,
    is_windy: bool,
    is_exact: bool,
) -> Option<String> {
    const BOUND: f32 = 2e-4;
    let rounds_alike =
        system.resident::<Gpu>().is_some_and(|at| at.backend.is_software()) && !is_windy && is_exact;
    let forces = forces(is_windy);
    system.set_solver(solver).unwrap();
    let (on_gpu, report) = frames(system, scene.1.clone(), &forces);
    let (on_cpu, of_cpu) = on(Cpu::new(), scene, solver, &forces);
    if rounds_alike && on_gpu != on_cpu {
        return Some(format!("{} m from the same kernels on the CPU", distance(&on_gpu, &on_cpu)));
    }
    let host = frames(&mut System::new(scene.0.clone(), solver).unwrap(), scene.1.clone(), &forces);
    for (other, reported, who) in [(&on_cpu, &of_cpu, "the kernels"), (&host.0, &host.1, "the engine")] {
        let apart = distance(&on_gpu, other);
        if apart.is_nan() || apart > BOUND {
            return Some(format!("{apart} m from {who} on the CPU"));
        }
        let pairs = [
            (report.objective, reported.objective, 1e-3),
            (report.residual, reported.residual, 2e-2),
            (report.last_move.map(f64::from), reported.last_move.map(f64::from), 2e-2),
        ];
        for (k, (a, b, bound)) in pairs.into_iter().enumerate() {
            let (a, b) = (a.unwrap(), b.unwrap());
            if (a - b).abs() > bound * b.abs() + 1e-6 {
                return Some(format!("measure {k} is {a} here and {b} by {who}"));
            }
        }
    }
    assert_ne!(on_gpu.positions, scene.1.positions);
    None
}

/// Particles on springs of their own and pinned ones, taken, led and let go.
fn lead(mut system: System, mut state: State) -> State {
    let budget = Budget::iterations(10);
    for frame in 0..5 {
        let mut model = system.model().clone();
        match frame {
            1 => {
                model.pin(60).unwrap();
                model.replace_attachments(0, &[(20, state.positions[20] + Vec3::Y * 0.1, 300.0)]).unwrap();
                system.set_model(model).unwrap();
            }
            2 => system.replace_attachments(0, &[(21, Vec3::new(0.5, 0.2, 0.5), 200.0)]).unwrap(),
            4 => {
                model.unpin(60).unwrap();
                system.set_model(model).unwrap();
                system.replace_attachments(0, &[]).unwrap();
            }
            _ => {}
        }
        if (1..4).contains(&frame) {
            let from = state.positions[60];
            system.move_pins(&[PinMove { particle: 60, from, to: from + Vec3::Y * 0.01 }]).unwrap();
        }
        system.step(&mut state, &Forces::default(), STEP, budget).unwrap();
    }
    state
}

#[test]
fn what_is_led_moves_as_on_the_cpu() {
    for solver in solvers() {
        let solver = Solver { substeps: 2, ..solver };
        let (model, state) = cloth(8, 100.0, Some(1e-5));
        let on_gpu = lead(System::on(model.clone(), solver, gpu()).unwrap(), state.clone());
        let on_host = lead(System::new(model, solver).unwrap(), state);
        let apart = distance(&on_gpu, &on_host);
        assert!(apart < 2e-4, "{apart} m from the engine on the CPU by {solver:?}");
    }
}

#[test]
fn every_relaxation_moves_every_kind_as_on_the_cpu() {
    for bodies in Kind::alone_and_together() {
        let mut scene = Bodies { cloth: 7, bar: [3, 1, 1], ..bodies.clone() }.build();
        jitter(&scene.0, &mut scene.1, 0.002, 1);
        // Drivers put sums of matrices in another order: see `kinds.rs`.
        let has_matrix =
            |kind: &Kind| matches!(kind, Kind::TriangleStrain | Kind::TetStrain | Kind::TetVolume);
        let is_exact = !bodies.kinds.iter().any(has_matrix);
        let mut system = on_gpu(&scene);
        for solver in solvers() {
            assert_eq!(
                mismatch(&mut system, &scene, solver, false, is_exact),
                None,
                "{:?} {solver:?}",
                bodies.kinds
            );
        }
    }
}

#[test]
fn larger_cloth_moves_as_on_the_cpu() {
    let scene = cloth(40, 100.0, Some(1e-5));
    let mut system = on_gpu(&scene);
    for framework in projective_dynamics() {
        let solver = Solver { framework, ..plain(gauss_seidel(1.5)) };
        for is_windy in [false, true] {
            assert_eq!(mismatch(&mut system, &scene, solver, is_windy, true), None, "{solver:?}");
            let solver = Solver { safeguard: true, substeps: 3, ..solver };
            assert_eq!(mismatch(&mut system, &scene, solver, is_windy, true), None, "{solver:?}");
        }
    }
}

/// Frames of a cloth that is thrown about, by iterations alone or with a host that looks after each.
fn guarded(system: &mut System, scene: &Scene, solver: Solver, is_seen: bool) -> (State, Ease, u32) {
    system.set_solver(solver).unwrap();
    let (mut state, mut n_backoffs) = (scene.1.clone(), 0);
    for iterations in [3, 12, 40, 40, 9, 20] {
        let budget = Budget::iterations(iterations);
        let budget = if is_seen { budget.and_tolerance(0.0) } else { budget };
        let report = system.step(&mut state, &Forces::default(), STEP, budget).unwrap();
        n_backoffs += report.backoffs;
        assert!(report.iterations == iterations || is_seen && report.last_move == Some(0.0));
    }
    (state, system.ease(), n_backoffs)
}

/// The safeguard decides on the device what it decides where the host looks: the same positions, bit for bit, and as many steps back.
#[test]
fn the_safeguard_decides_alike_wherever_it_is() {
    let mut scene = cloth(14, 100.0, Some(1e-4));
    jitter(&scene.0, &mut scene.1, 0.02, 3);
    let mut all = Vec::new();
    let frameworks = projective_dynamics().into_iter().chain([Framework::PositionBased]);
    for framework in frameworks {
        for relaxation in relaxations().into_iter().chain([
            gauss_seidel(1.97),
            Relaxation::Chebyshev { rho: Rho::Given(0.9999), gamma: 1.0, delay: 0 },
            Relaxation::ChebyshevGaussSeidel { rho: Rho::Given(0.9999), delay: 0 },
        ]) {
            let is_serial = matches!(relaxation, Relaxation::Lexicographic { .. });
            if !is_serial {
                all.push(Solver { framework, relaxation, substeps: 1, safeguard: true });
            }
        }
    }
    let mut n_backoffs = 0;
    let (mut there, model) = (on_gpu(&scene), scene.0.clone());
    let mut here = System::on(model, plain(gauss_seidel(1.0)), Cpu::new()).unwrap();
    for solver in all {
        for system in [&mut here, &mut there] {
            let [seen, unseen] = [true, false].map(|is_seen| guarded(system, &scene, solver, is_seen));
            assert_eq!(unseen, seen, "{solver:?}");
            n_backoffs += seen.2;
        }
    }
    assert!(n_backoffs > 20, "{n_backoffs} are too few to see");
}

/// What the safeguard has learned goes with a simulation: from a host that looks to one that does not, by small steps, and into another.
#[test]
fn what_the_safeguard_knows_is_passed_on() {
    let mut scene = cloth(10, 100.0, Some(1e-4));
    jitter(&scene.0, &mut scene.1, 0.02, 3);
    let relaxation = Relaxation::ChebyshevGaussSeidel { rho: Rho::Given(0.9999), delay: 0 };
    let solver = Solver { relaxation, substeps: 2, ..Solver::default() };
    let played = |backend_changes: [bool; 6]| {
        let new = || System::on(scene.0.clone(), solver, Cpu::new()).unwrap();
        let (mut system, mut state) = (new(), scene.1.clone());
        for (frame, is_seen) in (0..).zip(backend_changes) {
            if frame == 3 {
                let ease = system.ease();
                system = new();
                system.set_ease(ease);
            }
            let budget = Budget::iterations(25);
            let budget = if is_seen { budget.and_tolerance(0.0) } else { budget };
            system.step(&mut state, &Forces::default(), STEP, budget).unwrap();
        }
        (state, system.ease())
    };
    let expected = played([true; 6]);
    assert_ne!(expected.1, Ease::default());
    for k in 0..4 {
        assert_eq!(played([0, 1, 2, 3, 4, 5].map(|frame| frame % 4 == k || frame == 2 * k)), expected, "{k}");
    }
}

/// The naive backend refuses kernels that read what the same run writes.
#[test]
fn a_color_sees_nothing_of_itself() {
    let mut scene = Bodies { cloth: 4, bar: [2, 1, 1], ..Bodies::default() }.build();
    jitter(&scene.0, &mut scene.1, 0.002, 1);
    for solver in solvers() {
        let naive = on(Naive::default(), &scene, solver, &forces(true));
        let serial = on(Cpu::serial(), &scene, solver, &forces(true));
        assert_eq!(naive.0, serial.0, "{solver:?}");
    }
}

/// Dispatches of one frame that is not the first.
fn n_dispatches(scene: &Scene, solver: Solver, budget: Budget) -> (u64, u64, u64) {
    let (model, mut state) = scene.clone();
    let mut system = System::on(model, solver, gpu()).unwrap();
    let mut step = |system: &mut System| {
        system.step(&mut state, &Forces::default(), STEP, budget).unwrap();
        let gpu = system.resident::<Gpu>().unwrap().backend;
        (gpu.n_dispatches(), gpu.allocated())
    };
    let first = step(&mut system);
    let second = step(&mut system);
    let allocated = second.1 - first.1;
    (second.0 - first.0, allocated, u64::try_from(system.n_colors()).unwrap())
}

/// Predict, anchor and velocities are one dispatch each, a sweep is one for each color, and each kind that needs a pass adds one to
/// where it is asked.
#[test]
fn a_scene_pays_for_what_it_holds() {
    let budget = Budget::iterations(4);
    let [fused, split, blocks] =
        projective_dynamics().map(|framework| Solver { framework, ..plain(gauss_seidel(1.0)) });
    for bodies in Kind::alone_and_together() {
        let scene = Bodies { cloth: 7, bar: [3, 1, 1], ..bodies.clone() }.build();
        let is_pass = |kind: &&Kind| !matches!(kind, Kind::Spring | Kind::FlatHinge | Kind::Attachment);
        let n_passes = bodies.kinds.iter().filter(is_pass).count() as u64;
        for (solver, of_color, of_local_step) in [
            (fused, if n_passes == 0 { 1 } else { 2 + n_passes }, 0),
            (blocks, 3 + 2 * n_passes, 0),
            // Three sweeps to a local step: two of them in four.
            (split, 1, 2 * (1 + 2 * n_passes)),
        ] {
            let (n, allocated, n_colors) = n_dispatches(&scene, solver, budget);
            assert_eq!(n, 3 + of_local_step + 4 * n_colors * of_color, "{:?} {solver:?}", bodies.kinds);
            assert_eq!(allocated, 0, "{:?} {solver:?}", bodies.kinds);
        }
    }
}

/// Nor with everything that looks.
#[test]
fn later_frames_allocate_nothing() {
    let scene = Bodies { cloth: 7, bar: [3, 1, 1], ..Bodies::default() }.build();
    for solver in solvers() {
        let solver = Solver { safeguard: true, substeps: 2, ..solver };
        for budget in [Budget::iterations(12), Budget::tolerance(0.0).and_iterations(12)] {
            assert_eq!(n_dispatches(&scene, solver, budget).1, 0, "{solver:?}");
        }
    }
}

/// What is dragged, put elsewhere or solved otherwise goes on from there, as on the CPU.
#[test]
fn what_the_host_changes_is_seen() {
    fn played<B: Backend + Send + 'static>(backend: B) -> State {
        let (model, mut state) =
            Bodies { kinds: vec![Kind::Spring, Kind::Attachment], ..Bodies::default() }.build();
        let mut system = System::on(model, plain(gauss_seidel(1.2)), backend).unwrap();
        let step = |system: &mut System, state: &mut State| {
            system.step(state, &Forces::default(), STEP, Budget::iterations(5)).unwrap();
        };
        step(&mut system, &mut state);
        system.set_attachment_target(1, Vec3::new(0.0, 0.5, 0.0)).unwrap();
        step(&mut system, &mut state);
        state.positions[20] += Vec3::new(0.0, 0.1, 0.0);
        step(&mut system, &mut state);
        let solver =
            Solver { framework: projective_dynamics()[1], ..plain(Relaxation::Jacobi { omega: 0.6 }) };
        system.set_solver(solver).unwrap();
        step(&mut system, &mut state);
        system.step(&mut state, &Forces::default(), 0.5 * STEP, Budget::iterations(5)).unwrap();
        state
    }
    let device = gpu();
    let is_software = device.is_software();
    let (on_gpu, on_cpu) = (played(device), played(Cpu::new()));
    assert!(distance(&on_gpu, &on_cpu) < 1e-4);
    assert!(!is_software || on_gpu == on_cpu);
}

#[test]
fn what_is_serial_is_refused_with_a_word_of_what_is_not() {
    let (model, _) = cloth(4, 100.0, None);
    let serial = plain(Relaxation::Lexicographic { omega: 1.0 });
    let error = System::on(model.clone(), serial, gpu()).unwrap_err();
    assert!(matches!(error, SolverError::NotOnDevice { .. }), "{error}");
    assert!(error.to_string().contains("Gauss-Seidel"), "{error}");
    let mut system = System::on(model, plain(gauss_seidel(1.0)), gpu()).unwrap();
    let refused = system.set_solver(serial);
    assert!(matches!(refused, Err(SolverError::NotOnDevice { .. })));
    assert_eq!(system.solver(), plain(gauss_seidel(1.0)));
}

/// A lost device is told by every step from then on; the state is that of the last frame.
#[test]
fn a_lost_device_leaves_the_last_state() {
    let (model, mut state) = cloth(10, 100.0, None);
    let solver = Solver { safeguard: true, ..plain(gauss_seidel(1.9)) };
    let mut system = System::on(model, solver, gpu()).unwrap();
    let step = |system: &mut System, state: &mut State| {
        system.step(state, &Forces::default(), STEP, Budget::iterations(10))
    };
    step(&mut system, &mut state).unwrap();
    let (before, ease) = (state.clone(), system.ease());
    system.resident::<Gpu>().unwrap().backend.device().destroy();
    for _ in 0..2 {
        let error = step(&mut system, &mut state).unwrap_err();
        let SolverError::Device(error) = error else { panic!("{error}") };
        assert!(matches!(error.downcast_ref(), Some(GpuError::Lost(_))), "{error}");
        assert_eq!((&state, system.ease()), (&before, ease));
    }
}

/// What does not fit is refused when the system is made.
#[test]
fn a_scene_too_large_is_refused() {
    let limits = wgpu::Limits { max_storage_buffer_binding_size: 1 << 14, ..wgpu::Limits::default() };
    let (device, queue) = crate::device::device(limits);
    let error = System::on(
        cloth(40, 1.0, None).0,
        plain(gauss_seidel(1.0)),
        Gpu::from_device(device, queue).unwrap(),
    );
    let Err(SolverError::Device(error)) = error else { panic!("16 KiB are enough") };
    assert!(matches!(error.downcast_ref(), Some(GpuError::TooLarge { limit: 0x4000, .. })), "{error}");
}

/// A step whose end is no state leaves the last one, and the next step begins there.
#[test]
fn a_diverged_step_changes_nothing() {
    let (model, mut state) = cloth(6, 100.0, None);
    let mut system = System::on(model, plain(gauss_seidel(1.0)), gpu()).unwrap();
    let step = |system: &mut System, state: &mut State, gravity: Vec3| {
        let forces = Forces { gravity, ..Forces::default() };
        system.step(state, &forces, STEP, Budget::iterations(3)).map(|_| ())
    };
    let mut other = System::on(system.model().clone(), plain(gauss_seidel(1.0)), gpu()).unwrap();
    let mut undisturbed = state.clone();
    step(&mut system, &mut state, Vec3::NEG_Y).unwrap();
    let before = state.clone();
    let error = step(&mut system, &mut state, Vec3::splat(1e38)).unwrap_err();
    assert!(matches!(error, SolverError::Diverged { .. }), "{error}");
    assert_eq!(state, before);
    step(&mut system, &mut state, Vec3::NEG_Y).unwrap();
    (0..2).for_each(|_| step(&mut other, &mut undisturbed, Vec3::NEG_Y).unwrap());
    assert_eq!(state, undisturbed);
}

/// A scene's bytes are known before a device is asked for them, and frames after the first take no more.
#[test]
fn memory_of_frames_is_known_before_it_is_taken() {
    let scene = cloth(20, 100.0, Some(1e-4));
    for solver in [Solver::default(), plain(gauss_seidel(1.0)), plain(gauss_seidel(1.9))] {
        let device = Footprint::new();
        frames(
            &mut System::on(scene.0.clone(), solver, device.clone()).unwrap(),
            scene.1.clone(),
            &forces(true),
        );
        let mut system = System::on(scene.0.clone(), solver, gpu()).unwrap();
        for _ in 0..2 {
            frames(&mut system, scene.1.clone(), &forces(true));
            let allocated = system.resident::<Gpu>().unwrap().backend.allocated();
            assert_eq!(allocated, device.allocated(), "{solver:?}");
        }
    }
}

/// Frames that the host does not see, then one that it does; and positions where they lie.
fn unseen(mut system: System, state: &mut State) -> System {
    let nothing = system.advance(&forces(true), STEP, Budget::iterations(6)).unwrap_err();
    assert!(matches!(nothing, SolverError::NoState), "{nothing}");
    system.load(state).unwrap();
    for _ in 0..3 {
        system.advance(&forces(true), STEP, Budget::iterations(6)).unwrap();
    }
    system.store(state).unwrap();
    system
}

#[test]
fn frames_that_nobody_sees_are_the_same() {
    let (model, start) = cloth(9, 100.0, Some(1e-5));
    let solver = Solver { substeps: 2, ..plain(gauss_seidel(1.3)) };
    let on = || System::on(model.clone(), solver, gpu()).unwrap();
    for (mut seen, unseen_by) in [
        (on(), on()),
        (System::new(model.clone(), solver).unwrap(), System::new(model.clone(), solver).unwrap()),
    ] {
        let (mut state, mut other) = (start.clone(), start.clone());
        for _ in 0..3 {
            seen.step(&mut state, &forces(true), STEP, Budget::iterations(6)).unwrap();
        }
        let mut system = unseen(unseen_by, &mut other);
        assert_eq!(state, other);
        // What was stored is not taken for what lies on the device, which has gone on since.
        system.advance(&forces(true), STEP, Budget::iterations(6)).unwrap();
        let (mut again, mut fresh) = (other.clone(), other.clone());
        system.step(&mut again, &forces(false), STEP, Budget::iterations(6)).unwrap();
        System::new(model.clone(), solver)
            .unwrap()
            .step(&mut fresh, &forces(false), STEP, Budget::iterations(6))
            .unwrap();
        assert!(distance(&again, &fresh) < 1e-5);
        if let Some(at) = system.resident::<Gpu>() {
            let q = at.backend.read_back(at.positions).unwrap().wait().unwrap();
            for ((&place, position), mass) in at.place.iter().zip(&again.positions).zip(model.masses()) {
                assert_eq!(q[place as usize], position.extend(1.0 / mass));
            }
        }
    }
}
