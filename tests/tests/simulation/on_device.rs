//! Collisions as kernels, over the CPU's backend: what a device does, without one. Rest, momentum, friction, and that nothing passes.

use glam::{Quat, Vec3};
use vivace_collision::{Obstacle, Options, Pose, Shape};
use vivace_model::{Forces, State};
use vivace_solver::{
    Base, Budget, ContactReport, Framework, Preconditioner, Relaxation, Solver, SolverError, System,
};
use vivace_tests::scenes::{Scene, plain};

use crate::NO_FORCE;
use crate::common::Random;
use crate::contacts::{
    H, as_kernels, assert_clean, carried, cloths, colliding, extent, fastest, floor,
    is_as_without_collisions, momentum_lost, on_host, options, slid, sphere, takes_back_forces,
};

const FRAMEWORKS: [Framework; 3] = [
    Framework::PositionBased,
    Framework::FUSED,
    Framework::ProjectiveDynamics {
        local: vivace_solver::LocalStep::Split { sweeps: 8 },
        vertex: vivace_solver::VertexSolve::Diagonal,
    },
];

fn system(scene: &Scene, solver: Solver, options: Options, obstacles: &[Obstacle]) -> System {
    colliding(as_kernels, scene, solver, options, obstacles)
}

#[test]
fn a_cloth_at_rest_on_a_sphere_stays_at_rest() {
    for framework in FRAMEWORKS {
        let scene = cloths(17, &[Pose::at(Vec3::new(0.01, 0.33, -0.02))]);
        let obstacles = [sphere(0.3, 0.6)];
        let solver = Solver { framework, ..Solver::default() };
        let mut system = system(&scene, solver, options(0.3), &obstacles);
        let (mut state, forces) = (scene.1.clone(), Forces { damping: 1.0, ..Forces::default() });
        let mut run = |n: u32, state: &mut State| {
            let mut last = ContactReport::default();
            for _ in 0..n {
                last = system.step(state, &forces, H, Budget::iterations(30)).unwrap().contacts;
            }
            last
        };
        run(360, &mut state);
        let before = state.positions.clone();
        let report = run(30, &mut state);
        let moved = crate::distance(&before, &state.positions);
        println!("{framework:?}: {} m/s, moved {moved} m, {report:?}", fastest(&state));
        assert!(report.contacts > 30, "{framework:?}: {report:?}");
        assert!(fastest(&state) < 0.05 && moved < 0.01, "{framework:?}: {} m/s, {moved} m", fastest(&state));
        assert!(report.deepest < 0.01 && report.left_out == 0, "{framework:?}: {report:?}");
        assert_clean(&scene.0, &state, &obstacles, "at rest");
    }
}

#[test]
fn projections_keep_the_momentum_of_colliding_bodies() {
    for friction in [0.0, 0.5] {
        let (off, seen) = momentum_lost(as_kernels, Framework::PositionBased, friction);
        assert!(off < 1e-4, "friction {friction}: {off}, {seen:?}");
    }
}

#[test]
fn friction_holds_below_the_cone_and_slides_above_it() {
    for framework in FRAMEWORKS {
        let solver = Solver { framework, ..Solver::default() };
        let held = slid(as_kernels, solver, 40, 24.0);
        let (angle, free) = (30.0_f32.to_radians(), slid(as_kernels, solver, 40, 30.0));
        let expected = 0.5 * 9.81 * (angle.sin() - 0.5 * angle.cos());
        println!("{framework:?}: {held} m at 24°, {free} m of {expected} at 30°");
        assert!(held.abs() < 0.005, "{framework:?}: slides by {held} m below the cone");
        assert!((free / expected - 1.0).abs() < 0.1, "{framework:?}: slides by {free} m, not {expected}");
    }
}

