//! On a fixed mesh a factored matrix beats every iteration: the same quality in far fewer of them.

use vivace_sim::{Base, Budget, Relaxation, Simulation, Solver, scene::tablecloth};

/// Compares how far the last iteration still moved the particles.
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    let sweeps = Relaxation::GaussSeidel { omega: 1.7, base: Base::Latest };
    for relaxation in [sweeps, Relaxation::Direct] {
        let solver = Solver { relaxation, ..Solver::default() };
        let mut simulation = Simulation::new(&tablecloth(30), solver)?;
        let mut iterations = 0;
        for _ in 0..10 {
            iterations += simulation.step(Budget::tolerance(1e-5).and_iterations(2000))?.iterations;
        }
        println!(
            "{}: {} iterations a frame until they move less than 10 um",
            relaxation.name(),
            iterations / 10
        );
        assert!(iterations < 20_000);
    }
    Ok(())
}
