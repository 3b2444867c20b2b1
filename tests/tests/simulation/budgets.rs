//! How long a step takes, what is refused, and the safeguard.

use std::time::Instant;

use glam::Vec3;
use vivace_model::{Forces, ModelError, State};
use vivace_solver::{
    Base, Budget, Ease, Framework, Relaxation, Rho, Solver, SolverError, StepReport, Stop, System,
};
use vivace_tests::scenes::{
    STEP, Scene, cloth, free_cloth, gauss_seidel, jitter, plain, projective_dynamics, solvers,
};

fn step(scene: &Scene, solver: Solver, budget: Budget) -> (State, StepReport) {
    let (model, mut state) = scene.clone();
    let report =
        System::new(model, solver).unwrap().step(&mut state, &Forces::default(), STEP, budget).unwrap();
    (state, report)
}

#[test]
fn iterations_are_counted() {
    let scene = cloth(6, 100.0, Some(1e-5));
    for solver in solvers() {
        for substeps in [1, 3] {
            for n in [0, 1, 2, 7] {
                let (_, report) = step(&scene, Solver { substeps, ..solver }, Budget::iterations(n));
                assert_eq!((report.iterations, report.stop), (n, Stop::Iterations), "{solver:?}");
            }
        }
    }
}

#[test]
fn time_ends_a_step_and_one_iteration_always_runs() {
    let scene = cloth(12, 100.0, Some(1e-5));
    for solver in solvers() {
        for ms in [0.0, 2.0] {
            let (state, report) = step(&scene, solver, Budget::milliseconds(ms));
            assert!(state.positions.iter().all(|q| q.is_finite()), "{solver:?}");
            assert!(report.iterations >= 1 && report.stop == Stop::Time, "{solver:?} {report:?}");
            assert!(ms > 0.0 || report.iterations == 1, "{report:?}");
        }
        let both = Budget::milliseconds(1e6).and_iterations(5);
        assert_eq!(step(&scene, solver, both).1.iterations, 5);
        // A million iterations would take minutes.
        let both = Budget::iterations(1_000_000).and_milliseconds(2.0);
        assert_eq!(step(&scene, solver, both).1.stop, Stop::Time);
    }
}

/// Another iteration begins while, by the mean of those before, it would end in time. So more than half the time is used; and a machine
/// that is busy with other things may take longer, but not fifty times as long.
#[test]
fn time_is_used() {
    let (model, mut state) = cloth(12, 100.0, Some(1e-5));
    let mut system = System::new(model, Solver::default()).unwrap();
    let seconds = 0.02;
    let start = Instant::now();
    let report = system.step(&mut state, &Forces::default(), STEP, Budget::milliseconds(20.0)).unwrap();
    let passed = start.elapsed().as_secs_f64();
    assert!(passed > 0.5 * seconds && passed < 50.0 * seconds, "{passed} of {seconds}: {report:?}");
    let times = report.times;
    let sum = times.setup + times.predict + times.solve + times.finish;
    assert!(sum > 0.5 * seconds && sum <= passed, "{passed}: {report:?}");
}

#[test]
fn a_tolerance_ends_a_step() {
    let scene = cloth(6, 100.0, Some(1e-5));
    for solver in solvers() {
        let (state, report) = step(&scene, solver, Budget::tolerance(1e-5).and_iterations(5000));
        assert_eq!(report.stop, Stop::Tolerance, "{solver:?} {report:?}");
        assert!(report.last_move.unwrap() <= 1e-5 && report.iterations >= 1, "{solver:?} {report:?}");
        // Between local steps a tolerance asks for the next one early: only then is it no mere number of iterations.
        if solver.framework != projective_dynamics()[1] {
            assert_eq!(state, step(&scene, solver, Budget::iterations(report.iterations)).0, "{solver:?}");
        }
        let (_, report) = step(&scene, solver, Budget::tolerance(0.0).and_iterations(3));
        assert_eq!((report.iterations, report.stop), (3, Stop::Iterations), "{solver:?}");
    }
}