/// Sheets thrown at sheets and at obstacles with up to 20 m/s, half a metre in a frame.
#[test]
fn nothing_passes_through() {
    let mut random = Random::new(3);
    for k in 0..9 {
        let turn = |random: &mut Random| Quat::from_scaled_axis(random.vector() * 1.5);
        let place = |i: i32| Pose {
            position: Vec3::new(0.0, 0.55 + 0.35 * i as f32, 0.0),
            rotation: turn(&mut random),
        };
        let places: Vec<Pose> = (0..3).map(place).collect();
        let scene = cloths(7, &places);
        let mut state = scene.1.clone();
        let n = state.velocities.len() / 3;
        for (body, velocities) in state.velocities.chunks_mut(n).enumerate() {
            let speed = 10.0 * (1.0 + random.signed());
            let spread = random.vector();
            velocities.fill(speed * (Vec3::NEG_Y + 0.2 * spread) * if body == 0 { 0.3 } else { 1.0 });
        }
        let box_ = Shape::Cuboid { half_extent: Vec3::new(0.2, 0.1, 0.2) };
        let obstacle = match k / 3 {
            0 => sphere(0.25, 0.4),
            1 => Obstacle::fixed(box_, Pose::IDENTITY, 0.4),
            _ => Obstacle::fixed(Shape::Capsule { half_length: 0.2, radius: 0.1 }, Pose::IDENTITY, 0.4),
        };
        let obstacles = [obstacle, floor(-0.4, 0.4)];
        let framework = FRAMEWORKS[k % 3];
        let solver = Solver { framework, ..Solver::default() };
        let mut system = system(&scene, solver, options(0.3), &obstacles);
        let mut seen = ContactReport::default();
        for frame in 0..24 {
            let report = system.step(&mut state, &Forces::default(), H, Budget::iterations(10)).unwrap();
            seen.contacts += report.contacts.contacts;
            seen.held_back += report.contacts.held_back;
            seen.left_out += report.contacts.left_out;
            assert_clean(
                &scene.0,
                &state,
                &obstacles,
                &format!("drop {k}, frame {frame}, {framework:?}, {seen:?}"),
            );
        }
        println!("{k}: {seen:?}");
        assert!(seen.held_back > 0 && seen.left_out == 0, "{seen:?}");
    }
}

/// A heap of six cloths.
fn heap() -> (Scene, [Obstacle; 2]) {
    let place = |k: i32| Pose {
        position: Vec3::new(0.02 * (k % 3) as f32, 0.1 + 0.08 * k as f32, 0.03 * (k % 2) as f32),
        rotation: Quat::from_rotation_y(0.4 * k as f32),
    };
    let places: Vec<Pose> = (0..6).map(place).collect();
    (cloths(8, &places), [sphere(0.08, 0.5), floor(-0.08, 0.5)])
}

#[test]
fn a_heap_stays_finite_and_inside() {
    for framework in FRAMEWORKS {
        let (scene, obstacles) = heap();
        let solver = Solver { framework, ..Solver::default() };
        let mut system = system(&scene, solver, options(0.3), &obstacles);
        let mut state = scene.1.clone();
        let mut seen = ContactReport::default();
        for frame in 0..80 {
            let report = system.step(&mut state, &Forces::default(), H, Budget::iterations(8)).unwrap();
            assert!(extent(&state) < 3.0, "frame {frame}");
            seen.contacts += report.contacts.contacts;
            seen.left_out += report.contacts.left_out;
            if frame % 40 == 39 {
                assert_clean(&scene.0, &state, &obstacles, &format!("frame {frame}"));
                println!("{framework:?}, frame {frame}: {} m/s, {:?}", fastest(&state), report.contacts);
            }
        }
        assert_eq!(seen.left_out, 0, "{framework:?}: {seen:?}");
        assert!(fastest(&state) < 1.0, "{framework:?}: {}", fastest(&state));
    }
}

/// A sphere that rises by 0.2 m/s and turns about itself under a cloth.
fn turning(frame: u32) -> Obstacle {
    let pose = |k: u32| Pose {
        position: Vec3::new(0.02, 0.003 * k as f32, -0.01),
        rotation: Quat::from_rotation_y(0.05 * k as f32),
    };
    Obstacle { to: pose(frame + 1), ..Obstacle::fixed(Shape::Sphere { radius: 0.25 }, pose(frame), 0.4) }
}

