//! Every relaxation has the same answer.

use glam::Vec3;
use vivace_model::Forces;
use vivace_solver::reference::{Answer, Reference};
use vivace_solver::{Budget, Framework, LocalStep, Relaxation, Solver, System, VertexSolve};
use vivace_tests::scenes::{
    Bodies, Kind, STEP, Scene, cloth, gauss_seidel, jitter, plain, projective_solvers, solvers,
};

use crate::{EPS, condition, distance, extent, frame, frames, stall};

/// A scene that sets out in disorder, and its answer.
fn disordered(bodies: &Bodies, jitter_by: f32, forces: &Forces) -> (Scene, Answer) {
    let mut scene = bodies.build();
    jitter(&scene.0, &mut scene.1, jitter_by, 3);
    let answer = Reference::new(&scene.0, f64::from(STEP)).unwrap().solve(&scene.1, forces).unwrap();
    assert!(answer.gradient < 1e-8, "{:?}: {}", bodies.kinds, answer.gradient);
    (scene, answer)
}

/// The largest distance from the answer \[m\].
fn off(end: &[Vec3], answer: &Answer) -> f64 {
    end.iter().zip(&answer.positions).map(|(q, x)| q.as_dvec3().distance(*x)).fold(0.0, f64::max)
}

#[test]
fn projective_dynamics_has_one_answer() {
    for bodies in Kind::alone_and_together() {
        let (scene, answer) = disordered(&bodies, 0.005, &Forces::default());
        for solver in projective_solvers() {
            let is_split = matches!(
                solver.framework,
                Framework::ProjectiveDynamics { local: LocalStep::Split { .. }, .. }
            );
            let end = frame(&scene, solver, if is_split { 3500 } else { 1000 }).positions;
            let (off, bound) = (off(&end, &answer), stall(&scene.0, &end));
            assert!(off <= bound, "{:?} {solver:?}: {off} > {bound}", bodies.kinds);
        }
    }
}

/// Relaxations that do not overshoot.
fn plain_position_based() -> [Solver; 3] {
    [gauss_seidel(1.0), Relaxation::Lexicographic { omega: 1.0 }, Relaxation::Jacobi { omega: 2.0 / 3.0 }]
        .map(|relaxation| Solver { framework: Framework::PositionBased, ..plain(relaxation) })
}

/// Position Based Dynamics adds up moves along gradients that turn meanwhile, so it is implicit Euler only where they do not. Otherwise its answer depends on the path, and is nearer to that of implicit Euler than to the start.
#[test]
fn position_based_dynamics_goes_where_implicit_euler_goes() {
    for bodies in Kind::alone_and_together() {
        let (scene, answer) = disordered(&bodies, 0.005, &Forces::default());
        for solver in plain_position_based() {
            let end = frame(&scene, solver, 500).positions;
            assert!(answer.error(&end) < 0.25, "{:?} {solver:?}: {}", bodies.kinds, answer.error(&end));
        }
    }
}

/// The gradient of a spring turns by as much as it moves: a tenth of the motion, a tenth of the error.
#[test]
fn position_based_springs_tend_to_implicit_euler() {
    let bodies = Bodies { kinds: vec![Kind::Spring], ..Bodies::default() };
    for solver in &plain_position_based()[..2] {
        let [large, small] = [1.0, 0.1].map(|share| {
            let forces = Forces { gravity: share * Forces::default().gravity, ..Forces::default() };
            let (scene, answer) = disordered(&bodies, 0.005 * share, &forces);
            answer.error(&frames(&scene, *solver, &forces, 3000, 1).positions)
        });
        println!("{large:.1e} {small:.1e}");
        assert!(large < 0.02 && small < 0.15 * large, "{solver:?}: {large} {small}");
    }
}

/// Soft attachments: each is linear and has its particle to itself, so that a sweep of any kind leaves at most half of the error.
/// Their answer is that of implicit Euler, to the rounding of q, twice what each iteration adds.
fn assert_attachments(solver: Solver) {
    let bodies = Bodies { kinds: vec![Kind::Attachment], stiffer: 0.01, ..Bodies::default() };
    let (scene, answer) = disordered(&bodies, 0.005, &Forces::default());
    let end = frame(&scene, solver, 500).positions;
    let (off, bound) = (off(&end, &answer), 4.0 * EPS * extent(&end));
    assert!(off <= bound, "{solver:?}: {off} > {bound}");
}

#[test]
fn position_based_attachments_are_implicit_euler() {
    plain_position_based().into_iter().for_each(assert_attachments);
}

/// Over-relaxed, an attachment passes its target, where the gradient of |q − target| turns about: its multiplier is a vector.
#[test]
fn over_relaxed_position_based_attachments_are_implicit_euler() {
    solvers().into_iter().filter(|s| s.framework == Framework::PositionBased).for_each(assert_attachments);
}

/// The multiplier of a hinge is a vector too, so that it has the answer of implicit Euler however its direction turns.
#[test]
fn position_based_hinges_are_implicit_euler() {
    for kind in [Kind::FlatHinge, Kind::CurvedHinge] {
        let bodies = Bodies { kinds: vec![kind], ..Bodies::default() };
        let (scene, answer) = disordered(&bodies, 0.005, &Forces::default());
        for solver in solvers().into_iter().filter(|s| s.framework == Framework::PositionBased) {
            let end = frame(&scene, solver, 3500).positions;
            let (off, bound) = (off(&end, &answer), stall(&scene.0, &end));
            // A particle has up to twelve hinges, each of which rounds it.
            assert!(off <= 12.0 * bound, "{kind:?} {solver:?}: {off} > 12 {bound}");
        }
    }
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
