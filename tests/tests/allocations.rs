//! A frame allocates nothing after the first one.

#![expect(clippy::unwrap_used, reason = "what fails here fails a test")]

use glam::Vec3;
use rayon::ThreadPoolBuilder;
use vivace_model::{Forces, Wind};
use vivace_solver::{Budget, Framework, PinMove, Relaxation, Solver, System};
use vivace_tests::scenes::{
    Bodies, Kind, STEP, Scene, cloth, gauss_seidel, jitter, plain, projective_dynamics, solvers,
};

/// Blocks that the calling thread allocates in frames that are not the first.
fn allocations(scene: &Scene, solver: Solver, budget: Budget) -> u64 {
    let (model, mut state) = scene.clone();
    let mut system = System::new(model, solver).unwrap();
    let wind = Some(Wind { velocity: Vec3::Z, drag: 0.3 });
    let forces = Forces { wind, ..Forces::default() };
    let mut step = || {
        system.step(&mut state, &forces, STEP, budget).unwrap();
    };
    step();
    allocation_counter::measure(|| (0..2).for_each(|_| step())).count_total
}

/// Runs `test` on a thread of a pool of so many.
fn on_threads(n: usize, test: impl FnOnce() + Send) {
    let pool = ThreadPoolBuilder::new().num_threads(n).build().unwrap();
    pool.install(|| {
        assert!(allocation_counter::measure(|| drop(vec![1_u8; 100])).count_total > 0);
        test();
    });
}

#[test]
fn later_frames_allocate_nothing() {
    on_threads(1, || {
        for bodies in Kind::alone_and_together() {
            let mut scene = bodies.build();
            jitter(&scene.0, &mut scene.1, 0.005, 1);
            for solver in solvers() {
                for (safeguard, substeps) in [(false, 1), (true, 1), (true, 2)] {
                    let solver = Solver { safeguard, substeps, ..solver };
                    let budget = Budget::tolerance(0.0).and_iterations(10);
                    let n = allocations(&scene, solver, budget);
                    assert_eq!(n, 0, "{:?} {solver:?}", bodies.kinds);
                }
            }
        }
    });
}

/// On two threads, in scenes that are large enough to be shared. The thread that steps is counted, and with it all that the solver
/// allocates for a loop before it is shared, and in its own share; the other runs shares of the same loops. Rayon itself allocates
/// nothing there: its jobs stand on the stack.
fn assert_none_on_two_threads(safeguard: bool, budget: Budget) {
    on_threads(2, || {
        for kind in Kind::ALL {
            let scene = Bodies::large(kind).build();
            for framework in projective_dynamics().into_iter().chain([Framework::PositionBased]) {
                for relaxation in [gauss_seidel(1.5), Relaxation::Jacobi { omega: 2.0 / 3.0 }] {
                    let solver = Solver { framework, safeguard, ..plain(relaxation) };
                    assert_eq!(allocations(&scene, solver, budget), 0, "{kind:?} {solver:?}");
                }
            }
        }
    });
}

/// Nor does leading what is held, by springs and pinned.
#[test]
fn what_is_led_allocates_nothing() {
    on_threads(1, || {
        for solver in solvers() {
            let (mut model, mut state) = cloth(8, 100.0, Some(1e-5));
            model.pin(60).unwrap();
            model.replace_attachments(0, &[(20, Vec3::Y, 100.0)]).unwrap();
            let mut system = System::new(model, solver).unwrap();
            let mut lead = || {
                let from = state.positions[60];
                system.move_pins(&[PinMove { particle: 60, from, to: from + Vec3::Y * 0.01 }]).unwrap();
                system.set_attachment_target(0, state.positions[20] + Vec3::Y * 0.1).unwrap();
                system.step(&mut state, &Forces::default(), STEP, Budget::iterations(5)).unwrap();
            };
            lead();
            let n = allocation_counter::measure(|| (0..2).for_each(|_| lead())).count_total;
            assert_eq!(n, 0, "{solver:?}");
        }
    });
}

#[test]
fn sweeps_on_two_threads_allocate_nothing() {
    assert_none_on_two_threads(false, Budget::iterations(2));
}

#[test]
fn sums_on_two_threads_allocate_nothing() {
    assert_none_on_two_threads(true, Budget::tolerance(0.0).and_iterations(2));
}
