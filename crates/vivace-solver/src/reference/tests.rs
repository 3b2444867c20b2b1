use glam::{DVec3, Vec3};
use vivace_mesh::{beam, cloth};
use vivace_model::{Forces, Model, ModelBuilder, State, Wind};

use super::objective::Objective;
use super::*;
use crate::{Budget, Solver, System};

const STEP: f64 = 1.0 / 30.0;

/// The square cloth hung by two corners: springs of 100 N/m, flat hinges of 10⁻⁵ J.
fn hung_cloth(width: u16) -> (Model, State) {
    let mesh = cloth::regular(width.into(), width.into(), 0.99 / f32::from(width - 1)).unwrap();
    let mut builder = ModelBuilder::default();
    let first = builder.cloth(&mesh, 0.2).unwrap();
    builder.springs(first, &mesh.edges(), 100.0).unwrap();
    builder.hinges(first, &mesh.hinges(), 1e-5, false).unwrap();
    builder.pin(0).unwrap();
    builder.pin(u32::from(width) - 1).unwrap();
    builder.build().unwrap()
}

/// All kinds at once, and positions away from rest.
fn every_kind() -> (Model, Vec<DVec3>) {
    let mut builder = ModelBuilder::default();
    let sheet = cloth::regular(3, 3, 0.5).unwrap();
    let first = builder.cloth(&sheet, 0.2).unwrap();
    builder.springs(first, &sheet.edges(), 10.0).unwrap();
    builder.triangle_strain(first, sheet.triangles(), 20.0, 0.02).unwrap();
    let mut bent = ModelBuilder::default();
    let x = [Vec3::ZERO, Vec3::X, Vec3::new(0.2, -0.9, 0.0), Vec3::new(0.7, 0.5, 0.8)].map(|x| x + Vec3::Z);
    bent.particles(&x, &[0.1; 4]).unwrap();
    assert_eq!(bent.hinges(0, &[[0, 1, 2, 3]], 3.0, true).unwrap(), 0);
    bent.hinges(0, &[[0, 1, 2, 3]], 1.0, false).unwrap();
    builder.append(bent).unwrap();
    let solid = beam::regular([2, 1, 1], 0.5).unwrap();
    let first = builder.volume(&solid, 10.0).unwrap();
    builder.tet_strain(first, solid.tets(), 50.0).unwrap();
    builder.tet_volume(first, solid.tets(), 80.0, [0.95, 1.05]).unwrap();
    builder.attach(2, Vec3::new(0.1, 0.4, 0.2), 15.0).unwrap();
    builder.pin(0).unwrap();
    let (model, state) = builder.build().unwrap();
    let away = |(i, x): (usize, &Vec3)| {
        let i = i as f64;
        x.as_dvec3() + 0.15 * DVec3::new((7.0 * i).sin(), (11.0 * i).sin(), (13.0 * i).sin())
    };
    let x = state.positions.iter().enumerate().map(away).collect();
    (model, x)
}

/// Central differences of `f` in every coordinate of every free particle.
fn differences(objective: &Objective, x: &[DVec3], mut f: impl FnMut(&[DVec3]) -> f64) -> Vec<DVec3> {
    const DELTA: f64 = 1e-6;
    let mut x = x.to_vec();
    let mut differences = vec![DVec3::ZERO; x.len()];
    for &particle in &objective.free {
        let i = particle as usize;
        for axis in 0..3 {
            let before = x[i][axis];
            x[i][axis] = before + DELTA;
            let above = f(&x);
            x[i][axis] = before - DELTA;
            differences[i][axis] = (above - f(&x)) / (2.0 * DELTA);
            x[i][axis] = before;
        }
    }
    differences
}

#[test]
fn gradient_is_the_derivative_for_every_kind() {
    let (model, x) = every_kind();
    let objective = Objective::new(&model, STEP);
    let predicted: Vec<DVec3> = x.iter().rev().copied().collect();
    let (mut gradient, mut unused) = (vec![DVec3::ZERO; x.len()], vec![DVec3::ZERO; x.len()]);
    objective.evaluate(&x, &predicted, &mut gradient);
    let expected = differences(&objective, &x, |x| objective.evaluate(x, &predicted, &mut unused));
    for (i, (gradient, expected)) in gradient.iter().zip(&expected).enumerate() {
        assert!(
            (*gradient - *expected).length() < 1e-5 * (1.0 + expected.length()),
            "{i}: {gradient} {expected}"
        );
    }
}

