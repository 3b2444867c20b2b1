//! The number of threads does not show, nor does the machine.

use glam::Vec3;
use rayon::ThreadPoolBuilder;
use vivace_model::{Forces, State, Wind};
use vivace_solver::{Budget, Framework, Relaxation, Solver, System};
use vivace_tests::scenes::{
    Bodies, Kind, STEP, Scene, cloth, gauss_seidel, jitter, plain, projective_dynamics, solvers,
};

use crate::frames;

/// Where two frames end, and what they report: all sums go over threads, too.
fn on_threads(scene: &Scene, solver: Solver, iterations: u32, n_threads: usize) -> (State, Vec<u64>) {
    let pool = ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
    let wind = Some(Wind { velocity: Vec3::new(1.0, 0.5, -4.0), drag: 0.3 });
    let forces = Forces { wind, ..Forces::default() };
    pool.install(|| {
        let (model, mut state) = scene.clone();
        let mut system = System::new(model, solver).unwrap();
        system.set_measuring(true);
        let mut reported = Vec::new();
        for _ in 0..2 {
            let budget = Budget::tolerance(0.0).and_iterations(iterations);
            let report = system.step(&mut state, &forces, STEP, budget).unwrap();
            let measures = [report.objective, report.residual, report.last_move.map(f64::from)];
            reported.extend(measures.map(|measure| measure.unwrap().to_bits()));
        }
        (state, reported)
    })
}

fn bits(state: &State) -> impl Iterator<Item = [u32; 3]> {
    state.positions.iter().chain(&state.velocities).map(|v| v.to_array().map(f32::to_bits))
}

fn assert_same(scene: &Scene, solver: Solver, iterations: u32) {
    let one = on_threads(scene, solver, iterations, 1);
    for n_threads in [2, 7] {
        let other = on_threads(scene, solver, iterations, n_threads);
        let differ = bits(&one.0).zip(bits(&other.0)).position(|(a, b)| a != b);
        assert_eq!(differ, None, "{solver:?} on {n_threads} threads");
        assert_eq!(one.1, other.1, "{solver:?} on {n_threads} threads");
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
        assert_same(&scene, solver, 9);
        if solver.relaxation == gauss_seidel(1.7) {
            assert_same(&scene, Solver { safeguard: true, ..solver }, 9);
        }
    }
}

/// Every verb of a relaxation that runs on more than one thread, by every kind.
#[test]
fn every_kind_is_the_same_on_any_number_of_threads() {
    for kind in Kind::ALL {
        let mut scene = Bodies::large(kind).build();
        jitter(&scene.0, &mut scene.1, 0.002, 1);
        let (n_particles, n_constraints) = (scene.0.n_particles(), scene.0.constraints().len());
        for framework in projective_dynamics().into_iter().chain([Framework::PositionBased]) {
            let solver = Solver { framework, ..plain(gauss_seidel(1.5)) };
            let n = if framework == Framework::PositionBased { n_constraints } else { n_particles };
            let n_colors = System::new(scene.0.clone(), solver).unwrap().n_colors();
            assert!(n / n_colors >= 512, "{kind:?} {framework:?}: {n} in {n_colors} colors are not shared");
            assert_same(&scene, Solver { safeguard: true, ..solver }, 3);
            assert_same(&scene, Solver { relaxation: Relaxation::Jacobi { omega: 2.0 / 3.0 }, ..solver }, 3);
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

const GOLDEN: u64 = 0x38f6_d128_2f02_3d2a;
