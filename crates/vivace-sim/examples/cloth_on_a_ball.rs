//! A cloth falls on a ball and hangs over it, without passing through the ball or itself.

use vivace_sim::scene::{Body, Collisions, Material, Obstacle, Pattern, Shape, Solid};
use vivace_sim::{Budget, Scene, Simulation, Solver, Vec3};

/// Two thirds of a second.
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    let shape = Shape::Cloth { width: 25, height: 25, spacing: 0.03, pattern: Pattern::Regular };
    let cloth = Body { at: Vec3::new(-0.36, 0.35, -0.36), ..Body::new(shape, Material::cloth()) };
    let ball = Obstacle::new(Solid::Sphere { radius: 0.3 });
    let floor = Obstacle { at: Vec3::new(0.0, -0.3, 0.0), ..Obstacle::new(Solid::Plane) };
    let scene = Scene {
        bodies: vec![cloth],
        time_step: 1.0 / 60.0,
        collisions: Some(Collisions::new(0.01, vec![ball, floor])),
        ..Scene::default()
    };
    let mut simulation = Simulation::new(&scene, Solver::default())?;
    for frame in 1..=40 {
        let report = simulation.step(Budget::iterations(20))?;
        if frame % 10 == 0 {
            println!("frame {frame}: {} contacts, {} colors", report.contacts.contacts, report.colors);
        }
    }
    let nearest = simulation.positions().iter().map(|p| p.length()).fold(f32::INFINITY, f32::min);
    let lowest = simulation.positions().iter().map(|p| p.y).fold(f32::INFINITY, f32::min);
    println!("the nearest particle is {nearest:.3} m from the middle, the corners hang at {lowest:.2} m");
    assert!(nearest > 0.3 && lowest < 0.1);
    Ok(())
}
