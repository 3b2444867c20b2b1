//! Whole frames of Position Based Dynamics on a device, against those of the host's own engine.

use glam::{Vec3, Vec4};
use vivace_cpu::Cpu;
use vivace_gpu::Gpu;
use vivace_kernels::Backend;
use vivace_kernels::pbd::{Inertia, Residual, StepUniform};
use vivace_model::{Forces, Wind};
use vivace_solver::{Budget, Framework, Relaxation, Rho, Solver, SolverError, StepReport, System};
use vivace_tests::naive::Naive;
use vivace_tests::random::Random;
use vivace_tests::scenes::{Bodies, Kind, STEP, Scene, gauss_seidel, jitter, plain, relaxations};

use crate::gpu;

const N_FRAMES: usize = 3;

/// After these frames the host's engine and a device are this close \[m\], in bodies of about 1 m: the host takes four constraints at a
/// time, and adds in another order. Acceleration amplifies rounding where constraints change sides.
fn bound(relaxation: Relaxation) -> f32 {
    if matches!(relaxation, Relaxation::SymmetricChebyshev { .. }) { 2e-3 } else { 1e-3 }
}

fn solver(relaxation: Relaxation) -> Solver {
    Solver { framework: Framework::PositionBased, ..plain(relaxation) }
}

fn forces() -> Forces {
    Forces { damping: 0.1, ..Forces::default() }
}

/// A scene somewhat out of rest.
fn scene(bodies: &Bodies) -> Scene {
    let mut scene = bodies.build();
    jitter(&scene.0, &mut scene.1, 0.005, 1);
    scene
}

/// Positions after some frames, and what the last of them reported.
fn frames(system: System, scene: &Scene, budget: Budget) -> (Vec<Vec3>, StepReport) {
    frames_under(&forces(), system, scene, budget)
}

fn frames_under(
    forces: &Forces,
    mut system: System,
    scene: &Scene,
    budget: Budget,
) -> (Vec<Vec3>, StepReport) {
    let mut state = scene.1.clone();
    system.set_measuring(true);
    let mut step = || system.step(&mut state, forces, STEP, budget).unwrap_or_else(|error| panic!("{error}"));
    let report = (0..N_FRAMES).map(|_| step()).last().expect("some");
    (state.positions, report)
}

fn on<B: Backend + Send + 'static>(backend: B, scene: &Scene, solver: Solver) -> System {
    System::on(scene.0.clone(), solver, backend).unwrap_or_else(|error| panic!("{error}"))
}

fn farthest(a: &[Vec3], b: &[Vec3]) -> f32 {
    a.iter().zip(b).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
}

/// Sums of numbers that differ by rounding.
fn close(a: Option<f64>, b: Option<f64>) -> bool {
    a.zip(b).is_some_and(|(a, b)| (a - b).abs() <= 2e-2 * b.abs() + 1e-5)
}

#[test]
fn frames_are_those_of_the_host() {
    for bodies in Kind::alone_and_together() {
        let scene = scene(&bodies);
        for relaxation in relaxations() {
            let (solver, budget) = (solver(relaxation), Budget::iterations(12));
            let host = System::new(scene.0.clone(), solver).expect("a solver");
            let (expected, report) = frames(host, &scene, budget);
            for (backend, (found, on_device)) in [
                ("gpu", frames(on(gpu(), &scene, solver), &scene, budget)),
                ("cpu", frames(on(Cpu::new(), &scene, solver), &scene, budget)),
                ("naive", frames(on(Naive::default(), &scene, solver), &scene, budget)),
            ] {
                let (apart, bound) = (farthest(&found, &expected), bound(relaxation));
                let what = format!("{:?} {relaxation:?} on {backend}", bodies.kinds);
                assert!(apart <= bound, "{what}: {apart} m apart");
                assert!(close(on_device.objective, report.objective), "{what}: {on_device:?} {report:?}");
                assert!(close(on_device.residual, report.residual), "{what}: {on_device:?} {report:?}");
            }
        }
    }
}