#[test]
fn hessian_is_the_derivative_of_the_gradient() {
    let mut builder = ModelBuilder::default();
    let x = [Vec3::ZERO, Vec3::X, Vec3::new(0.2, -0.9, 0.0), Vec3::new(0.7, 0.5, 0.8)];
    builder.particles(&x, &[0.1; 4]).unwrap();
    builder.hinges(0, &[[0, 1, 2, 3]], 3.0, true).unwrap();
    builder.springs(0, &[[0, 1], [1, 2], [3, 2]], 40.0).unwrap();
    builder.attach(3, Vec3::ONE, 7.0).unwrap();
    builder.pin(1).unwrap();
    let (model, state) = builder.build().unwrap();
    let objective = Objective::new(&model, STEP);
    assert!(objective.is_hessian_exact);
    let turned = |(i, x): (usize, &Vec3)| 0.8 * x.as_dvec3() + DVec3::splat(0.1 * i as f64).with_y(0.2);
    let x: Vec<DVec3> = state.positions.iter().enumerate().map(turned).collect();
    let (pattern, values) = (objective.hessian_pattern(), objective.hessian(&x));
    let mut unused = vec![DVec3::ZERO; x.len()];
    for column in 0..pattern.len() {
        let (i, axis) = (objective.free[column / 3] as usize, column % 3);
        let expected = differences(&objective, &x, |x| {
            objective.evaluate(x, x, &mut unused);
            unused[i][axis]
        });
        let entries = pattern.offsets[column] as usize..pattern.offsets[column + 1] as usize;
        for (&row, value) in pattern.rows[entries.clone()].iter().zip(&values[entries]) {
            let row = row as usize;
            // Differences with s = x leave inertia out.
            let inertia = if row == column { f64::from(model.masses()[i]) / (STEP * STEP) } else { 0.0 };
            let expected = expected[objective.free[row / 3] as usize][row % 3] + inertia;
            assert!((value - expected).abs() < 1e-5 * (1.0 + expected.abs()), "{row} {column}");
        }
    }
}

#[test]
fn a_chain_hangs_as_its_equations_say() {
    const N: usize = 6;
    let mut builder = ModelBuilder::default();
    let x: Vec<Vec3> = (0..N).map(|i| Vec3::new(0.0, -0.1 * i as f32, 0.0)).collect();
    builder.particles(&x, &[0.25; N]).unwrap();
    let links: Vec<[u32; 2]> = (1..).take(N - 1).map(|i| [i - 1, i]).collect();
    builder.springs(0, &links, 50.0).unwrap();
    builder.pin(0).unwrap();
    let (model, state) = builder.build().unwrap();
    let answer = Reference::new(&model, STEP).unwrap().solve(&state, &Forces::default()).unwrap();
    assert!(answer.gradient < 1e-9 && answer.objective > 0.0, "{answer:?}");
    let y = |i: usize| answer.positions[i].y;
    let tension =
        |i: usize| 50.0 * (y(i - 1) - y(i) - f64::from(model.constraints().springs.rest[i - 1].rest));
    for i in 1..N {
        let below = if i + 1 < N { tension(i + 1) } else { 0.0 };
        let force = tension(i) - below - 0.25 / (STEP * STEP) * (y(i) - answer.predicted[i].y);
        assert!(force.abs() < 1e-9, "{i}: {force}");
    }
}

#[test]
fn one_spring_is_solved_in_closed_form() {
    let mut builder = ModelBuilder::default();
    builder.particles(&[Vec3::ZERO, Vec3::Y * 2.0], &[1.0, 0.5]).unwrap();
    builder.springs(0, &[[0, 1]], 30.0).unwrap();
    builder.pin(0).unwrap();
    let (model, mut state) = builder.build().unwrap();
    state.velocities[1] = Vec3::Y * 9.0;
    let forces = Forces { gravity: Vec3::Y * 4.0, damping: 0.5, wind: None };
    let mut reference = Reference::new(&model, 0.25).unwrap();
    let (inertia, s) = (0.5 / 0.0625, 2.0 + 0.25 * 9.0 + 0.0625 * 4.0);
    let expected = (inertia * s + 30.0 * 2.0) / (inertia + 30.0);
    let mut exact = ReferenceState::from(&state);
    let answer = reference.step(&mut exact, &forces).unwrap();
    assert!((answer.positions[1] - DVec3::Y * expected).length() < 1e-9, "{answer:?} {expected}");
    assert!((answer.predicted[1] - DVec3::Y * s).length() < 1e-15);
    let velocity = (expected - 2.0) / 0.25 * (-0.125_f64).exp();
    assert!((exact.velocities[1] - DVec3::Y * velocity).length() < 1e-8, "{exact:?}");
    assert_eq!((exact.positions[0], exact.velocities[0]), (DVec3::ZERO, DVec3::ZERO));
    let error = answer.error(&[Vec3::ZERO, answer.predicted[1].as_vec3()]);
    assert!((error - 1.0).abs() < 1e-6, "{error}");
    assert!(answer.error(&[Vec3::ZERO, answer.positions[1].as_vec3()]) < 1e-6);
}

