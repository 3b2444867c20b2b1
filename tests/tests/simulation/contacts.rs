//! Contacts: rest, momentum, friction, and that nothing passes through.

use glam::{DVec3, Quat, Vec3};
use vivace_collision::{Obstacle, Options, Pose, Shape};
use vivace_cpu::Cpu;
use vivace_mesh::{TriMesh, ball, cloth};
use vivace_model::{Forces, Model, ModelBuilder, State};
use vivace_solver::{
    Base, Budget, Collisions, ContactReport, Framework, LocalStep, Preconditioner, Relaxation, Rho, Solver,
    SolverError, StepReport, System, VertexSolve,
};
use vivace_tests::scenes::{Scene, gauss_seidel, plain};

use crate::common::{Random, intersection, outside};
use crate::{NO_FORCE, moment};

pub(crate) const H: f32 = 1.0 / 60.0;

fn frameworks() -> [Framework; 4] {
    let pd = |local, vertex| Framework::ProjectiveDynamics { local, vertex };
    [
        Framework::default(),
        Framework::FUSED,
        pd(LocalStep::Fused, VertexSolve::Block),
        Framework::PositionBased,
    ]
}

/// Cloths of `n` × `n` particles, 0.04 m apart, each placed.
pub(crate) fn cloths(n: usize, places: &[Pose]) -> Scene {
    let flat = cloth::regular(n, n, 0.04).unwrap();
    let half = 0.02 * (n - 1) as f32 * Vec3::new(1.0, 0.0, 1.0);
    let mut builder = ModelBuilder::new();
    for place in places {
        let placed = flat.positions().iter().map(|p| place.rotation * (*p - half) + place.position).collect();
        let mesh = TriMesh::new(placed, flat.triangles().to_vec()).unwrap();
        let first = builder.cloth(&mesh, 0.2).unwrap();
        builder.springs(first, &mesh.edges(), 100.0).unwrap();
        builder.hinges(first, &mesh.hinges(), 1e-5, false).unwrap();
    }
    builder.build().unwrap()
}

pub(crate) fn options(friction: f32) -> Options {
    Options { friction, ..Options::new(0.01) }
}

/// Makes a system: [`on_host`], or [`as_kernels`] over the CPU's backend.
pub(crate) type Make = fn(&Scene, Solver) -> System;

pub(crate) fn on_host(scene: &Scene, solver: Solver) -> System {
    System::new(scene.0.clone(), solver).unwrap()
}

pub(crate) fn as_kernels(scene: &Scene, solver: Solver) -> System {
    System::on(scene.0.clone(), solver, Cpu::new()).unwrap()
}

pub(crate) fn colliding(
    make: Make,
    scene: &Scene,
    solver: Solver,
    options: Options,
    obstacles: &[Obstacle],
) -> System {
    let mut collisions = Collisions::new(&scene.0, &scene.1.positions, options).unwrap();
    collisions.obstacles_mut().extend_from_slice(obstacles);
    let mut system = make(scene, solver);
    system.set_collisions(Some(collisions)).unwrap();
    system
}

fn system(scene: &Scene, solver: Solver, options: Options, obstacles: &[Obstacle]) -> System {
    colliding(on_host, scene, solver, options, obstacles)
}

pub(crate) fn sphere(radius: f32, friction: f32) -> Obstacle {
    Obstacle::fixed(Shape::Sphere { radius }, Pose::IDENTITY, friction)
}

pub(crate) fn floor(y: f32, friction: f32) -> Obstacle {
    Obstacle::fixed(Shape::Plane, Pose::at(Vec3::new(0.0, y, 0.0)), friction)
}

pub(crate) fn fastest(state: &State) -> f32 {
    state.velocities.iter().map(|v| v.length()).fold(0.0, f32::max)
}

/// Nothing intersects, nobody is inside.
pub(crate) fn assert_clean(model: &Model, state: &State, obstacles: &[Obstacle], what: &str) {
    let found = intersection(&state.positions, &model.surface().to_vec());
    assert_eq!(found, None, "{what}");
    for obstacle in obstacles {
        let inside = state.positions.iter().position(|&p| !outside(obstacle, p, -1e-6));
        assert_eq!(inside, None, "{what}: inside of {obstacle:?}");
    }
}