/// The host blows in `f64`, devices in `f32`; order and pins are the model's.
#[test]
fn wind_is_that_of_the_host() {
    let scene = scene(&Bodies {
        kinds: vec![Kind::Spring, Kind::TriangleStrain, Kind::TetStrain],
        ..Bodies::default()
    });
    let (solver, budget) = (solver(gauss_seidel(1.0)), Budget::iterations(12));
    for drag in [0.3, 3.0] {
        let windy = Forces { wind: Some(Wind { velocity: Vec3::new(1.0, 0.5, 3.0), drag }), ..forces() };
        let host = || System::new(scene.0.clone(), solver).expect("a solver");
        let (expected, _) = frames_under(&windy, host(), &scene, budget);
        let (found, _) = frames_under(&windy, on(gpu(), &scene, solver), &scene, budget);
        assert!(farthest(&found, &expected) <= 2e-4, "{drag}: {} m apart", farthest(&found, &expected));
        let (still, _) = frames(host(), &scene, budget);
        assert!(farthest(&found, &still) > 0.01, "wind does something");
    }
}

/// Small steps, the safeguard, a bound on moves: what looks at numbers on the way.
#[test]
fn what_looks_on_the_way_sees_the_same() {
    let scene = scene(&Bodies::default());
    for relaxation in
        [gauss_seidel(1.9), Relaxation::Chebyshev { rho: Rho::Given(0.99), gamma: 0.9, delay: 0 }]
    {
        let solver = Solver { substeps: 3, safeguard: true, ..solver(relaxation) };
        let budget = Budget { tolerance: Some(1e-4), ..Budget::iterations(60) };
        let host = System::new(scene.0.clone(), solver).expect("a solver");
        let (expected, report) = frames(host, &scene, budget);
        let (found, on_device) = frames(on(gpu(), &scene, solver), &scene, budget);
        assert!(farthest(&found, &expected) <= 1e-3, "{relaxation:?}: {} m", farthest(&found, &expected));
        let of = |report: &StepReport| (report.iterations, report.backoffs, report.stop);
        assert_eq!(of(&on_device), of(&report), "{relaxation:?}");
        let (moved, expected) =
            (on_device.last_move.expect("asked for"), report.last_move.expect("asked for"));
        assert!((moved - expected).abs() <= 0.5 * expected, "{moved} {expected}");
    }
}

/// Dispatches and bytes after each of some frames of `n_iterations`.
fn costs(scene: &Scene, relaxation: Relaxation, n_iterations: u32) -> (u64, [u64; 3]) {
    let mut state = scene.1.clone();
    let mut system = on(gpu(), scene, solver(relaxation));
    let of = |system: &mut System| {
        let gpu = system.resident::<Gpu>().expect("what it was given").backend;
        (gpu.n_dispatches(), gpu.allocated())
    };
    let mut step = |system: &mut System| {
        let result = system.step(&mut state, &Forces::default(), STEP, Budget::iterations(n_iterations));
        result.unwrap_or_else(|error| panic!("{error}"));
        of(system)
    };
    let frames = [step(&mut system), step(&mut system), step(&mut system)];
    assert_eq!(frames[2].0 - frames[1].0, frames[1].0 - frames[0].0);
    (frames[2].0 - frames[1].0, frames.map(|(_, bytes)| bytes))
}

/// An iteration dispatches each kind once a color that has some of it, and nothing else; a frame after the first allocates nothing.
#[test]
fn a_scene_pays_for_what_it_holds() {
    for bodies in Kind::alone_and_together() {
        let scene = scene(&bodies);
        let system = on(gpu(), &scene, solver(gauss_seidel(1.0)));
        let (n_colors, n_kinds) = (system.n_colors() as u64, system.n_passes() as u64);
        for relaxation in relaxations() {
            let (one, bytes) = costs(&scene, relaxation, 1);
            assert!(bytes.iter().all(|&all| all == bytes[0]), "{relaxation:?}: {bytes:?}");
            let per_iteration = costs(&scene, relaxation, 2).0 - one;
            // Prediction, what it is kept in and extrapolated from; velocities; multipliers.
            let rest = one - per_iteration;
            let keeps = 1 + n_kinds;
            match relaxation {
                Relaxation::GaussSeidel { base: vivace_solver::Base::Latest, .. } => {
                    assert_eq!(rest, 4 + 2 * n_kinds, "{relaxation:?}");
                    assert!((n_colors..=n_colors * n_kinds).contains(&per_iteration), "{relaxation:?}");
                }
                Relaxation::Jacobi { .. } => assert_eq!(per_iteration, 3 * n_kinds),
                Relaxation::Chebyshev { .. } => assert_eq!(per_iteration, 3 * n_kinds + keeps),
                _ => {}
            }
        }
    }
}

