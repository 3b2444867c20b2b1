//! A scene that is turned, moved or renumbered has the answer turned, moved or renumbered.

use glam::{Quat, Vec3};
use vivace_mesh::TriMesh;
use vivace_model::{Forces, ModelBuilder};
use vivace_solver::{Framework, Solver};
use vivace_tests::random::Random;
use vivace_tests::scenes::{Scene, gauss_seidel, jitter, plain, projective_dynamics};

use crate::{EPS, distance, extent, frames, stall};

const K: f32 = 100.0;

/// A hung cloth, every position through `place` and every number through `number`.
fn scene(place: impl Fn(Vec3) -> Vec3, number: &[u32]) -> Scene {
    let mesh = vivace_mesh::cloth::regular(9, 9, 0.125).unwrap();
    let mut positions = vec![Vec3::ZERO; 81];
    for (&at, &q) in number.iter().zip(mesh.positions()) {
        positions[at as usize] = place(q);
    }
    let triangles = mesh.triangles().iter().map(|t| t.map(|v| number[v as usize])).collect();
    let mesh = TriMesh::new(positions, triangles).unwrap();
    let mut builder = ModelBuilder::new();
    builder.cloth(&mesh, 0.2).unwrap();
    builder.springs(0, &mesh.edges(), K).unwrap();
    builder.hinges(0, &mesh.hinges(), 1e-4, false).unwrap();
    for corner in [0, 8] {
        builder.pin(number[corner]).unwrap();
    }
    builder.build().unwrap()
}

fn in_order() -> Vec<u32> {
    (0..81).collect()
}

fn frameworks() -> Vec<Solver> {
    let mut all = projective_dynamics().to_vec();
    all.push(Framework::PositionBased);
    all.into_iter().map(|framework| Solver { framework, ..plain(gauss_seidel(1.5)) }).collect()
}

/// Rest lengths are off by ε |q|, and so is what a spring asks for; SOR at 1.5 adds up less than 1/(1 − ½) of it in an iteration, and
/// the slow modes keep it: (10 + 4 iterations) ε |q|.
fn bound(iterations: u32, extent: f64) -> f64 {
    f64::from(10 + 4 * iterations) * EPS * extent
}

#[test]
fn turned() {
    let turn = Quat::from_euler(glam::EulerRot::XYZ, 0.7, -1.1, 2.3);
    let (straight, turned) = (scene(|q| q, &in_order()), scene(|q| turn * q, &in_order()));
    for solver in frameworks() {
        let forces = Forces { gravity: Vec3::new(0.0, -9.81, 3.0), ..Forces::default() };
        let turned_forces = Forces { gravity: turn * forces.gravity, ..forces };
        let a = frames(&straight, solver, &forces, 10, 1).positions;
        let b = frames(&turned, solver, &turned_forces, 10, 1).positions;
        let back: Vec<Vec3> = b.iter().map(|q| turn.inverse() * *q).collect();
        let (off, bound) = (distance(&a, &back), bound(10, extent(&a)));
        println!("{off:.2e} of {bound:.2e}");
        assert!(off <= bound, "{solver:?}: {off} > {bound}");
    }
}

#[test]
fn moved() {
    // A multiple of every rest length, so that the model is the same to the last bit.
    let by = Vec3::new(16.0, -32.0, 8.0);
    let (near, far) = (scene(|q| q, &in_order()), scene(|q| q + by, &in_order()));
    assert_eq!(near.0, far.0);
    for solver in frameworks() {
        let a = frames(&near, solver, &Forces::default(), 10, 1).positions;
        let b = frames(&far, solver, &Forces::default(), 10, 1).positions;
        let back: Vec<Vec3> = b.iter().map(|q| *q - by).collect();
        let (off, bound) = (distance(&a, &back), bound(10, extent(&b)));
        println!("{off:.2e} of {bound:.2e}");
        assert!(off <= bound, "{solver:?}: {off} > {bound}");
    }
}

/// Another numbering has another coloring, but the same answer.
#[test]
fn renumbered() {
    let number = Random::new(4).permutation(81);
    let (mut straight, mut shuffled) = (scene(|q| q, &in_order()), scene(|q| q, &number));
    jitter(&straight.0, &mut straight.1, 0.005, 1);
    for (&at, &q) in number.iter().zip(&straight.1.positions) {
        shuffled.1.positions[at as usize] = q;
    }
    for framework in projective_dynamics() {
        let solver = Solver { framework, ..plain(gauss_seidel(1.5)) };
        let a = frames(&straight, solver, &Forces::default(), 2000, 1).positions;
        let b = frames(&shuffled, solver, &Forces::default(), 2000, 1).positions;
        let back: Vec<Vec3> = number.iter().map(|&at| b[at as usize]).collect();
        let (off, bound) = (distance(&a, &back), 2.0 * stall(&straight.0, &a));
        println!("{off:.2e} of {bound:.2e}");
        assert!(off <= bound, "{solver:?}: {off} > {bound}");
    }
}