/// Each framework, and each relaxation.
fn solvers() -> Vec<Solver> {
    let relaxations = [
        Relaxation::Jacobi { omega: 0.66 },
        Relaxation::Chebyshev { rho: Rho::Given(0.99), gamma: 0.7, delay: 10 },
        Relaxation::SymmetricChebyshev { rho: Rho::Given(0.95) },
        Relaxation::ChebyshevGaussSeidel { rho: Rho::Given(0.95), delay: 10 },
        Relaxation::Lexicographic { omega: 1.5 },
        Relaxation::ConjugateGradient { preconditioner: Preconditioner::Jacobi, inner: 8 },
        Relaxation::Direct,
    ];
    let framework = |framework| Solver { framework, ..Solver::default() };
    let relaxation = |relaxation| Solver { relaxation, ..Solver::default() };
    frameworks().map(framework).into_iter().chain(relaxations.map(relaxation)).collect()
}

#[test]
fn a_cloth_at_rest_on_a_sphere_stays_at_rest() {
    solvers().into_iter().for_each(rests_on_a_sphere);
}

fn rests_on_a_sphere(solver: Solver) {
    let scene = cloths(17, &[Pose::at(Vec3::new(0.01, 0.33, -0.02))]);
    let obstacles = [sphere(0.3, 0.6)];
    let mut system = system(&scene, solver, options(0.3), &obstacles);
    let mut state = scene.1.clone();
    let forces = Forces { damping: 1.0, ..Forces::default() };
    let mut run = |n: u32, state: &mut State| {
        let mut last = StepReport::default();
        for _ in 0..n {
            last = system.step(state, &forces, H, Budget::iterations(30)).unwrap();
        }
        last
    };
    run(240, &mut state);
    let before = state.positions.clone();
    let report = run(30, &mut state);
    let moved = crate::distance(&before, &state.positions);
    println!("{solver:?}: {} m/s, moved {moved} m, {:?}", fastest(&state), report.contacts);
    assert!(report.contacts.contacts > 30, "{solver:?}: {:?}", report.contacts);
    assert!(fastest(&state) < 0.02 && moved < 0.005, "{solver:?}: {} m/s, {moved} m", fastest(&state));
    assert!(report.contacts.deepest < 0.001, "{solver:?}: {:?}", report.contacts);
    assert_clean(&scene.0, &state, &obstacles, "at rest");
}

/// One cloth is thrown at another: by which part of itself the momentum of both has changed until they part, and what contacts did. (Sweeps that
/// have not converged lose some of it in free flight, too.)
pub(crate) fn momentum_lost(make: Make, framework: Framework, friction: f32) -> (f64, ContactReport) {
    let up = Pose { rotation: Quat::from_rotation_x(0.3), ..Pose::at(Vec3::new(0.05, 0.06, 0.03)) };
    let (model, mut state) = cloths(9, &[Pose::IDENTITY, up]);
    let scene = (model.clone(), state.clone());
    let half = state.velocities.len() / 2;
    state.velocities[half..].fill(Vec3::new(0.3, -2.0, 0.1));
    let momentum = |state: &State| moment(&model, state.velocities.iter().map(|v| v.as_dvec3()));
    let before = momentum(&state);
    let solver = Solver { framework, ..Solver::default() };
    let mut system = colliding(make, &scene, solver, options(friction), &[]);
    let (mut seen, mut after) = (ContactReport::default(), before);
    for _ in 0..20 {
        let report = system.step(&mut state, &NO_FORCE, H, Budget::iterations(20)).unwrap().contacts;
        seen.contacts += report.contacts;
        seen.held_back += report.held_back;
        seen.left_out += report.left_out;
        if report.contacts == 0 && seen.contacts > 0 {
            break;
        }
        after = momentum(&state);
    }
    let off = (after - before).length() / before.length();
    let of_first = |(k, v): (usize, &Vec3)| if k < half { v.as_dvec3() } else { DVec3::ZERO };
    let passed = moment(&model, state.velocities.iter().enumerate().map(of_first));
    println!("{framework:?} {friction}: {off}, {passed} of {before}, {seen:?}");
    assert!(seen.contacts > 100 && passed.y < 0.2 * before.y, "{framework:?}: nothing collided");
    assert_clean(&model, &state, &[], "after the collision");
    (off, seen)
}