/// The farthest that a particle of a hung cloth comes from the origin within 90 frames; infinite when a step fails.
fn farthest(k: f32, solver: Solver, iterations: u32) -> f32 {
    let (model, mut state) = cloth(30, k, Some(1e-5));
    let mut system = System::new(model, solver).unwrap();
    let mut farthest = 0.0_f32;
    for _ in 0..90 {
        let result = system.step(&mut state, &Forces::default(), STEP, Budget::iterations(iterations));
        if result.is_err() {
            return f32::INFINITY;
        }
        farthest = state.positions.iter().map(|q| q.length()).fold(farthest, f32::max);
    }
    farthest
}

fn accelerated() -> [Relaxation; 2] {
    [gauss_seidel(1.9), Relaxation::Chebyshev { rho: Rho::Given(0.999), gamma: 2.0 / 3.0, delay: 0 }]
}

/// Energy cannot come from nowhere: in free fall for 3 s a particle gets 45 m far.
const BOUND: f32 = 50.0;

#[test]
fn the_safeguard_keeps_acceleration_bounded() {
    for relaxation in accelerated() {
        for k in [1.0, 10.0, 100.0, 1000.0] {
            for iterations in [4, 10, 20] {
                let solver = Solver { safeguard: true, ..plain(relaxation) };
                let far = farthest(k, solver, iterations);
                assert!(far < BOUND, "{relaxation:?} k = {k}, {iterations} iterations: {far} m");
            }
        }
    }
}

#[test]
fn acceleration_blows_up_without_the_safeguard() {
    let all = accelerated().map(|relaxation| (relaxation, farthest(100.0, plain(relaxation), 10)));
    println!("{all:?}");
    assert!(all.iter().any(|&(_, far)| far > BOUND), "{all:?}");
}

/// A step of so many iterations from `start`, under the safeguard.
fn guarded((model, start): &Scene, relaxation: Relaxation, iterations: u32) -> (StepReport, System) {
    let (model, mut state) = (model.clone(), start.clone());
    let mut system = System::new(model, Solver { safeguard: true, ..plain(relaxation) }).unwrap();
    system.set_measuring(true);
    let budget = Budget::iterations(iterations);
    let report = system.step(&mut state, &Forces::default(), STEP, budget).unwrap();
    (report, system)
}

/// What raises the objective is taken back and remembered, until as many steps as it takes have gone well.
#[test]
fn the_safeguard_takes_back_what_raises_the_objective() {
    // Wrong on purpose: from the positions an iteration earlier, 1.9 diverges.
    let relaxation = Relaxation::GaussSeidel { omega: 1.9, base: Base::PreviousInPlace };
    let mut scene = cloth(12, 1000.0, Some(1e-5));
    jitter(&scene.0, &mut scene.1, 0.02, 1);
    let start = guarded(&scene, relaxation, 0).0.objective.unwrap();
    let mut lowest = start;
    for iterations in [8, 16, 40] {
        let (report, mut system) = guarded(&scene, relaxation, iterations);
        let objective = report.objective.unwrap();
        // The safeguard tells rises from 10⁻⁶ on.
        assert!(objective <= lowest * (1.0 + 1e-6), "{iterations}: {report:?}, {lowest} before");
        lowest = objective;
        assert_eq!(report.backoffs > 0, system.ease() != Ease::default(), "{report:?}");
        if iterations == 40 {
            assert!(report.backoffs > 0 && lowest < 0.9 * start, "{report:?} {start}");
            // A single iteration is not accelerated.
            for _ in 0..30 * report.backoffs {
                assert_ne!(system.ease(), Ease::default());
                system.step(&mut scene.1.clone(), &Forces::default(), STEP, Budget::iterations(1)).unwrap();
            }
            assert_eq!(system.ease(), Ease::default());
        }
    }
}

/// Whatever was eased away comes back, though nothing is left of it meanwhile that could be watched.
#[test]
fn acceleration_comes_back_from_nothing() {
    for (relaxation, level) in [(gauss_seidel(1.9), 24), (Relaxation::Jacobi { omega: 0.6 }, 1)] {
        let (model, mut state) = cloth(8, 100.0, Some(1e-5));
        let mut system = System::new(model, Solver { safeguard: true, ..plain(relaxation) }).unwrap();
        system.set_ease(serde_json::from_str(&format!("{{\"level\":{level},\"quiet_steps\":0}}")).unwrap());
        for _ in 0..30 * level {
            assert_ne!(system.ease(), Ease::default(), "{relaxation:?}");
            system.step(&mut state, &Forces::default(), STEP, Budget::iterations(5)).unwrap();
        }
        assert_eq!(system.ease(), Ease::default(), "{relaxation:?}");
    }
}