#[test]
fn targets_and_solvers_change_on_the_way() {
    let scene = scene(&Bodies { kinds: vec![Kind::Spring, Kind::Attachment], ..Bodies::default() });
    let run = |mut system: System| {
        let mut state = scene.1.clone();
        for (k, relaxation) in relaxations().into_iter().enumerate().take(4) {
            let idx = 3 * k;
            let target = state.positions[scene.0.constraints().attachments.particles[idx][0] as usize];
            system.set_attachment_target(idx, target + 0.1 * Vec3::Y).expect("it exists");
            system.set_solver(solver(relaxation)).expect("a solver");
            assert_eq!(system.n_passes(), 2);
            system.step(&mut state, &forces(), STEP, Budget::iterations(8)).expect("a frame");
        }
        state.positions
    };
    let expected = run(System::new(scene.0.clone(), solver(gauss_seidel(1.0))).expect("a solver"));
    // From the other framework.
    let found = run(on(gpu(), &scene, plain(gauss_seidel(1.0))));
    assert!(farthest(&found, &expected) <= 1e-4, "{}", farthest(&found, &expected));
    assert!(farthest(&expected, &scene.1.positions) > 0.01);
}

#[test]
fn what_fails_leaves_the_state_alone() {
    let scene = scene(&Bodies::default());
    let mut system = on(gpu(), &scene, solver(gauss_seidel(1.0)));
    let gpu = system.resident::<Gpu>().expect("what it was given").backend;
    gpu.device().destroy();
    assert!(gpu.wait().is_err());
    let mut state = scene.1.clone();
    let error = system.step(&mut state, &forces(), STEP, Budget::iterations(5)).unwrap_err();
    assert!(matches!(error, SolverError::Device(_)) && error.to_string().contains("lost"), "{error}");
    assert_eq!(state, scene.1);
}

/// What the kernels over particles leave in arrays with room past the end of the list.
fn measured<B: Backend>(backend: &B, n: u32) -> Result<Vec<f32>, B::Error> {
    let mut random = Random::new(u64::from(n) + 1);
    let mut unit = || f32::from(u16::try_from(random.below(1 << 16)).expect("below 2^16")) / 65536.0;
    let mut vectors = || {
        let vectors: Vec<Vec4> = (0..n)
            .map(|k| {
                let w = if k % 5 == 0 { 0.0 } else { unit() };
                Vec4::new(unit(), unit(), unit(), w)
            })
            .collect();
        backend.upload(&vectors)
    };
    let (predicted, q, gradients) = (vectors(), vectors(), vectors());
    let (list, uniform) = (backend.range(0..n), StepUniform { squared_h: 0.01 });
    let len = n as usize + 300;
    let (mut energies, mut squared) = (backend.filled(len, -7.0), backend.filled(len, -7.0));
    let inputs = (backend.view(&predicted), backend.view(&q));
    backend.map::<Inertia>(&list, &uniform, inputs, &mut energies);
    let inputs = (backend.view(&predicted), backend.view(&q), backend.view(&gradients));
    backend.map::<Residual>(&list, &uniform, inputs, &mut squared);
    Ok([backend.read(energies)?, backend.read(squared)?].concat())
}

#[test]
fn measures_are_those_of_the_host() {
    let gpu = gpu();
    for n in [0, 1, 2, 63, 64, 65, 255, 256, 257, 1000] {
        let on_gpu = measured(&gpu, n).unwrap_or_else(|error| panic!("{error}"));
        let (Ok(on_cpu), Ok(naive)) = (measured(&Cpu::new(), n), measured(&Naive::default(), n));
        assert_eq!(on_cpu, naive);
        for (at, (a, b)) in on_gpu.iter().zip(&on_cpu).enumerate() {
            assert!((a - b).abs() <= 1e-5 * b.abs(), "{n} particles, at {at}: {a} {b}");
        }
        assert!(n < 3 || on_cpu.iter().filter(|x| **x > 0.0).count() > n as usize);
    }
}
