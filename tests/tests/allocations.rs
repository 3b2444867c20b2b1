//! A frame allocates nothing after the first one.

#![expect(clippy::unwrap_used, reason = "what fails here fails a test")]

use rayon::ThreadPoolBuilder;
use vivace_model::Forces;
use vivace_solver::{Budget, Solver, System};
use vivace_tests::scenes::{STEP, Scene, bar, cloth, solvers};

/// Blocks allocated by a frame that is not the first.
fn allocations(scene: &Scene, solver: Solver) -> u64 {
    let (model, mut state) = scene.clone();
    let mut system = System::new(model, solver).unwrap();
    let mut step = || {
        // Zero iterations and three are the same size.
        system.step(&mut state, &Forces::default(), STEP, Budget::tolerance(0.0).and_iterations(10)).unwrap();
    };
    step();
    allocation_counter::measure(step).count_total
}

#[test]
fn later_frames_allocate_nothing() {
    // The closure runs on the pool's one thread, and counts are per thread.
    let pool = ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    pool.install(|| {
        assert!(allocation_counter::measure(|| drop(vec![1_u8; 100])).count_total > 0);
        for scene in [cloth(50, 100.0, Some(1e-5)), bar([6, 2, 2], 0.1, 1e4)] {
            for solver in solvers() {
                for (safeguard, substeps) in [(false, 1), (true, 1), (true, 2)] {
                    let solver = Solver { safeguard, substeps, ..solver };
                    assert_eq!(allocations(&scene, solver), 0, "{solver:?}");
                }
            }
        }
    });
}
