//! Every relaxation has the same answer.

use vivace_model::Forces;
use vivace_solver::reference::Reference;
use vivace_solver::{Budget, Framework, LocalStep, Relaxation, Solver, System, VertexSolve};
use vivace_tests::scenes::{STEP, Scene, bar, cloth, gauss_seidel, jitter, plain, projective_solvers};

use crate::{condition, distance, frame, stall};

fn assert_converges(scene: &Scene, iterations: u32, solvers: &[Solver]) {
    let mut reference = Reference::new(&scene.0, f64::from(STEP)).unwrap();
    let answer = reference.solve(&scene.1, &Forces::default()).unwrap();
    assert!(answer.gradient < 1e-6, "{}", answer.gradient);
    for &solver in solvers {
        let end = frame(scene, solver, iterations).positions;
        let bound = stall(&scene.0, &end);
        let off =
            end.iter().zip(&answer.positions).map(|(q, x)| q.as_dvec3().distance(*x)).fold(0.0, f64::max);
        println!("{:?} {:?}: {off:.2e} of {bound:.2e}", solver.framework, solver.relaxation);
        assert!(off <= bound, "{solver:?}: {off} > {bound}");
    }
}

#[test]
fn cloth_has_one_answer() {
    let mut scene = cloth(8, 100.0, Some(1e-5));
    jitter(&scene.0, &mut scene.1, 0.005, 3);
    assert_converges(&scene, 3000, &projective_solvers());
}

#[test]
fn bar_has_one_answer() {
    let mut scene = bar([4, 2, 2], 0.1, 1e4);
    jitter(&scene.0, &mut scene.1, 0.01, 3);
    assert_converges(&scene, 1000, &projective_solvers());
}

/// A tolerance asks for the answer of the frame, not for that of the first linear system.
#[test]
fn a_tolerance_waits_for_the_local_step() {
    let mut scene = cloth(8, 100.0, Some(1e-5));
    jitter(&scene.0, &mut scene.1, 0.005, 3);
    let framework = Framework::ProjectiveDynamics {
        local: LocalStep::Split { sweeps: 400 },
        vertex: VertexSolve::Diagonal,
    };
    let ends = [Solver { framework, ..plain(gauss_seidel(1.7)) }, plain(Relaxation::Direct)].map(|solver| {
        let mut state = scene.1.clone();
        let mut system = System::new(scene.0.clone(), solver).unwrap();
        let budget = Budget::tolerance(1e-6).and_iterations(20_000);
        let report = system.step(&mut state, &Forces::default(), STEP, budget).unwrap();
        println!("{report:?}");
        state.positions
    });
    // A sweep moves by at least the error over the condition, root mean square; one particle may hold all of the error.
    let n = scene.0.n_particles() as f64;
    let (off, bound) = (distance(&ends[0], &ends[1]), 1e-6 * n.sqrt() * condition(&scene.0));
    assert!(off < bound, "{off} > {bound}");
}