#[test]
fn colliding_bodies_keep_their_momentum() {
    for framework in frameworks() {
        for friction in [0.0, 0.5] {
            let (off, seen) = momentum_lost(on_host, framework, friction);
            assert!(off < 1e-5, "{framework:?}, friction {friction}: {off}, {seen:?}");
        }
    }
}

/// What lies on a cloth that is held at its corners hangs there, and does not fall as if nobody held the two of them. The cloth alone hangs
/// 0.03 m low.
#[test]
fn what_lies_on_a_held_cloth_is_held() {
    let n = 9;
    let flat = cloth::regular(n, n, 0.04).unwrap();
    let half = 0.02 * (n - 1) as f32 * Vec3::new(1.0, 0.0, 1.0);
    let mut builder = ModelBuilder::new();
    for (height, size) in [(0.0, 1.0), (0.012, 0.75)] {
        let placed = flat.positions().iter().map(|p| size * (*p - half) + height * Vec3::Y).collect();
        let mesh = TriMesh::new(placed, flat.triangles().to_vec()).unwrap();
        let first = builder.cloth(&mesh, 0.2).unwrap();
        builder.springs(first, &mesh.edges(), 100.0).unwrap();
    }
    [0, 8, 72, 80].into_iter().for_each(|corner| builder.pin(corner).unwrap());
    let scene = builder.build().unwrap();
    let sag = |framework: Framework, iterations: u32| {
        let mut system = system(&scene, Solver { framework, ..Solver::default() }, options(0.3), &[]);
        let mut state = scene.1.clone();
        let forces = Forces { damping: 1.0, ..Forces::default() };
        for _ in 0..60 {
            system.step(&mut state, &forces, H, Budget::iterations(iterations)).unwrap();
        }
        assert_clean(&scene.0, &state, &[], "in the hammock");
        let sag = -state.positions.iter().map(|p| p.y).fold(f32::INFINITY, f32::min);
        println!("{framework:?}, {iterations} iterations: {sag} m, {} m/s", fastest(&state));
        sag
    };
    for framework in frameworks() {
        // All come to 0.041 m, some slowly.
        let (few, many) = (sag(framework, 30), sag(framework, 400));
        let most = if framework == Framework::PositionBased { 0.08 } else { 0.15 };
        assert!(few < most, "{framework:?}: {few} m");
        assert!(many > 0.035 && many < 0.055, "{framework:?}: {many} m");
    }
}

/// A small cloth on a slope of `degrees`, under friction 0.5 = tan 26.6°: how far it is down the slope after a second \[m\].
pub(crate) fn slid(make: Make, solver: Solver, iterations: u32, degrees: f32) -> f32 {
    let scene = cloths(4, &[Pose::at(Vec3::new(0.0, 0.0101, 0.0))]);
    let mut system = colliding(make, &scene, solver, options(0.0), &[floor(0.0, 0.5)]);
    let (mut state, turn) = (scene.1.clone(), degrees.to_radians());
    let gravity = 9.81 * Vec3::new(turn.sin(), -turn.cos(), 0.0);
    let forces = Forces { gravity, ..NO_FORCE };
    for _ in 0..60 {
        system.step(&mut state, &forces, H, Budget::iterations(iterations)).unwrap();
    }
    let mean = |q: &[Vec3]| q.iter().map(|q| q.x).sum::<f32>() / q.len() as f32;
    mean(&state.positions) - mean(&scene.1.positions)
}

#[test]
fn friction_holds_below_the_cone_and_slides_above_it() {
    for (iterations, solver) in solvers().into_iter().flat_map(|solver| [(4, solver), (40, solver)]) {
        let held = slid(on_host, solver, iterations, 24.0);
        let (angle, free) = (30.0_f32.to_radians(), slid(on_host, solver, iterations, 30.0));
        let expected = 0.5 * 9.81 * (angle.sin() - 0.5 * angle.cos());
        let what = format!("{solver:?}, {iterations} iterations");
        println!("{what}: {held} m at 24°, {free} m of {expected} at 30°");
        assert!(held.abs() < 0.002, "{what}: slides by {held} m below the cone");
        assert!((free / expected - 1.0).abs() < 0.03, "{what}: slides by {free} m, not {expected}");
    }
}

