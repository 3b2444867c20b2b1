//! Scenes that tear: reported, kept in snapshots, held by hand.

use vivace_sim::mesh::cloth;
use vivace_sim::scene::{Collisions, Material, flag};
use vivace_sim::{
    Budget, Forces, Framework, Hold, ModelBuilder, Scene, Simulation, Snapshot, Solver, Tear, TearLimit,
    TearReport, Vec3,
};

const BUDGET: Budget = Budget::iterations(20);

fn solvers() -> [Solver; 3] {
    let pd = Solver::default();
    [pd, Solver { framework: Framework::PositionBased, ..pd }, Solver { substeps: 2, ..pd }]
}

/// A small flag in a storm.
fn storm() -> Scene {
    let mut scene = flag(12);
    if let Some(wind) = &mut scene.forces.wind {
        wind.velocity *= 3.0;
    }
    let Material::Cloth { tear: Some(tear), .. } = &mut scene.bodies[0].material else { unreachable!() };
    tear.strain = 0.09;
    scene
}

#[test]
fn a_flag_tears_and_says_so() {
    let scene = storm();
    assert_eq!(Scene::from_ron(&scene.to_ron().unwrap()), Ok(scene.clone()));
    for solver in solvers() {
        let mut simulation = Simulation::new(&scene, solver).unwrap();
        let n = simulation.positions().len();
        let (mut copies, mut corners) = (0, 0);
        let mut surface = simulation.model().surface().to_vec();
        for _ in 0..40 {
            let report = simulation.step(BUDGET).unwrap();
            copies += report.tears.copies;
            corners += report.tears.triangles;
            // The events tell a renderer all it needs.
            if report.tears != TearReport::default() {
                let torn = simulation.tears().last().unwrap();
                assert_eq!(torn.frame, simulation.frame());
                for tear in &torn.tears {
                    let Tear::Split { particle, copy, triangles } = tear else { panic!("{tear:?}") };
                    for &triangle in triangles {
                        let corner = surface[triangle as usize].iter_mut().find(|corner| *corner == particle);
                        *corner.unwrap() = *copy;
                    }
                }
            }
            assert_eq!(surface, simulation.model().surface());
        }
        assert!(copies > 0 && corners >= copies, "{solver:?}");
        assert_eq!(simulation.positions().len(), n + copies);
        assert!(simulation.model().origin(u32::try_from(n).unwrap()) < u32::try_from(n).unwrap());
    }
}

#[test]
fn a_snapshot_of_a_torn_flag_resumes_bit_for_bit() {
    for solver in solvers() {
        for is_colliding in [false, true] {
            let mut scene = storm();
            scene.collisions = is_colliding.then(|| Collisions::new(0.02, Vec::new()));
            let new = || Simulation::new(&scene, solver).unwrap();
            let (mut whole, mut texts) = (new(), Vec::new());
            for frame in 0..30 {
                texts.push(whole.snapshot().to_json().unwrap());
                if frame == 12 {
                    whole.grab(&[60, 61, 62], Hold::Pin).unwrap();
                }
                whole.step(BUDGET).unwrap();
            }
            let is_torn = |text: &String| !Snapshot::from_json(text).unwrap().tears.is_empty();
            assert!(
                is_torn(&texts[20]) && !is_torn(&texts[2]),
                "{}",
                texts.iter().filter(|t| is_torn(t)).count()
            );
            let mut resumed = new();
            // Forwards, backwards, and to where nothing is torn.
            for from in [14, 24, 20, 2] {
                resumed.restore(&Snapshot::from_json(&texts[from]).unwrap()).unwrap();
                assert_eq!(resumed.snapshot().to_json().unwrap(), texts[from]);
                for frame in from..30 {
                    if frame == 12 {
                        resumed.grab(&[60, 61, 62], Hold::Pin).unwrap();
                    }
                    resumed.step(BUDGET).unwrap();
                }
                assert_eq!(resumed.snapshot(), whole.snapshot(), "from {from}, {solver:?}, {is_colliding}");
                assert_eq!(resumed.model(), whole.model());
            }
            // One with tears that cannot be is refused, and changes nothing.
            let mut bad = Snapshot::from_json(&texts[24]).unwrap();
            bad.tears[0].tears.push(Tear::Split { particle: 0, copy: 1, triangles: vec![0] });
            let before = (resumed.snapshot(), resumed.model().clone());
            assert!(resumed.restore(&bad).is_err());
            assert_eq!((resumed.snapshot(), resumed.model().clone()), before);
        }
    }
}

/// A pinned patch that is torn stays pinned, both sides of it, until it is let go.
#[test]
fn what_is_torn_in_a_hand_stays_there() {
    let mesh = cloth::regular(5, 3, 0.1).unwrap();
    let mut builder = ModelBuilder::new();
    builder.cloth(&mesh, 0.2).unwrap();
    builder.springs(0, &mesh.edges(), 100.0).unwrap();
    builder.let_tear(0..builder.n_springs(), &TearLimit::new(0.5)).unwrap();
    // Then it has to tear in the middle.
    [3, 8, 13].into_iter().for_each(|p| builder.pin(p).unwrap());
    let (model, mut state) = builder.build().unwrap();
    let start = state.positions.clone();
    let at_rest = Forces { gravity: Vec3::ZERO, ..Forces::default() };
    let mut simulation =
        Simulation::from_model(model, state.clone(), at_rest, 1.0 / 60.0, Solver::default()).unwrap();
    // The ends of the middle column; what is right of it goes away.
    let hand = simulation.grab(&[2, 12], Hold::Pin).unwrap();
    state.positions.iter_mut().filter(|q| q.x > 0.25).for_each(|q| q.x += 0.1);
    simulation.set_state(state).unwrap();
    let report = simulation.step(Budget::iterations(0)).unwrap();
    assert!(report.tears.copies > 0);
    let held = simulation.grabs()[0].particles().to_vec();
    assert_eq!((held.len(), &held[..2]), (4, &[2, 12][..]), "{:?}", simulation.tears());
    simulation.drag(hand, Vec3::Y * 0.01).unwrap();
    simulation.step(BUDGET).unwrap();
    for &particle in &held {
        let origin = simulation.model().origin(particle) as usize;
        assert!(simulation.model().is_pinned(particle) && [2, 12].contains(&origin));
        assert_eq!(simulation.positions()[particle as usize], start[origin] + Vec3::Y * 0.01);
    }
    simulation.release(hand).unwrap();
    let masses = simulation.model().masses();
    assert_eq!(masses.iter().filter(|mass| mass.is_infinite()).count(), 3);
    for origin in [2, 12] {
        let is_part = |p: &&u32| simulation.model().origin(**p) == origin;
        let mass: f32 = held.iter().filter(is_part).map(|&p| masses[p as usize]).sum();
        // Three triangles of 0.005 m², a third of each.
        assert!((mass - 0.2 * 0.005).abs() < 1e-8, "{mass} kg");
    }
    simulation.step(BUDGET).unwrap();
}
