//! What scenes become, and which values are refused.

use glam::Vec3;
use vivace_model::{Forces, Model, State};
use vivace_scene::{
    Attach, Bending, Body, Material, Obstacle, Pattern, Scene, SceneError, Select, Shape, Solid, Source,
    VolumeStiffness, armadillo, beam, curtain, heap, noodles, stack, tablecloth,
};

fn build(scene: &Scene) -> Result<(Model, State), SceneError> {
    scene.build(".".as_ref())
}

fn pinned(model: &Model) -> Vec<u32> {
    (0..).take(model.n_particles()).filter(|&p| model.is_pinned(p)).collect()
}

fn square() -> Body {
    let shape = Shape::Cloth { width: 3, height: 3, spacing: 0.5, pattern: Pattern::Regular };
    Body::new(shape, Material::cloth())
}

fn with(change: impl FnOnce(&mut Body)) -> Scene {
    let mut body = square();
    change(&mut body);
    Scene { bodies: vec![body], ..Scene::default() }
}

#[test]
fn the_tablecloth_has_the_wanted_size() {
    let (model, state) = build(&tablecloth(100)).unwrap();
    let c = model.constraints();
    assert_eq!((model.n_particles(), c.springs.len(), c.bending.len()), (10_000, 29_601, 29_205));
    assert_eq!(pinned(&model), [0, 99]);
    assert!((state.positions[9_999] - Vec3::new(0.99, 0.0, 0.99)).length() < 1e-6);
    let mass: f32 = model.masses().iter().filter(|m| m.is_finite()).sum();
    assert!((mass - 0.2 * 0.99 * 0.99).abs() < 1e-4, "{mass}");
}

#[test]
fn the_beam_is_held_at_one_end() {
    let (model, state) = build(&beam()).unwrap();
    assert_eq!((model.n_particles(), model.constraints().tet_strain.len()), (36 * 17 * 17, 35 * 16 * 16 * 6));
    assert_eq!(pinned(&model).len(), 17 * 17);
    assert!(pinned(&model).iter().all(|&p| state.positions[p as usize].x == 0.0));
}

#[test]
fn the_armadillo_hangs_by_one_hand() {
    let (model, state) = build(&armadillo(10_000)).unwrap();
    let n_tets = model.constraints().tet_strain.len();
    assert!((9_000..11_000).contains(&model.n_particles()), "{}", model.n_particles());
    assert!((48_000..62_000).contains(&n_tets), "{n_tets}");
    assert_eq!(model.constraints().tet_volume.len(), n_tets);
    let pinned = pinned(&model);
    assert!((10..300).contains(&pinned.len()), "{}", pinned.len());
    assert!(pinned.iter().all(|&p| state.positions[p as usize].x > 0.2));
    for n in [100, 600, 1500] {
        assert!(build(&armadillo(n)).is_ok(), "{n}");
    }
}

#[test]
fn the_curtain_hangs_from_its_rod() {
    let (model, state) = build(&curtain()).unwrap();
    assert_eq!(pinned(&model).len(), 49);
    let low = state.positions.iter().map(|p| p.y).fold(f32::INFINITY, f32::min);
    assert!((low - 1.2).abs() < 1e-5 && state.positions.iter().all(|p| p.z.abs() < 1e-6));
}

#[test]
fn noodles_and_heap_have_the_sizes_of_the_paper() {
    let sizes = |scene: &Scene| {
        let (model, _) = build(scene).unwrap();
        let c = model.constraints();
        (model.n_particles(), model.surface().len(), c.springs.len(), c.bending.len())
    };
    assert_eq!(sizes(&noodles(8)), (30_080, 52_080, 82_120, 74_120));
    assert_eq!(sizes(&heap(78)), (55_458, 108_108, 163_557, 160_767));
    assert_eq!(sizes(&noodles(2)).0, 40 * 2 * 14);
    assert_eq!(sizes(&heap(5)).0, 9 * 5 * 6);
    // Cloths that are smaller in number are as large in metres.
    let width = |scene: &Scene| {
        let (_, state) = build(scene).unwrap();
        let x = |f: fn(f32, f32) -> f32| state.positions.iter().map(|p| p.x).reduce(f).unwrap();
        x(f32::max) - x(f32::min)
    };
    assert!((width(&heap(10)) / width(&heap(40)) - 1.0).abs() < 0.15);
}

