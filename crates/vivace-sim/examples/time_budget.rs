//! What do I get in 5 ms?

use vivace_sim::{Budget, Simulation, Solver, scene::tablecloth};

/// Gives each frame 5 ms, and says how many iterations fit.
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut simulation = Simulation::new(&tablecloth(60), Solver::default())?;
    let (mut iterations, mut solve) = (0, 0.0);
    for _ in 0..30 {
        let report = simulation.step(Budget::milliseconds(5.0))?;
        iterations += report.iterations;
        solve += report.times.solve;
    }
    println!("30 frames of 5 ms: {} iterations each, {:.1} ms", iterations / 30, solve * 1e3 / 30.0);
    assert!(iterations >= 30);
    Ok(())
}
