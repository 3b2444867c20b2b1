//! Taking hold, leading, letting go: by hand and by the scene.

use vivace_sim::scene::{Between, Drag, Key, Path, Select, tablecloth};
use vivace_sim::{
    Budget, Framework, Hold, ModelError, Pose, Scene, SimError, Simulation, Snapshot, Solver, Vec3,
    glam::Quat,
};

const BUDGET: Budget = Budget::iterations(12);

fn solvers() -> [Solver; 3] {
    let pd = Solver::default();
    [pd, Solver { framework: Framework::PositionBased, ..pd }, Solver { substeps: 3, ..pd }]
}

/// A cloth whose free side is dragged by the scene: one corner pinned, from the start until 0.2 s, the other on springs, from 0.1 s.
fn dragged() -> Scene {
    let mut scene = tablecloth(12);
    let key = |time: f64, at: Vec3, degrees: f32| Key { time, at, rotate: Vec3::Y * degrees };
    let keys = vec![key(0.0, Vec3::ZERO, 0.0), key(0.1, Vec3::Y * 0.1, 30.0), key(0.3, Vec3::Z * -0.1, 30.0)];
    scene.bodies[0].drags = vec![
        Drag {
            select: Select::Vertices(vec![132, 133, 121]),
            hold: Hold::Pin,
            path: Path { keys, between: Between::Smooth },
            release: Some(0.2),
        },
        Drag {
            select: Select::Vertices(vec![143]),
            hold: Hold::Spring(500.0),
            path: Path::through(vec![key(0.1, Vec3::ZERO, 0.0), key(0.2, Vec3::X * 0.2, 0.0)]),
            release: None,
        },
    ];
    scene
}

#[test]
fn a_scene_drags_and_lets_go() {
    let scene = dragged();
    let text = scene.to_ron().unwrap();
    assert_eq!(Scene::from_ron(&text), Ok(scene.clone()));
    let path = &scene.bodies[0].drags[0].path;
    for solver in solvers() {
        let mut simulation = Simulation::new(&scene, solver).unwrap();
        let start = simulation.positions().to_vec();
        let middle =
            [132, 133, 121].map(|p| start[p].as_dvec3()).iter().sum::<vivace_sim::glam::DVec3>() / 3.0;
        let mut held = Vec::new();
        for _ in 0..8 {
            simulation.step(BUDGET).unwrap();
            held.push(simulation.grabs().iter().map(|patch| patch.particles().len()).collect::<Vec<_>>());
            if simulation.time() < 0.21 && held.len() < 6 {
                for p in [132, 133, 121] {
                    let expected = path.pose(simulation.time()).apply(middle.as_vec3(), start[p]);
                    assert_eq!(simulation.positions()[p], expected, "frame {}", simulation.frame());
                }
            }
        }
        // 0.1 s lies in the third frame, 0.2 s in the sixth, by roundings of 1/30.
        assert_eq!(held[..2], [vec![3], vec![3]]);
        assert_eq!(held[3..5], [vec![3, 1], vec![3, 1]]);
        assert_eq!(held[6..], [vec![1], vec![1]]);
        assert!(!simulation.model().is_pinned(132));
        let pulled = simulation.positions()[143] - start[143];
        assert!(pulled.x > 0.1, "{pulled} by {solver:?}");
    }
}

#[test]
fn a_snapshot_resumes_bit_for_bit_with_grabs_in_place() {
    for solver in solvers() {
        let new = || Simulation::new(&dragged(), solver).unwrap();
        let mut whole = new();
        let mut texts = Vec::new();
        let mut hand = None;
        for frame in 0..10 {
            texts.push(whole.snapshot().to_json().unwrap());
            match frame {
                2 => hand = Some(whole.grab(&[60, 61], Hold::Pin).unwrap()),
                4 => _ = whole.grab(&[70], Hold::Spring(50.0)).unwrap(),
                8 => whole.release(hand.unwrap()).unwrap(),
                _ => {}
            }
            if (3..8).contains(&frame) {
                let rotation = Quat::from_rotation_z(0.1);
                whole.move_grab(hand.unwrap(), Pose { at: Vec3::Y * 0.01 * frame as f32, rotation }).unwrap();
            }
            whole.step(BUDGET).unwrap();
        }
        for from in [3_u64, 5, 7, 9] {
            let mut resumed = new();
            resumed.step(BUDGET).unwrap();
            resumed.restore(&Snapshot::from_json(&texts[usize::try_from(from).unwrap()]).unwrap()).unwrap();
            for frame in from..10 {
                if frame == 4 {
                    resumed.grab(&[70], Hold::Spring(50.0)).unwrap();
                }
                if frame == 8 {
                    resumed.release(hand.unwrap()).unwrap();
                }
                if (3..8).contains(&frame) {
                    let rotation = Quat::from_rotation_z(0.1);
                    resumed
                        .move_grab(hand.unwrap(), Pose { at: Vec3::Y * 0.01 * frame as f32, rotation })
                        .unwrap();
                }
                resumed.step(BUDGET).unwrap();
            }
            assert_eq!(resumed.snapshot(), whole.snapshot(), "from {from}, {solver:?}");
        }
    }
}