/// Two ways to diverge are taken back at the same look, and an iteration without acceleration follows: that ends at the same positions, so the
/// forces of contacts were taken back, too.
pub(crate) fn takes_back_forces(make: Make) {
    let scene = cloths(8, &[Pose::at(Vec3::new(0.0, 0.0101, 0.0))]);
    let mut start = scene.1.clone();
    let mut random = Random::new(4);
    start.positions.iter_mut().for_each(|p| *p += 0.004 * (random.vector() * Vec3::new(1.0, 0.0, 1.0)));
    let forces = Forces { gravity: Vec3::NEG_Y, ..NO_FORCE };
    let ends = [1.9, 1.95].map(|omega| {
        let relaxation = Relaxation::GaussSeidel { omega, base: Base::PreviousInPlace };
        let solver = Solver { safeguard: true, ..plain(relaxation) };
        let mut system = colliding(make, &scene, solver, options(0.5), &[floor(0.0, 0.5)]);
        let mut state = start.clone();
        let report = system.step(&mut state, &forces, H, Budget::iterations(9)).unwrap();
        assert!(report.backoffs == 1 && report.contacts.contacts == 64, "{report:?}");
        state
    });
    assert_eq!(ends[0], ends[1]);
}

#[test]
fn forces_of_contacts_are_taken_back_with_what_they_did() {
    takes_back_forces(on_host);
}

/// A cloth on a floor that is drawn away under it by 0.3 m/s: how far it goes in a second \[m\].
pub(crate) fn carried(make: Make, solver: Solver) -> f32 {
    let scene = cloths(4, &[Pose::at(Vec3::new(0.0, 0.0101, 0.0))]);
    let at = |frame: u32| Pose::at(Vec3::new(0.3 * H * frame as f32, 0.0, 0.0));
    let still = Obstacle::fixed(Shape::Plane, at(0), 0.9);
    let mut system = colliding(make, &scene, solver, options(0.0), std::slice::from_ref(&still));
    let mut state = scene.1.clone();
    for frame in 0..60 {
        let moving = Obstacle { from: at(frame), to: at(frame + 1), ..still.clone() };
        system.collisions_mut().unwrap().obstacles_mut()[0] = moving;
        system.step(&mut state, &Forces::default(), H, Budget::iterations(16)).unwrap();
    }
    let mean = |q: &[Vec3]| q.iter().map(|q| q.x).sum::<f32>() / q.len() as f32;
    mean(&state.positions) - mean(&scene.1.positions)
}

/// In small steps an obstacle goes its way but once.
#[test]
fn friction_carries_as_fast_as_the_floor_goes() {
    for framework in frameworks() {
        for substeps in [1, 4] {
            let solver = Solver { framework, substeps, ..Solver::default() };
            let way = carried(on_host, solver);
            assert!((way - 0.3).abs() < 0.01, "{solver:?}: {way} m");
        }
    }
}

