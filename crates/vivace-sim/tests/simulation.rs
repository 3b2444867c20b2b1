//! The facade: what stays, what is refused, what resumes.

use vivace_sim::scene::{Attach, Select, beam, tablecloth};
use vivace_sim::{
    Budget, Ease, Framework, ModelError, Relaxation, Scene, SimError, Simulation, Snapshot, Solver, State,
    Stop, Vec3, Wind,
};

fn held() -> Scene {
    let mut scene = tablecloth(12);
    let select = Select::Vertices(vec![143, 132]);
    scene.bodies[0].attachments = vec![Attach { select, stiffness: 100.0, offset: Vec3::Y * 0.1 }];
    scene
}

fn bits(state: &State) -> Vec<u32> {
    let all = state.positions.iter().chain(&state.velocities);
    all.flat_map(|v| v.to_array().map(f32::to_bits)).collect()
}

#[test]
fn a_snapshot_resumes_bit_for_bit() {
    let pd = Solver::default();
    let xpbd = Solver { framework: Framework::PositionBased, ..pd };
    let small = Solver { substeps: 4, ..pd };
    for (scene, solver) in [(held(), pd), (held(), xpbd), (held(), small)] {
        let budget = Budget::iterations(12);
        let mut whole = Simulation::new(&scene, solver).unwrap();
        whole.forces_mut().wind = Some(Wind { velocity: Vec3::new(0.1, 0.0, 3.0), drag: 0.3 });
        whole.set_target(1, Vec3::new(0.3, 0.2, 0.1)).unwrap();
        let mut text = String::new();
        for frame in 0..10 {
            if frame == 5 {
                text = whole.snapshot().to_json().unwrap();
            }
            whole.step(budget).unwrap();
        }
        let mut resumed = Simulation::new(&scene, solver).unwrap();
        resumed.restore(&Snapshot::from_json(&text).unwrap()).unwrap();
        assert_eq!((resumed.frame(), resumed.forces()), (5, whole.forces()));
        for _ in 0..5 {
            resumed.step(budget).unwrap();
        }
        assert_eq!(bits(resumed.state()), bits(whole.state()));
        assert_eq!(resumed.snapshot(), whole.snapshot());
        // Backwards, too.
        whole.restore(&Snapshot::from_json(&text).unwrap()).unwrap();
        assert_ne!(bits(resumed.state()), bits(whole.state()));
    }
}

#[test]
fn every_kind_of_number_survives_json() {
    let mut word = 0x9e37_79b9_u32;
    let mut draw = || {
        word = word.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let number = f32::from_bits(word);
        if number.is_finite() { number } else { -0.0 }
    };
    let mut snapshot = Simulation::new(&held(), Solver::default()).unwrap().snapshot();
    snapshot.state = State::at_rest((0..100_000).map(|_| Vec3::new(draw(), draw(), draw())).collect());
    let back = Snapshot::from_json(&snapshot.to_json().unwrap()).unwrap();
    assert_eq!(bits(&back.state), bits(&snapshot.state));
}

#[test]
fn a_bad_state_names_its_particle_and_changes_nothing() {
    let mut simulation = Simulation::new(&held(), Solver::default()).unwrap();
    simulation.step(Budget::iterations(3)).unwrap();
    let before = simulation.snapshot();
    for bad in [f32::NAN, f32::INFINITY, 1e30] {
        let mut state = simulation.state().clone();
        state.velocities[17].y = bad;
        let error = simulation.set_state(state).unwrap_err();
        assert!(matches!(error, SimError::Model(ModelError::NotFinite { particle: 17, .. })), "{error}");
    }
    assert!(simulation.set_state(State::at_rest(vec![Vec3::ZERO])).is_err());
    assert!(simulation.set_target(2, Vec3::ZERO).is_err());
    assert!(simulation.set_target(0, Vec3::NAN).is_err());
    assert!(simulation.set_target(0, Vec3::splat(1e30)).is_err());
    assert!(simulation.set_time_step(0.0).is_err());
    assert!(simulation.step(Budget::default()).is_err());
    assert_eq!(simulation.snapshot(), before);
    simulation.forces_mut().damping = -1.0;
    assert!(simulation.step(Budget::iterations(1)).is_err());
    assert_eq!(simulation.state(), &before.state);
}

