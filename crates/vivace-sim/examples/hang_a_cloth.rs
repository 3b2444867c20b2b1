//! A cloth held at two corners swings down.

use vivace_sim::{Budget, Simulation, Solver, scene::tablecloth};

/// Simulates two seconds.
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut simulation = Simulation::new(&tablecloth(30), Solver::default())?;
    while simulation.time() < 2.0 {
        simulation.step(Budget::iterations(20))?;
    }
    let lowest = simulation.positions().iter().map(|p| p.y).fold(f32::INFINITY, f32::min);
    println!("after {:.1} s the cloth reaches down to {lowest:.2} m", simulation.time());
    assert!((-1.3..-0.3).contains(&lowest));
    Ok(())
}
