use glam::{DVec3, Vec3};
use vivace_mesh::cloth;
use vivace_model::{Forces, Model, ModelBuilder, State};

use super::objective::Objective;
use super::*;

const STEP: f64 = 1.0 / 30.0;

/// The square cloth hung by two corners: springs of 100 N/m, flat hinges of 10⁻⁵ J.
fn hung_cloth(width: usize) -> (Model, State) {
    let mesh = cloth::regular(width, width, 0.99 / (width - 1) as f32).unwrap();
    let mut builder = ModelBuilder::default();
    let first = builder.cloth(&mesh, 0.2).unwrap();
    builder.springs(first, &mesh.edges(), 100.0).unwrap();
    builder.hinges(first, &mesh.hinges(), 1e-5, false).unwrap();
    builder.pin(0).unwrap();
    builder.pin(width as u32 - 1).unwrap();
    builder.build().unwrap()
}

#[test]
#[ignore = "timing"]
fn timing() {
    let (model, state) = hung_cloth(100);
    let start = std::time::Instant::now();
    let mut reference = Reference::new(&model, STEP).unwrap();
    println!("new {:?}", start.elapsed());
    let mut state = ReferenceState::from(&state);
    for frame in 0..15 {
        let start = std::time::Instant::now();
        let answer = reference.step(&mut state, &Forces::default()).unwrap();
        let seconds = start.elapsed().as_secs_f64();
        println!(
            "{frame}: {} its, gradient {:.2e}, g {:.12e}, {seconds:.2} s",
            answer.iterations, answer.gradient, answer.objective
        );
    }
}
