//! The same work cut into small steps loses less of the motion.

use vivace_sim::{Budget, Simulation, Solver, scene::tablecloth};

/// Lets a cloth swing, and compares how much of its energy is gone after a second.
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut losses = Vec::new();
    for substeps in [1, 20] {
        let solver = Solver { substeps, ..Solver::default() };
        let mut simulation = Simulation::new(&tablecloth(20), solver)?;
        for _ in 0..30 {
            simulation.step(Budget::iterations(40))?;
        }
        // It began at rest at height 0: kinetic and potential energy would still be 0 together.
        let state = simulation.state();
        let energies = state.positions.iter().zip(&state.velocities);
        let loss = energies.map(|(q, v)| -9.81 * q.y - 0.5 * v.length_squared()).sum::<f32>() / 400.0;
        println!("steps a frame: {substeps}; energy lost in the first second: {loss:.2} J/kg");
        losses.push(loss);
    }
    assert!(losses[1] < losses[0]);
    Ok(())
}