#[test]
fn the_stack_stands_on_the_floor() {
    let (model, state) = build(&stack(4)).unwrap();
    assert_eq!(model.bodies().len(), 7);
    assert_eq!(model.constraints().tet_strain.particles[..6 * 6 * 64].len(), 6 * 6 * 64);
    let low = state.positions.iter().map(|p| p.y).fold(f32::INFINITY, f32::min);
    assert!((low - 0.012).abs() < 1e-6, "{low}");
}

#[test]
fn obstacles_have_surfaces() {
    let surface = |solid| Obstacle::new(solid).surface(".".as_ref(), 3.0).unwrap();
    let volume = |solid| surface(solid).signed_volume();
    assert!((volume(Solid::Sphere { radius: 0.5 }) - std::f64::consts::FRAC_PI_6).abs() < 0.005);
    assert!((volume(Solid::Capsule { half_length: 1.0, radius: 0.5 }) - 2.0944).abs() < 0.02);
    assert!((volume(Solid::Box { half_extent: Vec3::new(1.0, 0.5, 0.25) }) - 1.0).abs() < 1e-6);
    let source = Source::Text("box 1 0 0 0.5 0.5 0.5 0.1".to_owned());
    let cube = surface(Solid::Sdf { source, spacing: 0.05 });
    cube.check_volume_boundary().unwrap();
    assert!((cube.signed_volume() - 0.97).abs() < 0.02, "{}", cube.signed_volume());
    let floor = surface(Solid::Plane);
    assert_eq!((floor.triangles().len(), floor.positions()[0]), (2, Vec3::new(-3.0, 0.0, -3.0)));
    let no_file = Solid::Sdf { source: Source::Path("gone.txt".into()), spacing: 0.05 };
    assert!(Obstacle::new(no_file).surface(".".as_ref(), 1.0).is_err());
    let armchair = surface(Solid::Sdf { source: Source::Armchair, spacing: 0.04 });
    let high = armchair.positions().iter().map(|p| p.y).fold(0.0, f32::max);
    assert!((high - 1.09).abs() < 0.01, "{high}");
}

#[test]
fn bodies_are_scaled_then_turned_then_moved() {
    let scene = with(|body| {
        (body.scale, body.rotate, body.at) = (2.0, Vec3::new(0.0, 90.0, 90.0), Vec3::new(10.0, 0.0, 0.0));
    });
    let (_, state) = build(&scene).unwrap();
    // x = 1 becomes 2, goes to −z about y, stays there about z; z = 1 becomes 2, goes to x about y, to y about z.
    assert!((state.positions[2] - Vec3::new(10.0, 0.0, -2.0)).length() < 1e-5, "{}", state.positions[2]);
    assert!((state.positions[6] - Vec3::new(10.0, 2.0, 0.0)).length() < 1e-5, "{}", state.positions[6]);
}

#[test]
fn pins_attachments_and_velocities_reach_the_right_particles() {
    let mut scene = with(|body| body.pins = vec![Select::Vertices(vec![8, 0])]);
    let held = Attach {
        select: Select::Box { min: Vec3::splat(-0.1), max: Vec3::new(0.1, 0.1, 2.0) },
        stiffness: 50.0,
        offset: Vec3::Y,
    };
    let pins = vec![Select::Nearest(Vec3::new(0.9, 0.0, 0.1))];
    let (at, velocity) = (Vec3::new(5.0, 0.0, 0.0), Vec3::new(0.0, 0.0, 3.0));
    scene.bodies.push(Body { at, velocity, pins, attachments: vec![held], ..square() });
    let (model, state) = build(&scene).unwrap();
    assert_eq!(pinned(&model), [0, 8, 9 + 2]);
    let attachments = &model.constraints().attachments;
    assert_eq!(attachments.particles, [[9], [12], [15]]);
    assert_eq!(attachments.rest[1].target, Vec3::new(5.0, 1.0, 0.5));
    assert_eq!((state.velocities[8], state.velocities[9]), (Vec3::ZERO, velocity));
    assert_eq!(state.velocities[11], Vec3::ZERO);
}

