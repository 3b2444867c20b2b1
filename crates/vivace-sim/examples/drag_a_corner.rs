//! A corner of a cloth follows a hand.

use vivace_sim::scene::{Attach, Select, tablecloth};
use vivace_sim::{Budget, Simulation, Solver, Vec3};

/// Pulls the corner up for a second.
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut scene = tablecloth(20);
    let corner = Select::Vertices(vec![399]);
    scene.bodies[0].attachments = vec![Attach { select: corner, stiffness: 1000.0, offset: Vec3::ZERO }];
    let mut simulation = Simulation::new(&scene, Solver::default())?;
    let start = simulation.positions()[399];
    for frame in 0..30 {
        simulation.set_target(0, start + Vec3::new(0.0, 0.01 * frame as f32, -0.01 * frame as f32))?;
        simulation.step(Budget::iterations(30))?;
    }
    let corner = simulation.positions()[399];
    println!("the hand went from {start:.2} up; the corner is at {corner:.2}");
    assert!((corner - start - Vec3::new(0.0, 0.29, -0.29)).length() < 0.05);
    Ok(())
}