/// Against the engine of the host, frame by frame from the same state. With obstacles a contact has one particle, and no order shows: what is
/// left are roundings, which grow over 40 iterations.
#[test]
fn the_host_does_the_same() {
    let gauss_seidel = |framework, substeps| Solver { framework, substeps, ..plain(Relaxation::default()) };
    let conjugate_gradient =
        Relaxation::ConjugateGradient { preconditioner: Preconditioner::Jacobi, inner: 8 };
    let solvers = [
        gauss_seidel(Framework::PositionBased, 1),
        gauss_seidel(Framework::PositionBased, 4),
        gauss_seidel(Framework::FUSED, 4),
        gauss_seidel(FRAMEWORKS[2], 4),
        Solver { framework: Framework::default(), ..plain(conjugate_gradient) },
    ];
    for solver in solvers {
        let scene = cloths(9, &[Pose::at(Vec3::new(0.01, 0.27, 0.0))]);
        let obstacles = [turning(0), floor(0.15, 0.5)];
        let options = Options { self_collision: false, ..options(0.3) };
        let mut on_device = system(&scene, solver, options, &obstacles);
        let mut on_host = colliding(on_host, &scene, solver, options, &obstacles);
        let (mut a, mut b, mut seen, mut n_same) = (scene.1.clone(), scene.1.clone(), 0, 0);
        for frame in 0..20 {
            for system in [&mut on_device, &mut on_host] {
                system.collisions_mut().unwrap().obstacles_mut()[0] = turning(frame);
            }
            let budget = Budget::iterations(40);
            let one = on_device.step(&mut a, &Forces::default(), H, budget).unwrap().contacts;
            let other = on_host.step(&mut b, &Forces::default(), H, budget).unwrap().contacts;
            let apart = crate::distance(&a.positions, &b.positions);
            let faster = crate::distance(&a.velocities, &b.velocities);
            assert!(one.contacts.abs_diff(other.contacts) <= 1, "{frame}: {one:?} {other:?}");
            // What grazes the margin is a contact to the one and not to the other.
            let is_same = one.contacts == other.contacts;
            let most = if is_same { (2e-5, 2e-3) } else { (2e-3, 0.2) };
            let what = format!("{solver:?}, frame {frame}: {apart} m, {faster} m/s, {one:?} {other:?}");
            assert!(apart < most.0 && faster < most.1, "{what}");
            n_same += usize::from(is_same);
            seen += one.contacts;
            b.clone_from(&a);
        }
        println!("{solver:?}: {seen} contacts, {n_same} frames alike");
        assert!(n_same >= 17 && seen > 300, "{solver:?}: {seen} contacts");
    }
}

/// Two sheets that meet: which of two folds a point falls into is up to the last bit, so where they come is not compared, but how many contacts
/// are found from the same state, which roundings decide where two primitives graze.
#[test]
fn the_host_finds_the_same_contacts() {
    let up = Pose { rotation: Quat::from_rotation_x(0.2), ..Pose::at(Vec3::new(0.05, 0.4, 0.03)) };
    let scene = cloths(9, &[Pose::at(Vec3::new(0.01, 0.27, 0.0)), up]);
    let obstacles = [sphere(0.25, 0.2), floor(-0.4, 0.2)];
    let solver = Solver { framework: Framework::PositionBased, ..Solver::default() };
    for every_pair in [false, true] {
        let options = Options { every_pair, ..options(0.2) };
        let mut on_device = system(&scene, solver, options, &obstacles);
        let mut on_host = colliding(on_host, &scene, solver, options, &obstacles);
        let (mut a, mut most) = (scene.1.clone(), 0);
        for frame in 0..30 {
            let mut b = a.clone();
            let budget = Budget::iterations(20);
            let one = on_device.step(&mut a, &Forces::default(), H, budget).unwrap().contacts;
            let other = on_host.step(&mut b, &Forces::default(), H, budget).unwrap().contacts;
            let found = one.contacts + one.left_out;
            assert!(found.abs_diff(other.contacts) <= 2 + other.contacts / 50, "{frame}: {one:?} {other:?}");
            most = most.max(found);
        }
        assert!(most > 300, "{every_pair}: {most} contacts");
    }
}

/// Sheets that lie at rest far apart begin on one another, so that there are more contacts than there is room for at first.
#[test]
fn room_grows_and_nothing_is_lost() {
    let apart: Vec<Pose> = (0..6).map(|k| Pose::at(Vec3::Y * k as f32)).collect();
    let scene = cloths(6, &apart);
    let solver = Solver { framework: Framework::PositionBased, ..Solver::default() };
    let mut on_device = system(&scene, solver, options(0.0), &[]);
    let mut on_host = colliding(on_host, &scene, solver, options(0.0), &[]);
    let mut a = scene.1.clone();
    a.positions.iter_mut().zip(0..).for_each(|(q, k)| q.y -= 0.998 * (k / 36) as f32);
    let mut b = a.clone();
    let one = on_device.step(&mut a, &NO_FORCE, H, Budget::iterations(10)).unwrap().contacts;
    let other = on_host.step(&mut b, &NO_FORCE, H, Budget::iterations(10)).unwrap().contacts;
    println!("{one:?} {other:?}");
    assert_eq!(one.left_out, 0, "{one:?}");
    assert!(one.contacts.abs_diff(other.contacts) <= other.contacts / 50, "{one:?} {other:?}");
}

