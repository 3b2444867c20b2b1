//! The scenes that collide, scaled down, for long.

use glam::Vec3;
use vivace_scene::{Obstacle, Scene, Solid, heap, noodles, pinch, stack};
use vivace_sim::{Budget, Framework, Simulation, Solver};
use vivace_tests::crossings::crossings;

/// Nine cloths on an armchair, 10,000 frames: finite, within the walls of a room of 6 m, and contacts have no more colors at the end than in the beginning.
#[test]
fn frames_of_the_heap_stay_in_the_room() {
    const N_FRAMES: usize = 10_000;
    let mut scene = heap(3);
    let walls = [(Vec3::X, Vec3::new(0.0, 0.0, 90.0)), (Vec3::Z, Vec3::new(-90.0, 0.0, 0.0))];
    for (axis, rotate) in walls.into_iter().flat_map(|(axis, turn)| [(axis, turn), (-axis, -turn)]) {
        let wall = Obstacle { at: 3.0 * axis, rotate, friction: 0.6, ..Obstacle::new(Solid::Plane) };
        scene.collisions.as_mut().unwrap().obstacles.push(wall);
    }
    let mut simulation = Simulation::new(&scene, Solver::default()).unwrap();
    let mut colors = [0; 10];
    for frame in 0..N_FRAMES {
        let report = simulation.step(Budget::iterations(6)).unwrap();
        let tenth = 10 * frame / N_FRAMES;
        colors[tenth] = report.contacts.colors.max(colors[tenth]);
        let is_out = |p: &Vec3| !(p.x.abs() < 3.0 && p.z.abs() < 3.0 && p.y > 0.0 && p.y < 3.0);
        let out = simulation.positions().iter().position(is_out);
        assert_eq!(out, None, "frame {frame}: {:?}", out.map(|k| simulation.positions()[k]));
        if frame % 50 == 0 {
            let found = crossings(simulation.positions(), simulation.model().surface());
            assert!(found.is_empty(), "frame {frame}: {found:?}");
        }
    }
    println!("colors by tenths: {colors:?}");
    assert!(colors[9] <= colors[0], "{colors:?}");
    // At first they fall; later there is nothing but drift.
    assert!(colors[9] <= *colors[5..9].iter().max().unwrap(), "{colors:?}");
}

/// What is pinched is lifted, and what lies below stays; nothing crosses.
#[test]
fn a_pinched_cloth_is_lifted_off_the_heap() {
    let solver = Solver { framework: Framework::PositionBased, substeps: 4, ..Solver::default() };
    let mut simulation = Simulation::new(&pinch(5), solver).unwrap();
    // In the middle of the uppermost cloth.
    let pinched = simulation.particles_of(8).unwrap().start + 12;
    let height = |simulation: &Simulation| simulation.positions()[pinched].y;
    let mut before = 0.0;
    for frame in 0..45 {
        if frame == 27 {
            before = height(&simulation);
        }
        simulation.step(Budget::iterations(8)).unwrap();
        let found = crossings(simulation.positions(), simulation.model().surface());
        assert!(found.is_empty(), "frame {frame}: {found:?}");
    }
    let after = height(&simulation);
    assert!(after > before + 0.25, "{before} {after}");
}

/// Noodles that fall on one another do not jam: hardly any particle is held back, and no edge is stretched much.
#[test]
fn noodles_do_not_jam() {
    for solver in [
        Solver::default(),
        Solver { substeps: 4, ..Solver::default() },
        Solver { framework: Framework::PositionBased, substeps: 4, ..Solver::default() },
    ] {
        let mut simulation = Simulation::new(&noodles(2), solver).unwrap();
        let (start, surface) = (simulation.positions().to_vec(), simulation.model().surface().to_vec());
        let (mut held, mut contacts, mut stretch) = (0, 0, 0.0_f32);
        for _ in 0..40 {
            let report = simulation.step(Budget::iterations(16)).unwrap().contacts;
            (held, contacts) = (held + report.held_back, contacts + report.contacts);
            let length = |q: &[Vec3], a: u32, b: u32| q[a as usize].distance(q[b as usize]);
            for [a, b, c] in &surface {
                for (a, b) in [(a, b), (b, c), (c, a)] {
                    let longer = length(simulation.positions(), *a, *b) / length(&start, *a, *b) - 1.0;
                    stretch = stretch.max(longer);
                }
            }
        }
        println!("{solver:?}: {held} held back, {contacts} contacts, stretched by {stretch}");
        assert!(contacts > 5000 && 100 * held < contacts, "{solver:?}: {held} of {contacts}");
        assert!(stretch < 1.5, "{solver:?}: {stretch}");
    }
}

/// At the end of each frame no edge crosses a triangle, in both frameworks and in all scenes that collide.
#[test]
fn nothing_crosses_at_the_end_of_a_frame() {
    let scenes: [(Scene, usize); 3] = [(noodles(2), 14), (heap(5), 20), (stack(2), 40)];
    for (scene, n_frames) in scenes {
        let triangles = scene.build(".".as_ref()).unwrap().0.surface().to_vec();
        for framework in [Framework::default(), Framework::PositionBased] {
            let solver = Solver { framework, ..Solver::default() };
            let mut simulation = Simulation::new(&scene, solver).unwrap();
            assert!(crossings(simulation.positions(), &triangles).is_empty(), "{} at the start", scene.name);
            let mut contacts = 0;
            for frame in 0..n_frames {
                contacts += simulation.step(Budget::iterations(6)).unwrap().contacts.contacts;
                let found = crossings(simulation.positions(), &triangles);
                assert!(found.is_empty(), "{}, frame {frame}, {framework:?}: {found:?}", scene.name);
            }
            println!("{}, {framework:?}: {contacts} contacts", scene.name);
            assert!(contacts > 1000, "{}: {contacts}", scene.name);
        }
    }
}
