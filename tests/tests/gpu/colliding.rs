//! Whole frames with collisions: against the same kernels on the CPU, their dispatches, their memory.

#![expect(clippy::unwrap_used, reason = "what fails here fails a test")]

use glam::{Quat, Vec3};
use vivace_collision::{Obstacle, Options, Pose, Shape};
use vivace_cpu::Cpu;
use vivace_gpu::{Footprint, Gpu};
use vivace_mesh::{TriMesh, cloth};
use vivace_model::{Forces, Model, ModelBuilder, State};
use vivace_solver::{Budget, Collisions, Framework, Solver, System};

use crate::gpu;

/// Two cloths over a ball that stands on the floor, and their collisions.
fn pile() -> (Model, State, Collisions) {
    let mesh = cloth::regular(9, 9, 0.06).unwrap();
    let mut builder = ModelBuilder::new();
    for k in 0..2 {
        let place = |p: &Vec3| {
            Quat::from_rotation_y(0.4 * k as f32) * (*p - 0.24) + Vec3::Y * (0.56 + 0.05 * k as f32)
        };
        let placed = mesh.positions().iter().map(place).collect();
        let placed = TriMesh::new(placed, mesh.triangles().to_vec()).unwrap();
        let first = builder.cloth(&placed, 0.2).unwrap();
        builder.springs(first, &placed.edges(), 100.0).unwrap();
    }
    let (model, state) = builder.build().unwrap();
    let options = Options { friction: 0.3, ..Options::new(0.015) };
    let mut collisions = Collisions::new(&model, &state.positions, options).unwrap();
    let at = |y: f32| Pose::at(Vec3::new(0.0, y, 0.0));
    collisions.obstacles_mut().extend([
        Obstacle::fixed(Shape::Sphere { radius: 0.2 }, at(0.05), 0.4),
        Obstacle::fixed(Shape::Plane, at(-0.1), 0.4),
    ]);
    (model, state, collisions)
}

fn frameworks() -> [Solver; 3] {
    [Framework::PositionBased, Framework::FUSED, Framework::default()]
        .map(|framework| Solver { framework, ..Solver::default() })
}

/// Frames with contacts against the same kernels on the CPU. Roundings of 10⁻⁷ m decide whether a pair that grazes is a contact, so the bound
/// is on frames that begin alike.
#[test]
fn frames_with_contacts_are_those_of_the_cpu() {
    for solver in frameworks() {
        let (model, state, collisions) = pile();
        let (_, _, same) = pile();
        let mut on_gpu = System::on(model.clone(), solver, gpu()).unwrap();
        let mut on_cpu = System::on(model, solver, Cpu::new()).unwrap();
        on_gpu.set_collisions(Some(collisions)).unwrap();
        on_cpu.set_collisions(Some(same)).unwrap();
        let (mut a, mut b, mut most) = (state.clone(), state, 0);
        let (mut worst, mut seen) = (0.0_f32, 0);
        for frame in 0..20 {
            let budget = Budget::iterations(6);
            let one = on_gpu.step(&mut a, &Forces::default(), 1.0 / 60.0, budget).unwrap().contacts;
            let other = on_cpu.step(&mut b, &Forces::default(), 1.0 / 60.0, budget).unwrap().contacts;
            let apart = a.positions.iter().zip(&b.positions).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
            worst = worst.max(apart);
            most = most.max(one.contacts);
            assert!(apart < 1e-6, "{solver:?}, frame {frame}: {apart} m");
            let off = one.contacts.abs_diff(other.contacts);
            assert!(off <= 1 + other.contacts / 50, "frame {frame}: {one:?} {other:?}");
            assert_eq!((one.left_out, other.left_out), (0, 0));
            seen += one.contacts;
            b.clone_from(&a);
        }
        println!("{:?}: {worst} m, {most} contacts at most", solver.framework);
        assert!(seen > 500, "{seen} contacts");
    }
}

/// A frame with contacts has the same dispatches whatever it finds, takes no memory after the first, and leaves nothing behind where collisions
/// are taken away.
#[test]
fn dispatches_are_counted_and_memory_is_kept() {
    for solver in frameworks() {
        let (model, mut state, collisions) = pile();
        let mut system = System::on(model, solver, gpu()).unwrap();
        let mut frame = |system: &mut System| {
            let before = system.resident::<Gpu>().unwrap().backend.n_dispatches();
            system.step(&mut state, &Forces::default(), 1.0 / 60.0, Budget::iterations(3)).unwrap();
            let gpu = system.resident::<Gpu>().unwrap().backend;
            (gpu.n_dispatches() - before, gpu.allocated())
        };
        frame(&mut system);
        let (alone, _) = frame(&mut system);
        system.set_collisions(Some(collisions)).unwrap();
        frame(&mut system);
        let first = frame(&mut system);
        for _ in 0..22 {
            assert_eq!(frame(&mut system), first);
        }
        println!("{:?}: {alone} dispatches a frame, {} with collisions", solver.framework, first.0);
        system.set_collisions(None).unwrap();
        frame(&mut system);
        assert_eq!(frame(&mut system).0, alone);
    }
}

/// What a device will have allocated is known without one.
#[test]
fn memory_of_collisions_is_known_before() {
    for solver in frameworks() {
        let run = |system: &mut System, collisions, mut state| {
            system.set_collisions(Some(collisions)).unwrap();
            for _ in 0..3 {
                system.step(&mut state, &Forces::default(), 1.0 / 60.0, Budget::iterations(3)).unwrap();
            }
        };
        let (model, state, collisions) = pile();
        let mut system = System::on(model, solver, gpu()).unwrap();
        run(&mut system, collisions, state);
        let found = system.resident::<Gpu>().unwrap().backend.allocated();
        let (model, state, collisions) = pile();
        let device = Footprint::new();
        run(&mut System::on(model, solver, device.clone()).unwrap(), collisions, state);
        assert_eq!(device.allocated(), found, "{:?}", solver.framework);
    }
}
