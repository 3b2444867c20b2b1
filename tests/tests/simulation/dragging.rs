//! Particles that are held, led and let go while it runs: by springs of their own, and pinned.

use glam::{DVec3, Vec3};
use rayon::ThreadPoolBuilder;
use vivace_cpu::Cpu;
use vivace_model::{Forces, ModelError, State};
use vivace_solver::{Budget, Framework, PinMove, Relaxation, Solver, SolverError, System};
use vivace_tests::scenes::{
    STEP, Scene, cloth, free_cloth, gauss_seidel, plain, projective_dynamics, solvers,
};

use crate::{NO_FORCE, frames, moment, stall};

/// A patch of the cloth's free side.
const PATCH: [u32; 3] = [60, 61, 62];

fn small() -> Scene {
    cloth(8, 100.0, Some(1e-5))
}

fn step(system: &mut System, state: &mut State, iterations: u32) {
    system.step(state, &Forces::default(), STEP, Budget::iterations(iterations)).unwrap();
}

/// The patch held by springs, at `by` \[m\] from where it is.
fn springs(state: &State, by: Vec3, stiffness: f32) -> Vec<(u32, Vec3, f32)> {
    PATCH.iter().map(|&p| (p, state.positions[p as usize] + by, stiffness)).collect()
}

/// The patch pinned.
fn pin(system: &mut System) {
    let mut model = system.model().clone();
    PATCH.iter().for_each(|&p| model.pin(p).unwrap());
    system.set_model(model).unwrap();
}

fn unpin(system: &mut System) {
    let mut model = system.model().clone();
    PATCH.iter().for_each(|&p| model.unpin(p).unwrap());
    system.set_model(model).unwrap();
}

fn moves(state: &State, by: Vec3) -> Vec<PinMove> {
    let of = |&particle: &u32| {
        let from = state.positions[particle as usize];
        PinMove { particle, from, to: from + by }
    };
    PATCH.iter().map(of).collect()
}

/// In one frame the patch gets there but for what it weighs against the spring's stiffness.
#[test]
fn a_patch_reaches_its_target_as_stiffness_grows() {
    let by = Vec3::new(0.02, 0.03, -0.05);
    for solver in solvers() {
        let distance = |stiffness: f32| {
            let (model, mut state) = small();
            let mut system = System::new(model, solver).unwrap();
            // Taken and led in the middle of a run.
            step(&mut system, &mut state, 60);
            let held = springs(&state, Vec3::ZERO, stiffness);
            system.replace_attachments(0, &held).unwrap();
            for (attachment, &(_, target, _)) in held.iter().enumerate() {
                system.set_attachment_target(attachment, target + by).unwrap();
            }
            step(&mut system, &mut state, 60);
            let away = |&(p, target, _): &(u32, Vec3, f32)| state.positions[p as usize].distance(target + by);
            held.iter().map(away).fold(0.0, f32::max)
        };
        let distances = [1.0, 1e2, 1e4, 1e6].map(distance);
        // Position Based Dynamics gets as near as sixty iterations lead it, whatever the stiffness.
        let is_position_based = solver.framework == Framework::PositionBased;
        let slack = if is_position_based { 1.05 } else { 1.0 };
        assert!(distances.is_sorted_by(|a, b| slack * a > *b), "{solver:?}: {distances:?}");
        assert!(distances[2] < 0.25 * by.length(), "{solver:?}: {distances:?}");
        // Against 6 springs of 100 N/m, m/h² of 4 N/m and a hinge's 1 N/m.
        let is_there = distances[2] < 0.1 * by.length() && distances[3] < 1e-3 * by.length();
        assert!(is_position_based || is_there, "{solver:?}: {distances:?}");
    }
}