/// Sheets thrown at sheets and at obstacles with up to 20 m/s, half a metre in a frame.
#[test]
fn nothing_passes_through() {
    let mut random = Random::new(3);
    for k in 0..8 {
        let turn = |random: &mut Random| Quat::from_scaled_axis(random.vector() * 1.5);
        let places: Vec<Pose> = (0..3)
            .map(|i| Pose {
                position: Vec3::new(0.0, 0.55 + 0.35 * i as f32, 0.0),
                rotation: turn(&mut random),
            })
            .collect();
        let scene = cloths(7, &places);
        let mut state = scene.1.clone();
        let n = state.velocities.len() / 3;
        for (body, velocities) in state.velocities.chunks_mut(n).enumerate() {
            let speed = 10.0 * (1.0 + random.signed());
            let spread = random.vector();
            velocities.fill(speed * (Vec3::NEG_Y + 0.2 * spread) * if body == 0 { 0.3 } else { 1.0 });
        }
        let box_ = Shape::Cuboid { half_extent: Vec3::new(0.2, 0.1, 0.2) };
        let obstacle = match k % 3 {
            0 => sphere(0.25, 0.4),
            1 => Obstacle::fixed(box_, Pose::IDENTITY, 0.4),
            _ => Obstacle::fixed(Shape::Capsule { half_length: 0.2, radius: 0.1 }, Pose::IDENTITY, 0.4),
        };
        let obstacles = [obstacle, floor(-0.4, 0.4)];
        let framework = frameworks()[k % 4];
        let solver = Solver { framework, ..Solver::default() };
        let mut system = system(&scene, solver, options(0.3), &obstacles);
        for frame in 0..40 {
            let report = system.step(&mut state, &Forces::default(), H, Budget::iterations(10)).unwrap();
            assert_eq!(report.contacts.left_out, 0);
            assert_clean(&scene.0, &state, &obstacles, &format!("drop {k}, frame {frame}, {framework:?}"));
        }
    }
}

/// Sixteen small steps of one iteration: a cloth that is draped over a sphere and folds on the floor is clean, hardly stretched,
/// and comes to rest.
#[test]
fn small_steps_drape_a_cloth() {
    let scene = cloths(25, &[Pose::at(Vec3::new(0.0, 0.4, 0.0))]);
    let obstacles = [sphere(0.25, 0.3), floor(-0.3, 0.3)];
    for framework in [Framework::FUSED, Framework::PositionBased] {
        let solver = Solver { framework, substeps: 16, ..plain(gauss_seidel(1.0)) };
        let mut system = system(&scene, solver, options(0.3), &obstacles);
        let mut state = scene.1.clone();
        let forces = Forces { damping: 1.0, ..Forces::default() };
        for frame in 0..180 {
            let report = system.step(&mut state, &forces, H, Budget::iterations(16)).unwrap();
            assert_eq!(report.iterations, 16);
            if frame % 10 == 9 {
                assert_clean(&scene.0, &state, &obstacles, &format!("frame {frame}, {framework:?}"));
            }
        }
        let springs = &scene.0.constraints().springs;
        let length = |q: &[Vec3]| {
            springs
                .particles
                .iter()
                .map(|pair| q[pair[0] as usize].distance(q[pair[1] as usize]))
                .sum::<f32>()
        };
        let stretch = length(&state.positions) / length(&scene.1.positions) - 1.0;
        println!("{framework:?}: {stretch}, {} m/s", fastest(&state));
        assert!(stretch.abs() < 0.05, "{framework:?}: {stretch}");
        assert!(fastest(&state) < 0.5, "{framework:?}: {} m/s", fastest(&state));
    }
}

/// A heap of nine cloths in a corner of the room: finite and inside, colors as they were.
#[test]
fn a_heap_stays_finite_and_inside() {
    let places: Vec<Pose> = (0..9)
        .map(|k| Pose {
            position: Vec3::new(0.02 * (k % 3) as f32, 0.1 + 0.08 * k as f32, 0.03 * (k % 2) as f32),
            rotation: Quat::from_rotation_y(0.4 * k as f32),
        })
        .collect();
    let scene = cloths(8, &places);
    let obstacles = [sphere(0.08, 0.5), floor(-0.08, 0.5)];
    let mut system = system(&scene, Solver::default(), options(0.3), &obstacles);
    let (mut state, mut most) = (scene.1.clone(), [0; 2]);
    for frame in 0..160 {
        let report = system.step(&mut state, &Forces::default(), H, Budget::iterations(8)).unwrap();
        let half = frame / 80;
        most[half] = most[half].max(report.contacts.colors);
        assert!(extent(&state) < 3.0, "frame {frame}");
        if frame % 40 == 39 {
            assert_clean(&scene.0, &state, &obstacles, &format!("frame {frame}"));
        }
    }
    println!("colors: {most:?}");
    assert!(most[1] <= most[0] + 2, "{most:?}");
    assert!(fastest(&state) < 1.0, "{}", fastest(&state));
}