#[test]
fn forces_of_contacts_are_taken_back_with_what_they_did() {
    takes_back_forces(as_kernels);
}

#[test]
fn friction_carries_as_fast_as_the_floor_goes() {
    for framework in FRAMEWORKS {
        let way = carried(as_kernels, Solver { framework, substeps: 4, ..Solver::default() });
        assert!((way - 0.3).abs() < 0.01, "{framework:?}: {way} m");
    }
}

#[test]
fn threads_do_not_show() {
    for framework in FRAMEWORKS {
        for relaxation in [
            Relaxation::default(),
            Relaxation::GaussSeidel { omega: 1.2, base: Base::PreviousInPlace },
            Relaxation::Jacobi { omega: 2.0 / 3.0 },
        ] {
            let solver = Solver { framework, relaxation, substeps: 2, ..Solver::default() };
            let run = |n_threads: usize| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
                pool.install(|| {
                    let (scene, obstacles) = heap();
                    let mut system = system(&scene, solver, options(0.3), &obstacles);
                    let (mut state, mut reports) = (scene.1.clone(), Vec::new());
                    state.velocities.fill(Vec3::new(0.0, -2.0, 0.0));
                    for _ in 0..4 {
                        let budget = Budget::iterations(7);
                        let report = system.step(&mut state, &Forces::default(), H, budget).unwrap();
                        reports.push(report.contacts);
                    }
                    (state, reports)
                })
            };
            let one = run(1);
            assert!(one.1.iter().any(|report| report.contacts > 20), "{:?}", one.1.last());
            for n_threads in [2, 7] {
                assert!(run(n_threads) == one, "{solver:?} on {n_threads}");
            }
        }
    }
}

#[test]
fn a_scene_without_contacts_is_as_it_was() {
    let solver = |framework| Solver { framework, ..Solver::default() };
    FRAMEWORKS.into_iter().for_each(|framework| is_as_without_collisions(as_kernels, solver(framework)));
}

/// Where there is room for few contacts, the report says how many were left out, and the guard still lets nothing pass.
#[test]
fn what_finds_no_room_is_reported() {
    let (scene, obstacles) = heap();
    let few = Options { max_contacts: 50, ..options(0.3) };
    let mut system = system(&scene, Solver::default(), few, &obstacles);
    let (mut state, mut seen) = (scene.1.clone(), ContactReport::default());
    for frame in 0..25 {
        let report = system.step(&mut state, &Forces::default(), H, Budget::iterations(8)).unwrap();
        seen.left_out += report.contacts.left_out;
        assert_clean(&scene.0, &state, &obstacles, &format!("frame {frame}"));
    }
    assert!(seen.left_out > 100, "{seen:?}");
}

#[test]
fn what_cannot_be_is_refused_and_changes_nothing() {
    let scene = cloths(4, &[Pose::IDENTITY]);
    let mut system = system(&scene, Solver::default(), options(0.0), &[sphere(-1.0, 0.0)]);
    let mut state = scene.1.clone();
    let error = system.step(&mut state, &Forces::default(), H, Budget::iterations(5)).unwrap_err();
    assert!(matches!(error, SolverError::Collision(_)), "{error}");
    assert_eq!(state, scene.1);
    // Another framework, and collisions go with it; none, and they are gone.
    system.collisions_mut().unwrap().obstacles_mut()[0] = floor(-0.005, 0.0);
    for framework in FRAMEWORKS {
        system.set_solver(Solver { framework, ..Solver::default() }).unwrap();
        let mut state = scene.1.clone();
        let report = system.step(&mut state, &Forces::default(), H, Budget::iterations(5)).unwrap();
        assert_eq!(report.contacts.contacts, 16, "{framework:?}");
    }
    system.set_collisions(None).unwrap();
    let report = system.step(&mut state, &Forces::default(), H, Budget::iterations(5)).unwrap();
    assert_eq!(report.contacts, ContactReport::default());
}
