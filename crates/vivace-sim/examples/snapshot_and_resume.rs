//! A simulation is put on disk and goes on where it was, bit for bit.

use vivace_sim::{Budget, Simulation, Snapshot, Solver, scene::tablecloth};

/// Ten frames at once, and five and five.
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (scene, budget) = (tablecloth(20), Budget::iterations(20));
    let mut first = Simulation::new(&scene, Solver::default())?;
    for _ in 0..5 {
        first.step(budget)?;
    }
    let text = first.snapshot().to_json()?;
    let mut second = Simulation::new(&scene, Solver::default())?;
    second.restore(&Snapshot::from_json(&text)?)?;
    for _ in 0..5 {
        first.step(budget)?;
        second.step(budget)?;
    }
    assert_eq!(first.snapshot(), second.snapshot());
    println!("{} bytes of JSON at frame 5; both runs are the same at frame {}", text.len(), second.frame());
    Ok(())
}