pub(crate) fn extent(state: &State) -> f32 {
    state
        .positions
        .iter()
        .map(|p| if p.is_finite() { p.abs().max_element() } else { f32::INFINITY })
        .fold(0.0, f32::max)
}

/// Where two balls and a cloth end that fall on one another, and all that was reported.
fn on_threads(solver: Solver, n_threads: usize) -> (State, Vec<ContactReport>) {
    let mut builder = ModelBuilder::new();
    let sheet = cloth::regular(40, 40, 0.04).unwrap();
    let first = builder.cloth(&sheet, 0.2).unwrap();
    builder.springs(first, &sheet.edges(), 100.0).unwrap();
    for at in [Vec3::new(0.7, 0.215, 0.7), Vec3::new(0.9, 0.63, 0.8)] {
        let mesh = ball::layered(4, 0.2).unwrap();
        let placed: Vec<Vec3> = mesh.positions().iter().map(|p| *p + at).collect();
        let mesh = vivace_mesh::TetMesh::new(placed, mesh.tets().to_vec()).unwrap();
        let first = builder.volume(&mesh, 500.0).unwrap();
        builder.springs(first, &mesh.edges(), 500.0).unwrap();
    }
    let scene = builder.build().unwrap();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
    pool.install(|| {
        let mut system = system(&scene, solver, options(0.3), &[floor(-0.3, 0.5)]);
        let mut state = scene.1.clone();
        state.velocities[1600..].fill(Vec3::new(0.0, -3.0, 0.0));
        let mut reports = Vec::new();
        for _ in 0..5 {
            reports.push(
                system.step(&mut state, &Forces::default(), H, Budget::iterations(7)).unwrap().contacts,
            );
        }
        (state, reports)
    })
}

#[test]
fn threads_do_not_show_in_contacts() {
    for framework in frameworks() {
        for relaxation in [
            Relaxation::default(),
            Relaxation::GaussSeidel { omega: 1.2, base: Base::PreviousInPlace },
            Relaxation::Jacobi { omega: 2.0 / 3.0 },
        ] {
            let solver = Solver { framework, relaxation, substeps: 2, ..Solver::default() };
            let one = on_threads(solver, 1);
            assert!(one.1.iter().any(|report| report.contacts > 20), "{:?}", one.1.last());
            for n_threads in [2, 7] {
                assert!(on_threads(solver, n_threads) == one, "{solver:?} on {n_threads}");
            }
        }
    }
}

/// A cloth far above the floor falls as one without collisions.
pub(crate) fn is_as_without_collisions(make: Make, solver: Solver) {
    let scene = cloths(9, &[Pose::IDENTITY]);
    let mut colliding = colliding(make, &scene, solver, options(0.3), &[floor(-100.0, 0.5)]);
    let mut alone = make(&scene, solver);
    let (mut a, mut b) = (scene.1.clone(), scene.1.clone());
    for _ in 0..5 {
        let with = colliding.step(&mut a, &Forces::default(), H, Budget::iterations(10)).unwrap();
        let without = alone.step(&mut b, &Forces::default(), H, Budget::iterations(10)).unwrap();
        assert_eq!((with.contacts.contacts, without.contacts), (0, ContactReport::default()));
        assert_eq!(a, b, "{solver:?}");
    }
}

#[test]
fn a_scene_without_contacts_is_as_it_was() {
    let solver = |framework| Solver { framework, ..Solver::default() };
    frameworks().into_iter().for_each(|framework| is_as_without_collisions(on_host, solver(framework)));
}

#[test]
fn an_obstacle_that_cannot_be_is_refused_and_changes_nothing() {
    let scene = cloths(4, &[Pose::IDENTITY]);
    let mut system = system(&scene, Solver::default(), options(0.0), &[]);
    system.collisions_mut().unwrap().obstacles_mut().push(sphere(-1.0, 0.0));
    let mut state = scene.1.clone();
    let error = system.step(&mut state, &Forces::default(), H, Budget::iterations(5)).unwrap_err();
    assert!(matches!(error, SolverError::Collision(_)), "{error}");
    assert_eq!(state, scene.1);
}
