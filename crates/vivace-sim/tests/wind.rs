//! Wind, whatever the drag, the mass and the time step: no solver blows up.

#![expect(clippy::unwrap_used, reason = "what fails here fails a test")]

use vivace_sim::scene::{Body, Material, Pattern, Shape, curtain};
use vivace_sim::{Budget, Forces, Framework, Relaxation, Scene, Simulation, Solver, Vec3, Wind};

fn solvers() -> Vec<Solver> {
    let pd = Framework::default();
    let jacobi = Relaxation::Jacobi { omega: 2.0 / 3.0 };
    let mut solvers = Vec::new();
    for framework in [pd, Framework::PositionBased] {
        for relaxation in [jacobi, Relaxation::default()] {
            solvers.push(Solver { framework, relaxation, ..Solver::default() });
        }
    }
    solvers
}

/// The fastest particle of any frame, and of the last \[m/s\].
fn fastest(scene: &Scene, solver: Solver, n_frames: usize) -> [f32; 2] {
    let mut simulation = Simulation::new(scene, solver).unwrap();
    let speeds = (0..n_frames).map(|_| {
        simulation.step(Budget::iterations(10)).unwrap();
        simulation.state().velocities.iter().map(|v| v.length()).fold(0.0, f32::max)
    });
    let speeds: Vec<f32> = speeds.collect();
    [speeds.iter().copied().fold(0.0, f32::max), speeds[n_frames - 1]]
}

#[test]
fn free_silk_is_carried_away_by_a_strong_wind() {
    let wind = Vec3::new(2.0, 0.0, 5.0);
    for (density, drag) in [(0.05, 8.0), (1e-3, 1e3)] {
        let shape = Shape::Cloth { width: 12, height: 12, spacing: 0.05, pattern: Pattern::Regular };
        let Material::Cloth { springs, bending, strain, tear, .. } = Material::cloth() else {
            unreachable!()
        };
        let material = Material::Cloth { density, springs, bending, strain, tear };
        let forces = Forces { wind: Some(Wind { velocity: wind, drag }), ..Forces::default() };
        let scene = Scene { bodies: vec![Body::new(shape, material)], forces, ..Scene::default() };
        for solver in solvers() {
            let [most, last] = fastest(&scene, solver, 60);
            assert!(most < 2.0 * wind.length(), "{solver:?}: {most} m/s");
            // It falls, too.
            assert!(last > 0.9 * wind.length(), "{solver:?}: {last} m/s");
        }
    }
}

/// Few Jacobi iterations let a curtain stretch far, wind or not: wind must not make it faster than it is without, and the air.
#[test]
fn a_breeze_makes_no_curtain_faster_than_its_fall() {
    let breeze = curtain();
    let still = Scene { forces: Forces { wind: None, ..breeze.forces }, ..curtain() };
    let speed = breeze.forces.wind.unwrap().velocity.length();
    for solver in solvers() {
        let [[most, _], [alone, _]] = [&breeze, &still].map(|scene| fastest(scene, solver, 120));
        assert!(most < alone + speed, "{solver:?}: {most} m/s, without wind {alone} m/s");
    }
}