/// In free fall the objective is 0, and what is seen of it are roundings: no reason to ease, on the host or where kernels run.
#[test]
fn roundings_are_no_rise() {
    for framework in [Framework::default(), Framework::FUSED, Framework::PositionBased] {
        let (model, start) = free_cloth(17, 100.0, Some(1e-5)).build().unwrap();
        let solver = Solver { framework, ..Solver::default() };
        let systems = [System::new(model.clone(), solver), System::on(model, solver, vivace_cpu::Cpu::new())];
        for (mut system, place) in systems.into_iter().map(Result::unwrap).zip(["host", "kernels"]) {
            let mut state = start.clone();
            for frame in 0..20 {
                let budget = Budget::iterations(30);
                let report = system.step(&mut state, &Forces::default(), STEP, budget).unwrap();
                assert_eq!(report.backoffs, 0, "{framework:?}, {place}, frame {frame}");
            }
        }
    }
}

/// XPBD comes to rest beside the minimum of the objective: the safeguard does not take that for divergence.
#[test]
fn over_relaxed_position_based_dynamics_keeps_its_acceleration() {
    let framework = Framework::PositionBased;
    for iterations in [10, 30] {
        let (model, mut state) = cloth(20, 1000.0, Some(1e-5));
        let solver = Solver { framework, safeguard: true, ..plain(gauss_seidel(1.5)) };
        let mut system = System::new(model, solver).unwrap();
        for _ in 0..60 {
            let budget = Budget::iterations(iterations);
            let report = system.step(&mut state, &Forces::default(), STEP, budget).unwrap();
            assert_eq!(report.backoffs, 0, "{iterations} iterations");
        }
        let far = state.positions.iter().map(|q| q.length()).fold(0.0, f32::max);
        assert!(far < BOUND, "{iterations} iterations: {far} m");
    }
}

/// A time step that is refused leaves no parameters behind: the next one, of the old size, is as if it had not been asked for.
#[test]
fn a_refused_time_step_leaves_no_parameters() {
    let (model, start) = free_cloth(8, 1e6, Some(1e-5)).build().unwrap();
    let mut system = System::new(model, plain(Relaxation::Direct)).unwrap();
    let mut ends = Vec::new();
    for _ in 0..2 {
        let mut state = start.clone();
        system.step(&mut state, &Forces::default(), STEP, Budget::iterations(2)).unwrap();
        ends.push(state);
        let refused = system.step(&mut start.clone(), &Forces::default(), 1000.0, Budget::iterations(2));
        assert!(matches!(refused, Err(SolverError::Factor { .. })), "{refused:?}");
    }
    assert_eq!(ends[0], ends[1]);
}

/// Half of the time is left to the second of two small steps: it does not end as after one iteration.
#[test]
fn small_steps_share_the_time() {
    let residual = |budget| {
        let (model, mut state) = cloth(12, 100.0, Some(1e-5));
        let mut system = System::new(model, Solver { substeps: 2, ..plain(gauss_seidel(1.0)) }).unwrap();
        system.set_measuring(true);
        system.step(&mut state, &Forces::default(), STEP, budget).unwrap().residual.unwrap()
    };
    let (few, many) = (residual(Budget::iterations(2)), residual(Budget::milliseconds(60.0)));
    assert!(many < 0.1 * few, "{few} {many}");
}

fn refused(change: impl FnOnce(&mut State), forces: &Forces, h: f32, budget: Budget) -> SolverError {
    let (model, mut state) = cloth(5, 100.0, None);
    change(&mut state);
    let before = state.clone();
    let error =
        System::new(model, Solver::default()).unwrap().step(&mut state, forces, h, budget).unwrap_err();
    let bits = |values: &[Vec3]| values.iter().flat_map(Vec3::to_array).map(f32::to_bits).collect::<Vec<_>>();
    assert_eq!(bits(&before.positions), bits(&state.positions));
    assert_eq!(bits(&before.velocities), bits(&state.velocities));
    error
}