#[test]
fn a_snapshot_that_does_not_fit_changes_nothing() {
    let mut simulation = Simulation::new(&held(), Solver::default()).unwrap();
    let before = simulation.snapshot();
    type Change = fn(&mut Snapshot);
    let changes: [(Change, &str); 7] = [
        (|s| s.state = State::at_rest(vec![Vec3::ZERO]), "1 particles"),
        (|s| s.targets.truncate(1), "1 attachments"),
        (|s| s.targets[1] = Vec3::NAN, "target"),
        (|s| s.state.positions[3] = Vec3::NAN, "particle 3"),
        (|s| s.time_step = 0.0, "time step is 0"),
        (|s| s.time = f64::INFINITY, "time of the snapshot [s] is inf"),
        (|s| s.forces.gravity = Vec3::NAN, "gravity"),
    ];
    for (change, words) in changes {
        let mut snapshot = before.clone();
        snapshot.targets[0] = Vec3::ONE;
        change(&mut snapshot);
        let error = simulation.restore(&snapshot).unwrap_err().to_string();
        assert!(error.contains(words), "{words}: {error}");
        assert_eq!(simulation.snapshot(), before);
    }
    let error = Snapshot::from_json("{\n \"frame\": -1}").unwrap_err().to_string();
    assert!(error.starts_with("line 2, column 12"), "{error}");
}

#[test]
fn a_beam_of_tetrahedra_sinks_and_keeps_its_end() {
    let mut simulation = Simulation::new(&beam(), Solver::default()).unwrap();
    let before = simulation.positions().to_vec();
    for _ in 0..3 {
        simulation.step(Budget::iterations(10)).unwrap();
    }
    assert_eq!(simulation.positions()[0], before[0]);
    assert!(simulation.positions()[35].y < before[35].y - 1e-3);
    assert!((simulation.time() - 0.1).abs() < 1e-6);
}

#[test]
fn what_is_measured_is_reported_and_changes_nothing() {
    let budget = Budget::iterations(10);
    let sweeps = Solver { relaxation: Relaxation::Jacobi { omega: 0.5 }, ..Solver::default() };
    let xpbd = Solver { framework: Framework::PositionBased, ..sweeps };
    for solver in [sweeps, xpbd, Solver { substeps: 3, ..sweeps }, Solver::default()] {
        let mut plain = Simulation::new(&held(), solver).unwrap();
        let mut measured = Simulation::new(&held(), solver).unwrap();
        measured.set_measuring(true);
        for _ in 0..3 {
            let report = plain.step(budget).unwrap();
            let is_watched = solver == Solver::default();
            assert_eq!(
                (report.residual, report.last_move, report.objective.is_some()),
                (None, None, is_watched)
            );
            let report = measured.step(budget).unwrap();
            assert!(report.residual.unwrap() > 0.0 && report.objective.unwrap().is_finite(), "{report:?}");
        }
        assert_eq!(plain.snapshot(), measured.snapshot());
    }
}

#[test]
fn time_goes_on_when_the_time_step_changes() {
    let mut simulation = Simulation::new(&held(), Solver::default()).unwrap();
    simulation.step(Budget::iterations(1)).unwrap();
    simulation.set_time_step(0.01).unwrap();
    simulation.step(Budget::iterations(1)).unwrap();
    assert!((simulation.time() - 1.0 / 30.0 - 0.01).abs() < 1e-8, "{}", simulation.time());
    assert_eq!((simulation.frame(), simulation.time_step()), (2, 0.01));
    let text = simulation.snapshot().to_json().unwrap();
    let mut resumed = Simulation::new(&held(), Solver::default()).unwrap();
    resumed.restore(&Snapshot::from_json(&text).unwrap()).unwrap();
    assert_eq!(resumed.time().to_bits(), simulation.time().to_bits());
}