/// A pinned patch is where it is led, to the bit, and what hangs on it follows; so in small steps, and evenly over them.
#[test]
fn a_pinned_patch_is_where_it_is_led() {
    let by = Vec3::new(0.0, 0.02, -0.01);
    for solver in solvers() {
        for substeps in [1, 3] {
            let (model, mut state) = small();
            let mut system = System::new(model, Solver { substeps, ..solver }).unwrap();
            step(&mut system, &mut state, 6);
            pin(&mut system);
            for _ in 0..3 {
                let moves = moves(&state, by);
                system.move_pins(&moves).unwrap();
                step(&mut system, &mut state, 30);
                for PinMove { particle, to, .. } in moves {
                    assert_eq!(state.positions[particle as usize], to, "{solver:?}");
                    let v = state.velocities[particle as usize];
                    assert!(v.distance(by / STEP) < 1e-4, "{solver:?}: {v}");
                }
            }
            let still = state.clone();
            step(&mut system, &mut state, 30);
            for p in PATCH.map(|p| p as usize) {
                assert_eq!((state.positions[p], state.velocities[p]), (still.positions[p], Vec3::ZERO));
            }
        }
    }
}

/// Whoever was held and let go moves on, bit for bit, as if it had never been held.
#[test]
fn what_is_let_go_is_free() {
    for solver in solvers() {
        for is_pinned in [false, true] {
            let (model, mut state) = small();
            let mut system = System::new(model.clone(), solver).unwrap();
            step(&mut system, &mut state, 6);
            if is_pinned {
                pin(&mut system);
            } else {
                system.replace_attachments(0, &springs(&state, Vec3::Y * 0.1, 500.0)).unwrap();
            }
            (0..2).for_each(|_| step(&mut system, &mut state, 6));
            if is_pinned {
                unpin(&mut system);
            } else {
                system.replace_attachments(0, &[]).unwrap();
            }
            assert_eq!(*system.model(), model);
            let mut other = System::new(model, solver).unwrap();
            other.set_ease(system.ease());
            let mut free = state.clone();
            for _ in 0..3 {
                step(&mut system, &mut state, 6);
                step(&mut other, &mut free, 6);
            }
            assert_eq!(state, free, "{solver:?}, pinned: {is_pinned}");
        }
    }
}

/// Σ m v changes by h Σ k (target − q), and by nothing once it is let go.
#[test]
fn springs_of_a_grab_give_their_momentum() {
    let xpbd = Solver { framework: Framework::PositionBased, ..plain(gauss_seidel(1.0)) };
    for solver in [plain(Relaxation::Direct), plain(gauss_seidel(1.0)), xpbd] {
        let (model, mut state) = free_cloth(6, 100.0, None).build().unwrap();
        let mut system = System::new(model.clone(), solver).unwrap();
        let held = [
            (3, state.positions[3] + 0.05 * Vec3::Y, 30.0),
            (17, state.positions[17] - 0.02 * Vec3::X, 80.0),
        ];
        system.replace_attachments(0, &held).unwrap();
        let momentum = |state: &State| moment(&model, state.velocities.iter().map(|v| v.as_dvec3()));
        for frame in 0..4 {
            if frame == 2 {
                system.replace_attachments(0, &[]).unwrap();
            }
            let before = momentum(&state);
            system.step(&mut state, &NO_FORCE, STEP, Budget::iterations(1500)).unwrap();
            let pull = |&(p, target, k): &(u32, Vec3, f32)| {
                f64::from(k) * (target - state.positions[p as usize]).as_dvec3()
            };
            let expected: DVec3 =
                if frame < 2 { held.iter().map(pull).sum::<DVec3>() * f64::from(STEP) } else { DVec3::ZERO };
            let given = momentum(&state) - before;
            // Where sweeps stall: see there.
            let bound = moment(&model, std::iter::repeat(DVec3::X)).x * stall(&model, &state.positions)
                / f64::from(STEP);
            assert!(given.distance(expected) < bound, "{solver:?} {frame}: {given} {expected} ± {bound}");
        }
    }
}