#[test]
fn what_cannot_be_simulated_is_refused() {
    let (forces, one) = (Forces::default(), Budget::iterations(1));
    for bad in [f32::NAN, f32::INFINITY, -f32::INFINITY, 2e12] {
        let error = refused(|state| state.positions[7].y = bad, &forces, STEP, one);
        assert!(error.to_string().contains("particle 7"), "{error}");
        let error = refused(|state| state.velocities[3].z = bad, &forces, STEP, one);
        assert!(error.to_string().contains("particle 3"), "{error}");
    }
    let error = refused(|state| state.positions.truncate(24), &forces, STEP, one);
    assert!(
        matches!(error, SolverError::Model(ModelError::Length { expected: 25, found: 24, .. })),
        "{error}"
    );
    let error = refused(|state| state.velocities.push(Vec3::ZERO), &forces, STEP, one);
    assert!(matches!(error, SolverError::Model(ModelError::Length { found: 26, .. })), "{error}");
    for h in [0.0, -0.01, f32::NAN, f32::INFINITY, 1001.0] {
        let error = refused(|_| (), &forces, h, one);
        assert!(matches!(error, SolverError::Model(ModelError::TimeStep { .. })), "{h}");
    }
    let gravity = Forces { gravity: Vec3::new(0.0, f32::NAN, 0.0), ..forces };
    assert!(matches!(refused(|_| (), &gravity, STEP, one), SolverError::Model(ModelError::Value { .. })));
    let none = [Budget::default(), Budget { tolerance: Some(1e-3), ..Budget::default() }];
    for budget in none {
        assert!(matches!(refused(|_| (), &forces, STEP, budget), SolverError::NoBudget));
    }
    for ms in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(
            refused(|_| (), &forces, STEP, Budget::milliseconds(ms)),
            SolverError::Setting { .. }
        ));
    }
    for meters in [-1.0, f32::NAN, f32::INFINITY] {
        assert!(matches!(
            refused(|_| (), &forces, STEP, Budget::tolerance(meters)),
            SolverError::Setting { .. }
        ));
    }
}

#[test]
fn parameters_out_of_range_are_refused() {
    let bad = |solver: Solver| System::new(cloth(3, 100.0, None).0, solver).unwrap_err();
    for omega in [-1.0, 0.0, 2.0, 2.5, f32::NAN, f32::INFINITY] {
        assert!(matches!(bad(plain(gauss_seidel(omega))), SolverError::Setting { .. }), "{omega}");
    }
    for rho in [-0.1, 1.0, f32::NAN] {
        let relaxation = Relaxation::SymmetricChebyshev { rho: Rho::Given(rho) };
        assert!(matches!(bad(plain(relaxation)), SolverError::Setting { .. }), "{rho}");
    }
    for substeps in [0, 10_001] {
        assert!(matches!(bad(Solver { substeps, ..Solver::default() }), SolverError::Setting { .. }));
    }
    let direct = Solver { framework: Framework::PositionBased, ..plain(Relaxation::Direct) };
    assert!(matches!(bad(direct), SolverError::NotPositionBased { .. }));
}

/// A state that leaves the range of numbers is not written.
#[test]
fn divergence_leaves_the_state_as_it_was() {
    let (model, mut state) = cloth(5, 100.0, None);
    state.velocities[12].x = 1e12;
    let before = state.clone();
    let mut system = System::new(model, plain(gauss_seidel(1.0))).unwrap();
    let forces = Forces { gravity: Vec3::splat(3e38), ..Forces::default() };
    let error = system.step(&mut state, &forces, 1000.0, Budget::iterations(2)).unwrap_err();
    assert!(matches!(error, SolverError::Diverged { .. }), "{error}");
    assert_eq!(before, state);
    // And the system still works.
    let (_, mut state) = cloth(5, 100.0, None);
    system.step(&mut state, &Forces::default(), STEP, Budget::iterations(2)).unwrap();
}