/// Cloth while it buckles: the objective has many minima.
#[test]
fn a_hung_cloth_is_solved_to_the_end() {
    let (model, state) = hung_cloth(15);
    let mut reference = Reference::new(&model, STEP).unwrap();
    let mut exact = ReferenceState::from(&state);
    let mut unused = vec![DVec3::ZERO; exact.positions.len()];
    for frame in 0..12 {
        let answer = reference.step(&mut exact, &Forces::default()).unwrap();
        assert!(answer.gradient < 1e-9, "{frame}: {} {}", answer.gradient, answer.iterations);
        let objective = Objective::new(&model, STEP);
        let slope = differences(&objective, &answer.positions, |x| {
            objective.evaluate(x, &answer.predicted, &mut unused)
        });
        assert!(slope.iter().all(|slope| slope.length() < 1e-7), "{frame}");
        assert!(answer.objective < objective.evaluate(&answer.predicted, &answer.predicted, &mut unused));
    }
}

#[test]
fn every_kind_converges() {
    let (model, x) = every_kind();
    let mut reference = Reference::new(&model, STEP).unwrap();
    let velocities = vec![DVec3::ZERO; x.len()];
    let mut state = ReferenceState { positions: x, velocities };
    for frame in 0..5 {
        let answer = reference.step(&mut state, &Forces::default()).unwrap();
        assert!(answer.gradient < 1e-9, "{frame}: {} {}", answer.gradient, answer.iterations);
    }
}

#[test]
fn the_prediction_is_that_of_the_solver_wind_and_all() {
    let (model, mut state) = hung_cloth(4);
    state.velocities.iter_mut().enumerate().for_each(|(i, v)| *v = Vec3::splat(0.1 * i as f32));
    let wind = Some(Wind { velocity: Vec3::new(1.0, 5.0, 2.0), drag: 3.0 });
    let forces = Forces { wind, ..Forces::default() };
    let predicted = Reference::new(&model, STEP).unwrap().solve(&state, &forces).unwrap().predicted;
    let mut system = System::new(model, Solver::default()).unwrap();
    system.step(&mut state, &forces, 1.0 / 30.0, Budget::iterations(0)).unwrap();
    for (exact, q) in predicted.iter().zip(&state.positions) {
        assert!((exact.as_vec3() - *q).length() < 1e-6, "{exact} {q}");
    }
}

#[test]
fn what_cannot_be_simulated_is_refused() {
    let (model, state) = hung_cloth(4);
    for h in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = Reference::new(&model, h).unwrap_err();
        assert!(matches!(error, SolverError::Model(ModelError::TimeStep { .. })), "{h}");
    }
    let mut reference = Reference::new(&model, STEP).unwrap();
    let mut bad = ReferenceState::from(&state);
    bad.velocities[3].y = f64::NAN;
    assert!(matches!(reference.step(&mut bad, &Forces::default()), Err(SolverError::Model(_))));
    assert!(reference.solve(&State::default(), &Forces::default()).is_err());
    assert!(reference.set_attachment_target(0, Vec3::ZERO).is_err());
}

/// The gradient at which a solve ends is what it was told, and the answer is off by little more.
#[test]
fn a_larger_tolerance_ends_sooner() {
    let mesh = beam::regular([8, 2, 2], 0.1).unwrap();
    let mut builder = ModelBuilder::default();
    let first = builder.volume(&mesh, 100.0).unwrap();
    builder.tet_strain(first, mesh.tets(), 1e4).unwrap();
    (0..9).for_each(|particle| builder.pin(particle).unwrap());
    let (model, state) = builder.build().unwrap();
    let mut reference = Reference::new(&model, STEP).unwrap();
    let exact = reference.solve(&state, &Forces::default()).unwrap();
    reference.set_tolerance(1e-5);
    let found = reference.solve(&state, &Forces::default()).unwrap();
    assert!(exact.gradient <= 1e-9 && found.gradient <= 1e-5, "{} {}", exact.gradient, found.gradient);
    assert!(found.iterations < exact.iterations, "{} of {}", found.iterations, exact.iterations);
    let end: Vec<Vec3> = found.positions.iter().map(|x| x.as_vec3()).collect();
    assert!(exact.error(&end) < 1e-4, "{}", exact.error(&end));
    // Not below what rounding allows.
    reference.set_tolerance(0.0);
    assert_eq!(reference.solve(&state, &Forces::default()).unwrap(), exact);
}