#[test]
fn what_cannot_be_is_refused_by_name() {
    let nan = f32::NAN;
    let box_of = |min: f32, max: f32| Select::Box { min: Vec3::splat(min), max: Vec3::splat(max) };
    let held = |select, stiffness| Attach { select, stiffness, offset: Vec3::ZERO };
    let volume = |density, strain, volume| Material::Volume { density, strain, volume, springs: None };
    let cloth =
        |density, springs, bending| Material::Cloth { density, springs, bending, strain: None, tear: None };
    let ball = |body: &mut Body, material| {
        (body.shape, body.material) = (Shape::Ball { n: 2, radius: 1.0 }, material);
    };
    let zero_volume = VolumeStiffness { stiffness: 1.0, range: [0.0, 1.0] };
    let cases: Vec<(Scene, &str)> = vec![
        (Scene::default(), "no bodies"),
        (Scene { time_step: 0.0, ..tablecloth(3) }, "time step"),
        (Scene { time_step: nan, ..tablecloth(3) }, "time step"),
        (Scene { forces: Forces { gravity: Vec3::NAN, ..Forces::default() }, ..tablecloth(3) }, "gravity"),
        (Scene { forces: Forces { damping: -1.0, ..Forces::default() }, ..tablecloth(3) }, "damping"),
        (tablecloth(0), "body 0 (Cloth): the number of vertices"),
        (tablecloth(1), "body 0 (Cloth): the number of vertices"),
        (with(|b| b.scale = 0.0), "scale is 0"),
        (with(|b| b.scale = f32::INFINITY), "scale is inf"),
        (with(|b| b.at.y = nan), "at is NaN"),
        (with(|b| b.rotate.z = f32::INFINITY), "rotate is inf"),
        (with(|b| b.velocity.x = nan), "velocity is NaN"),
        (with(|b| b.material = cloth(0.0, None, None)), "density of a cloth"),
        (with(|b| b.material = cloth(0.1, Some(-1.0), None)), "stiffness of a spring"),
        (
            with(|b| b.material = cloth(0.1, None, Some(Bending { stiffness: nan, curved: false }))),
            "stiffness of a hinge",
        ),
        (with(|b| b.material = Material::volume()), "give it `material: Cloth()`"),
        (with(|b| ball(b, Material::cloth())), "give it `material: Volume()`"),
        (with(|b| ball(b, volume(-1.0, None, None))), "density of a volume"),
        (with(|b| ball(b, volume(1.0, Some(0.0), None))), "stiffness of a tetrahedron"),
        (with(|b| ball(b, volume(1.0, None, Some(zero_volume)))), "least volume"),
        (with(|b| b.pins = vec![Select::Vertices(vec![9])]), "pins[0]: there is no vertex 9"),
        (with(|b| b.pins = vec![Select::Nearest(Vec3::NAN)]), "pins[0]: the point"),
        (with(|b| b.pins = vec![box_of(0.0, 1.0), box_of(1.0, 0.0)]), "pins[1]: a box"),
        (with(|b| b.pins = vec![box_of(5.0, 6.0)]), "pins[0] selects no particle"),
        (with(|b| b.attachments = vec![held(box_of(0.0, 1.0), 0.0)]), "stiffness of an attachment"),
        (with(|b| b.attachments = vec![held(Select::Vertices(vec![]), 1.0)]), "attachments[0] selects no"),
    ];
    for (scene, words) in cases {
        let error = build(&scene).expect_err(words).to_string();
        assert!(error.contains(words), "{words}: {error}");
    }
}
