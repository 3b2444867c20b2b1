//! The number of threads does not show, nor does the machine.

use glam::Vec3;
use rayon::ThreadPoolBuilder;
use vivace_model::Forces;
use vivace_solver::{Budget, Framework, Relaxation, Solver, System};
use vivace_tests::scenes::{STEP, Scene, bar, cloth, gauss_seidel, jitter, plain, solvers};

use crate::frames;

fn on_threads(scene: &Scene, solver: Solver, n_threads: usize) -> Vec<Vec3> {
    let pool = ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
    pool.install(|| {
        let (model, mut state) = scene.clone();
        let mut system = System::new(model, solver).unwrap();
        for _ in 0..2 {
            system.step(&mut state, &Forces::default(), STEP, Budget::iterations(9)).unwrap();
        }
        state.positions
    })
}

fn assert_same(scene: &Scene, solver: Solver) {
    let one = on_threads(scene, solver, 1);
    for n_threads in [2, 7] {
        let other = on_threads(scene, solver, n_threads);
        let differ = one
            .iter()
            .zip(&other)
            .position(|(a, b)| a.to_array().map(f32::to_bits) != b.to_array().map(f32::to_bits));
        assert_eq!(differ, None, "{solver:?} on {n_threads} threads");
    }
}

#[test]
fn cloth_is_the_same_on_any_number_of_threads() {
    let mut scene = cloth(70, 100.0, Some(1e-5));
    jitter(&scene.0, &mut scene.1, 0.002, 1);
    // Large enough to be shared: see GRAIN of the solver.
    let n_colors = |framework| {
        System::new(scene.0.clone(), Solver { framework, ..plain(gauss_seidel(1.0)) }).unwrap().n_colors()
    };
    let n_vertex_colors = n_colors(Framework::default());
    assert!(scene.0.n_particles() / n_vertex_colors > 512, "{n_vertex_colors}");
    let n_springs = scene.0.constraints().springs.len();
    assert!(n_springs / n_colors(Framework::PositionBased) > 512, "{n_springs}");
    for solver in solvers() {
        assert_same(&scene, solver);
        if solver.relaxation == gauss_seidel(1.7) {
            assert_same(&scene, Solver { safeguard: true, ..solver });
        }
    }
}

#[test]
fn bar_is_the_same_on_any_number_of_threads() {
    let mut scene = bar([40, 8, 8], 0.02, 1e4);
    jitter(&scene.0, &mut scene.1, 0.001, 1);
    for solver in solvers() {
        if [gauss_seidel(1.0), Relaxation::Jacobi { omega: 2.0 / 3.0 }].contains(&solver.relaxation) {
            assert_same(&scene, solver);
        }
    }
}

/// Only sums, products, quotients and square roots: the same on every machine. A hash that changes comes with the reason.
#[test]
fn ten_frames_have_their_hash() {
    let scene = cloth(20, 100.0, Some(1e-5));
    let end = frames(&scene, Solver::default(), &Forces::default(), 20, 10);
    let bytes = end.positions.iter().flat_map(Vec3::to_array).flat_map(|x| x.to_bits().to_le_bytes());
    let hash = bytes.fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    });
    assert_eq!(hash, GOLDEN, "{hash:#018x}");
}

const GOLDEN: u64 = 0x7164_24b2_615a_3f2c;