#[test]
fn a_body_has_its_particles_and_attachments() {
    let mut scene = held();
    scene.bodies.extend(held().bodies);
    scene.bodies[1].at = Vec3::X * 7.0;
    let simulation = Simulation::new(&scene, Solver::default()).unwrap();
    assert_eq!(simulation.particles_of(0), Some(0..144));
    let second = simulation.particles_of(1).unwrap();
    assert!(simulation.positions()[second.clone()].iter().all(|q| q.x >= 7.0));
    assert_eq!((second, simulation.particles_of(2)), (144..288, None));
    let attachments = |body| simulation.attachments_of(body).collect::<Vec<_>>();
    assert_eq!([attachments(0), attachments(1), attachments(2)], [vec![0, 1], vec![2, 3], vec![]]);
}

#[test]
fn bounds_combine() {
    let mut simulation = Simulation::new(&held(), Solver::default()).unwrap();
    let report = simulation.step(Budget::milliseconds(1e6).and_tolerance(1e9)).unwrap();
    assert_eq!((report.stop, report.iterations), (Stop::Tolerance, 1));
    let report = simulation.step(Budget::iterations(3).and_tolerance(0.0)).unwrap();
    assert_eq!((report.stop, report.iterations), (Stop::Iterations, 3));
}

#[test]
fn the_memory_of_the_safeguard_has_a_name() {
    let snapshot = Simulation::new(&held(), Solver::default()).unwrap().snapshot();
    assert_eq!(snapshot.ease, Ease::default());
}

/// A snapshot in the middle of a collision, through text, into another simulation: the same frames, bit for bit.
#[test]
fn a_snapshot_among_contacts_resumes_bit_for_bit() {
    let mut scene = vivace_sim::scene::drape(14);
    let mut above = scene.bodies[0].clone();
    above.at += Vec3::new(0.1, 0.06, 0.07);
    above.rotate = Vec3::new(0.0, 20.0, 0.0);
    above.velocity = Vec3::new(0.0, -3.0, 0.0);
    scene.bodies.push(above);
    let budget = Budget::iterations(6);
    let mut one = Simulation::new(&scene, Solver::default()).unwrap();
    let mut contacts = 0;
    for _ in 0..20 {
        contacts = one.step(budget).unwrap().contacts.contacts;
    }
    assert!(contacts > 100, "{contacts}");
    let text = one.snapshot().to_json().unwrap();
    let snapshot = vivace_sim::Snapshot::from_json(&text).unwrap();
    assert_eq!(snapshot, one.snapshot());
    let mut other = Simulation::new(&scene, Solver::default()).unwrap();
    other.restore(&snapshot).unwrap();
    for frame in 0..10 {
        assert_eq!(one.step(budget).unwrap().contacts, other.step(budget).unwrap().contacts, "frame {frame}");
        assert_eq!(one.state(), other.state(), "frame {frame}");
    }
}

/// An obstacle that moves takes along what lies on it.
#[test]
fn a_moving_obstacle_carries() {
    let mut scene = vivace_sim::scene::drape(10);
    let collisions = scene.collisions.as_mut().unwrap();
    collisions.obstacles[0].velocity = Vec3::new(0.0, 0.5, 0.0);
    for substeps in [1, 4] {
        let mut simulation = Simulation::new(&scene, Solver { substeps, ..Solver::default() }).unwrap();
        let mut report = simulation.step(Budget::iterations(20)).unwrap();
        for _ in 0..60 {
            report = simulation.step(Budget::iterations(20)).unwrap();
        }
        let top = simulation.positions().iter().map(|p| p.y).fold(f32::NEG_INFINITY, f32::max);
        assert!(report.contacts.contacts > 0 && (top - 1.108).abs() < 0.06, "{substeps}: {top} {report:?}");
    }
}
