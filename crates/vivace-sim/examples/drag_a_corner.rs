//! A hand takes the corner of a cloth, lifts it and lets it go.

use vivace_sim::scene::tablecloth;
use vivace_sim::{Budget, Hold, Simulation, Solver, Vec3};

/// Lifts the corner for a second.
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut simulation = Simulation::new(&tablecloth(20), Solver::default())?;
    let start = simulation.positions()[399];
    let hand = simulation.grab(&[398, 399], Hold::Spring(1000.0))?;
    for frame in 1..=30 {
        simulation.drag(hand, Vec3::new(0.0, 0.01, -0.01) * frame as f32)?;
        simulation.step(Budget::iterations(30))?;
    }
    let corner = simulation.positions()[399];
    println!("the hand went from {start:.2} up; the corner is at {corner:.2}");
    assert!((corner - start - Vec3::new(0.0, 0.3, -0.3)).length() < 0.05);
    simulation.release(hand)?;
    for _ in 0..10 {
        simulation.step(Budget::iterations(30))?;
    }
    assert!(simulation.positions()[399].y < corner.y - 0.1);
    Ok(())
}