/// By springs and pinned, also after a snapshot went through the simulation: then as if nothing had been held.
#[test]
fn what_is_let_go_is_free() {
    for solver in solvers() {
        for hold in [Hold::Pin, Hold::Spring(300.0)] {
            let mut simulation = Simulation::new(&tablecloth(12), solver).unwrap();
            let hand = simulation.grab(&[100, 101], hold).unwrap();
            for frame in 0..4 {
                simulation.drag(hand, Vec3::Y * 0.02 * frame as f32).unwrap();
                simulation.step(BUDGET).unwrap();
            }
            simulation.release(hand).unwrap();
            let mut free = Simulation::new(&tablecloth(12), solver).unwrap();
            free.restore(&simulation.snapshot()).unwrap();
            for _ in 0..4 {
                simulation.step(BUDGET).unwrap();
                free.step(BUDGET).unwrap();
            }
            assert_eq!(simulation.state(), free.state());
        }
    }
}

#[test]
fn what_is_refused_changes_nothing() {
    let mut simulation = Simulation::new(&tablecloth(12), Solver::default()).unwrap();
    let hand = simulation.grab(&[5], Hold::Spring(10.0)).unwrap();
    let pinned = simulation.grab(&[7], Hold::Pin).unwrap();
    simulation.step(BUDGET).unwrap();
    let before = simulation.snapshot();
    let spring = Hold::Spring(1.0);
    assert!(matches!(simulation.grab(&[], spring), Err(SimError::Nothing)));
    let model = |error| match error {
        SimError::Model(error) => error,
        error => panic!("{error}"),
    };
    assert!(matches!(
        model(simulation.grab(&[144], spring).unwrap_err()),
        ModelError::Index { particle: 144, .. }
    ));
    assert!(matches!(model(simulation.grab(&[9, 8, 9], spring).unwrap_err()), ModelError::Degenerate { .. }));
    for particle in [0, 7] {
        assert_eq!(
            model(simulation.grab(&[9, particle], Hold::Pin).unwrap_err()),
            ModelError::Pinned { particle }
        );
    }
    for stiffness in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        assert!(matches!(
            model(simulation.grab(&[9], Hold::Spring(stiffness)).unwrap_err()),
            ModelError::Value { .. }
        ));
    }
    assert!(matches!(
        model(simulation.drag(hand, Vec3::NAN).unwrap_err()),
        ModelError::NotFinite { particle: 5, .. }
    ));
    assert!(simulation.drag(pinned, Vec3::splat(1e30)).is_err());
    assert!(
        simulation
            .move_grab(hand, Pose { rotation: Quat::from_xyzw(0.0, 0.0, 0.0, 2.0), ..Pose::IDENTITY })
            .is_err()
    );
    assert_eq!(simulation.snapshot(), before);
    // The numbers of attachments are the model's own.
    assert!(simulation.set_target(0, Vec3::ZERO).is_err());
    simulation.release(hand).unwrap();
    assert!(matches!(simulation.release(hand), Err(SimError::NoGrab { grab: 0 })));
    assert!(matches!(simulation.drag(hand, Vec3::ZERO), Err(SimError::NoGrab { grab: 0 })));

    // A snapshot with grabs that cannot be.
    let whole = simulation.snapshot();
    let mut other = Simulation::new(&tablecloth(12), Solver::default()).unwrap();
    let own = other.snapshot();
    let text = whole.to_json().unwrap();
    for (from, to) in [
        ("\"particles\":[7]", "\"particles\":[144]"),
        ("\"particles\":[7]", "\"particles\":[0]"),
        ("\"drag\":null", "\"drag\":0"),
    ] {
        assert!(text.contains(from), "{text}");
        assert!(other.restore(&Snapshot::from_json(&text.replace(from, to)).unwrap()).is_err(), "{to}");
        assert_eq!(other.snapshot(), own);
    }
}

/// A step that fails in the frame in which the scene takes hold, or lets go, undoes that, too.
#[test]
fn a_step_that_fails_holds_what_was_held() {
    let mut simulation = Simulation::new(&dragged(), Solver::default()).unwrap();
    for _ in 0..8 {
        let before = (simulation.snapshot(), simulation.model().clone());
        assert!(simulation.step(Budget::default()).is_err());
        assert_eq!((simulation.snapshot(), simulation.model().clone()), before);
        simulation.step(BUDGET).unwrap();
    }
}
