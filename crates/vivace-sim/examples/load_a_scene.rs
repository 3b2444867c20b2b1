//! A scene from a file: a curtain in a breeze.

use vivace_sim::{Budget, Simulation, Solver};

/// Reads the curtain, and lets it wave for a second.
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/scenes/curtain.ron");
    let mut simulation = Simulation::load(file, Solver::default())?;
    for _ in 0..30 {
        simulation.step(Budget::iterations(20))?;
    }
    let deepest = simulation.positions().iter().map(|p| p.z.abs()).fold(0.0, f32::max);
    println!("{} particles; the curtain waves up to {deepest:.2} m sideways", simulation.positions().len());
    assert!((0.01..1.3).contains(&deepest));
    Ok(())
}