#[test]
fn what_is_refused_changes_nothing() {
    let (model, state) = small();
    let mut system = System::new(model, Solver::default()).unwrap();
    system.replace_attachments(0, &springs(&state, Vec3::ZERO, 10.0)).unwrap();
    let before = system.model().clone();
    let bad =
        [(64, Vec3::ZERO, 1.0), (1, Vec3::NAN, 1.0), (1, Vec3::ZERO, 0.0), (1, Vec3::ZERO, f32::INFINITY)];
    for bad in bad {
        let error = system.replace_attachments(1, &[(2, Vec3::ZERO, 1.0), bad]).unwrap_err();
        assert!(matches!(error, SolverError::Model(_)), "{error}");
    }
    assert!(system.replace_attachments(4, &[]).is_err());
    let way = PinMove { particle: 1, from: Vec3::ZERO, to: Vec3::ONE };
    assert_eq!(system.move_pins(&[way]), Err(ModelError::NotPinned { particle: 1 }));
    assert!(system.move_pins(&[PinMove { particle: 99, ..way }]).is_err());
    assert!(system.move_pins(&[PinMove { particle: 0, to: Vec3::NAN, ..way }]).is_err());
    let mut model = system.model().clone();
    assert_eq!(model.pin(0), Err(ModelError::Pinned { particle: 0 }));
    assert_eq!(model.unpin(0), Err(ModelError::NotPinned { particle: 0 }));
    assert!(model.pin(64).is_err());
    assert_eq!((system.model(), &model), (&before, &before));
}

/// A patch on springs and one that is pinned, both led.
fn led(solver: Solver, n_threads: usize) -> State {
    let pool = ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
    pool.install(|| {
        let (model, mut state) = cloth(70, 100.0, Some(1e-5));
        let mut system = System::new(model, solver).unwrap();
        pin(&mut system);
        let held: Vec<_> = (2000..2300).map(|p| (p, state.positions[p as usize], 200.0)).collect();
        system.replace_attachments(0, &held).unwrap();
        for _ in 0..2 {
            system.move_pins(&moves(&state, Vec3::Y * 0.01)).unwrap();
            for (attachment, &(_, target, _)) in held.iter().enumerate() {
                system.set_attachment_target(attachment, target + Vec3::Z * 0.1).unwrap();
            }
            step(&mut system, &mut state, 6);
        }
        state
    })
}

#[test]
fn what_is_led_is_the_same_on_any_number_of_threads() {
    let frameworks = projective_dynamics().into_iter().chain([Framework::PositionBased]);
    for framework in frameworks {
        for relaxation in [gauss_seidel(1.5), Relaxation::Jacobi { omega: 2.0 / 3.0 }] {
            let solver = Solver { framework, safeguard: true, ..plain(relaxation) };
            let one = led(solver, 1);
            for n_threads in [2, 7] {
                assert_eq!(one, led(solver, n_threads), "{solver:?}");
            }
        }
    }
}

/// The kernels do as the engine of the host does.
#[test]
fn a_device_leads_as_the_host_does() {
    for framework in projective_dynamics().into_iter().chain([Framework::PositionBased]) {
        for relaxation in [gauss_seidel(1.0), Relaxation::Jacobi { omega: 2.0 / 3.0 }] {
            let solver = Solver { framework, substeps: 2, ..plain(relaxation) };
            let play = |mut system: System, mut state: State| {
                step(&mut system, &mut state, 10);
                pin(&mut system);
                system.replace_attachments(0, &[(20, state.positions[20] + Vec3::Y * 0.1, 300.0)]).unwrap();
                for _ in 0..3 {
                    system.move_pins(&moves(&state, Vec3::Y * 0.01)).unwrap();
                    step(&mut system, &mut state, 10);
                }
                unpin(&mut system);
                system.replace_attachments(0, &[]).unwrap();
                step(&mut system, &mut state, 10);
                state
            };
            let (model, state) = small();
            let on_host = play(System::new(model.clone(), solver).unwrap(), state.clone());
            let on_device = play(System::on(model, solver, Cpu::new()).unwrap(), state);
            let apart = crate::distance(&on_host.positions, &on_device.positions);
            assert!(apart < 2e-4, "{solver:?}: {apart} m");
            let free = frames(&small(), solver, &Forces::default(), 10, 5);
            assert!(crate::distance(&on_host.positions, &free.positions) > 0.01, "nothing was led");
        }
    }
}
