//! A scene that is turned, moved or renumbered has the answer turned, moved or renumbered.

use glam::{EulerRot, Quat, Vec3};
use vivace_model::{Forces, State};
use vivace_solver::{Framework, Relaxation, Solver};
use vivace_tests::scenes::{Bodies, Kind, Scene, gauss_seidel, jitter, plain, projective_dynamics};

use crate::{EPS, distance, extent, frame, frames, stall};

fn frameworks() -> impl Iterator<Item = Framework> {
    projective_dynamics().into_iter().chain([Framework::PositionBased])
}

/// Whether an answer follows its scene smoothly. In Position Based Dynamics strain limits do not: see the test that is ignored.
fn is_smooth(framework: Framework, bodies: &Bodies) -> bool {
    framework != Framework::PositionBased || !bodies.kinds.contains(&Kind::TriangleStrain)
}

/// [`Bodies`] as they stand, in disorder, and the same through `change`, whose positions are `place` of those.
fn pair(bodies: &Bodies, change: &Bodies, place: impl Fn(&State) -> Vec<Vec3>) -> [Scene; 2] {
    let (mut straight, mut changed) = (bodies.build(), change.build());
    jitter(&straight.0, &mut straight.1, 0.005, 1);
    changed.1.positions = place(&straight.1);
    [straight, changed]
}

/// Rest lengths are off by ε |q|, and so is what a constraint asks for; SOR at 1.5 adds up less than 1/(1 − ½) of it in an iteration,
/// and the slow modes keep it: (10 + 4 iterations) ε |q|.
fn bound(iterations: u32, extent: f64) -> f64 {
    f64::from(10 + 4 * iterations) * EPS * extent
}

fn assert_near(what: &str, a: &[Vec3], b: &[Vec3], bound: f64) {
    let off = distance(a, b);
    println!("{:.3} of {bound:.1e}: {what}", off / bound);
    assert!(off <= bound, "{what}: {off} > {bound}");
}

/// One frame of `bodies`, and of them turned.
fn assert_turns(bodies: &Bodies, solver: Solver) {
    let turn = Quat::from_euler(EulerRot::XYZ, 0.7, -1.1, 2.3);
    let forces = Forces { gravity: Vec3::new(0.0, -9.81, 3.0), ..Forces::default() };
    let turned_forces = Forces { gravity: turn * forces.gravity, ..forces };
    let [straight, turned] = pair(bodies, &Bodies { turn, ..bodies.clone() }, |state| {
        state.positions.iter().map(|q| turn * *q).collect()
    });
    let a = frames(&straight, solver, &forces, 10, 1).positions;
    let b = frames(&turned, solver, &turned_forces, 10, 1).positions;
    let back: Vec<Vec3> = b.iter().map(|q| turn.inverse() * *q).collect();
    assert_near(&format!("{:?} {solver:?}", bodies.kinds), &a, &back, bound(10, extent(&a)));
}

#[test]
fn turned() {
    for bodies in Kind::alone_and_together() {
        for framework in frameworks().filter(|&framework| is_smooth(framework, &bodies)) {
            assert_turns(&bodies, Solver { framework, ..plain(gauss_seidel(1.5)) });
        }
    }
}

/// Where a strain comes back within its limit, C and its gradient are 0, but not the multiplier, whose moves are then not undone; just outside of
/// it they are. So rounding decides about a finite move.
#[test]
#[ignore = "known to fail: the gradient of C jumps at the limit, while the multiplier is not 0"]
fn position_based_strain_limits_turn() {
    let bodies = Bodies { kinds: vec![Kind::TriangleStrain], ..Bodies::default() };
    assert_turns(&bodies, Solver { framework: Framework::PositionBased, ..plain(gauss_seidel(1.5)) });
}

#[test]
fn moved() {
    // A multiple of every distance at rest, so that the model is the same to the last bit.
    let shift = Vec3::new(16.0, -32.0, 8.0);
    for kind in Kind::ALL {
        let bodies = Bodies { kinds: vec![kind], ..Bodies::default() };
        let [near, far] = pair(&bodies, &Bodies { shift, ..bodies.clone() }, |state| {
            state.positions.iter().map(|q| *q + shift).collect()
        });
        assert!(near.0 == far.0 || !kind.is_inner(), "{kind:?}");
        for framework in frameworks().filter(|&framework| is_smooth(framework, &bodies)) {
            let solver = Solver { framework, ..plain(gauss_seidel(1.5)) };
            let a = frame(&near, solver, 10).positions;
            let b = frame(&far, solver, 10).positions;
            let back: Vec<Vec3> = b.iter().map(|q| *q - shift).collect();
            assert_near(&format!("{kind:?} {solver:?}"), &a, &back, bound(10, extent(&b)));
        }
    }
}

/// Another numbering has another coloring: the way is another, but the answer is the same. Jacobi goes the same way.
#[test]
fn renumbered() {
    for bodies in Kind::alone_and_together() {
        let change = Bodies { shuffle: Some(4), ..bodies.clone() };
        let number = change.number();
        assert_ne!(number, bodies.number());
        let [straight, shuffled] = pair(&bodies, &change, |state| {
            let mut positions = state.positions.clone();
            number.iter().zip(&state.positions).for_each(|(&at, &q)| positions[at as usize] = q);
            positions
        });
        let assert_same = |solver: Solver, iterations: u32, bound: f64| {
            let a = frame(&straight, solver, iterations).positions;
            let b = frame(&shuffled, solver, iterations).positions;
            let back: Vec<Vec3> = number.iter().map(|&at| b[at as usize]).collect();
            assert_near(&format!("{:?} {solver:?}", bodies.kinds), &a, &back, bound);
        };
        let extent = extent(&straight.1.positions);
        for framework in projective_dynamics() {
            let solver = Solver { framework, ..plain(gauss_seidel(1.5)) };
            assert_same(solver, 3500, 2.0 * stall(&straight.0, &straight.1.positions));
        }
        for framework in frameworks() {
            let solver = Solver { framework, ..plain(Relaxation::Jacobi { omega: 2.0 / 3.0 }) };
            assert_same(solver, 10, bound(10, extent));
        }
    }
}
