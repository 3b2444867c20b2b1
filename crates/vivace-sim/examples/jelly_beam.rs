//! A bar of jelly held at one end, its volume kept.

use vivace_sim::scene::{Body, Material, Select, Shape, VolumeStiffness};
use vivace_sim::{Budget, Framework, LocalStep, Scene, Simulation, Solver, Vec3, VertexSolve};

/// Lets it sag for a second.
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    let shape = Shape::Beam { cells: [12, 4, 4], spacing: 0.025 };
    let volume = Some(VolumeStiffness { stiffness: 2e4, range: [0.98, 1.02] });
    let material = Material::Volume { density: 1000.0, strain: Some(2e4), volume, springs: None };
    let end = Select::Box { min: Vec3::splat(-0.001), max: Vec3::new(0.001, 1.0, 1.0) };
    let body = Body { pins: vec![end], ..Body::new(shape, material) };
    let scene = Scene { bodies: vec![body], ..Scene::default() };
    let local = LocalStep::Split { sweeps: 2 };
    let framework = Framework::ProjectiveDynamics { local, vertex: VertexSolve::Diagonal };
    let mut simulation = Simulation::new(&scene, Solver { framework, ..Solver::default() })?;
    for _ in 0..30 {
        simulation.step(Budget::iterations(30))?;
    }
    let tip = simulation.positions()[12];
    println!("the tip of the beam sank from 0 to {:.3} m", tip.y);
    assert!(tip.y < -0.01 && tip.y > -0.3);
    Ok(())
}
