//! What is taken to its end: positions stay finite, or the step is refused with the particle's number and the state is as it was.

use glam::{DVec3, Vec3};
use vivace_model::{Forces, ModelError, State};
use vivace_solver::{Budget, Framework, Relaxation, Solver, SolverError, System};
use vivace_tests::random::Random;
use vivace_tests::scenes::{Bodies, Held, Kind, STEP, Scene, jitter, plain, projective_dynamics, solvers};

/// A scene, and how it is stepped.
struct Case {
    what: String,
    scene: Scene,
    h: f32,
    iterations: u32,
}

fn small() -> impl Iterator<Item = Bodies> {
    Kind::alone_and_together().map(|bodies| Bodies { cloth: 3, bar: [2, 1, 1], ..bodies })
}

/// Bodies a little out of shape, or where `change` puts each free particle by its number and place.
fn case(bodies: &Bodies, what: &str, change: impl Fn(usize, Vec3) -> Vec3) -> Case {
    let (model, mut state) = bodies.build();
    jitter(&model, &mut state, 1e-3, 7);
    for (particle, q) in (0..).zip(&mut state.positions) {
        if !model.is_pinned(particle) {
            *q = change(particle as usize, *q);
        }
    }
    Case { what: format!("{:?}: {what}", bodies.kinds), scene: (model, state), h: STEP, iterations: 8 }
}

/// Every extreme that is one of the scene, for `bodies`.
fn cases(bodies: &Bodies) -> Vec<Case> {
    let plain = |bodies: &Bodies, what: &str| case(bodies, what, |_, q| q);
    let steps = [1e-5, 1e-3, 0.1, 1.0].map(|h| Case { h, ..plain(bodies, &format!("h = {h}")) });
    let iterations = [0, 1].map(|n| Case { iterations: n, ..plain(bodies, &format!("{n} iterations")) });
    let shares = [1e-6, 1e-3, 1e3, 1e6];
    let stiff = shares
        .map(|stiffer| plain(&Bodies { stiffer, ..bodies.clone() }, &format!("{stiffer} times as stiff")));
    let heavy = shares.map(|heavier| {
        plain(&Bodies { heavier, ..bodies.clone() }, &format!("a corner {heavier} times as heavy"))
    });
    let held = [Held::All, Held::Nothing]
        .map(|held| plain(&Bodies { held, ..bodies.clone() }, &format!("held: {held:?}")));
    let sliver = plain(&Bodies { scale: Vec3::new(1.0, 1.0, 1e-3), ..bodies.clone() }, SLIVERS);
    let mut random = Random::new(5);
    let mut coordinate = || f32::from(u16::try_from(random.below(1 << 16)).unwrap()) / 65536.0;
    let anywhere: Vec<Vec3> = (0..64).map(|_| Vec3::new(coordinate(), coordinate(), coordinate())).collect();
    let starts = [
        case(bodies, "flat", |_, q| q.with_y(0.0)),
        case(bodies, "inverted", |_, q| -q),
        case(bodies, "in one point", |_, _| Vec3::splat(0.2)),
        case(bodies, "scrambled", |particle, _| anywhere[particle]),
    ];
    let mut far_out = plain(bodies, "far out");
    far_out.scene.1.positions.iter_mut().for_each(|q| q.x += 1e6);
    let rest = steps.into_iter().chain(iterations).chain(stiff).chain(heavy).chain(held);
    rest.chain([sliver, far_out]).chain(starts).collect()
}

const SLIVERS: &str = "slivers";

fn bits(state: &State) -> Vec<u32> {
    let all = state.positions.iter().chain(&state.velocities);
    all.flat_map(Vec3::to_array).map(f32::to_bits).collect()
}

/// The largest distance from where the middle of `case` begins \[m\].
fn reach<'a>(case: &Case, positions: impl Iterator<Item = &'a Vec3>) -> f32 {
    let start = &case.scene.1.positions;
    let middle = start.iter().map(|q| q.as_dvec3()).sum::<DVec3>() / start.len() as f64;
    positions.map(|q| q.distance(middle.as_vec3())).fold(0.0, f32::max)
}

/// Frames until one is refused. Returns how far particles reach \[m\], if none is.
fn assert_finite_or_refused(case: &Case, solver: Solver, n_frames: u32) -> Option<f32> {
    let (model, mut state) = case.scene.clone();
    let mut system = System::new(model, solver).unwrap();
    let mut farthest = 0.0_f32;
    for _ in 0..n_frames {
        let before = bits(&state);
        let budget = Budget::iterations(case.iterations);
        let result = system.step(&mut state, &Forces::default(), case.h, budget);
        let what = || format!("{} {solver:?} {result:?}", case.what);
        match &result {
            Ok(report) => {
                assert_eq!(report.iterations, case.iterations, "{}", what());
                let all = || state.positions.iter().chain(&state.velocities);
                assert!(all().all(|v| v.is_finite()), "{}", what());
                farthest = farthest.max(reach(case, state.positions.iter()));
            }
            Err(error) => {
                assert_eq!(before, bits(&state), "{}", what());
                match error {
                    SolverError::Diverged { particle }
                    | SolverError::Model(ModelError::NotFinite { particle, .. }) => {
                        assert!(error.to_string().contains(&format!("particle {particle}")), "{error}");
                        let particle = u32::try_from(*particle).unwrap();
                        assert!(!system.model().is_pinned(particle), "{}", what());
                    }
                    SolverError::Factor { .. } if solver.relaxation == Relaxation::Direct => (),
                    _ => panic!("{}", what()),
                }
                return None;
            }
        }
    }
    Some(farthest)
}

/// What blows up grows by a factor in each frame. What does not reaches no farther \[m\] than falling takes it, ½ g t², and its own size
/// a few times over, since bad starts fly apart: ten times is more than all, and less than any that blew up.
fn bound(case: &Case, n_frames: u32) -> f32 {
    let targets = case.scene.0.constraints().attachments.rest.iter().map(|held| &held.target);
    let start = reach(case, case.scene.1.positions.iter().chain(targets));
    10.0 * start + 10.0 * (case.h * n_frames as f32).powi(2)
}

/// Every combination, with and without the safeguard.
fn all_solvers() -> impl Iterator<Item = Solver> {
    solvers().into_iter().flat_map(|solver| [solver, Solver { safeguard: true, ..solver }])
}

fn is_sliver(case: &Case) -> bool {
    case.what.ends_with(SLIVERS)
}

#[test]
fn every_extreme_stays_finite_or_is_refused() {
    const N_FRAMES: u32 = 5;
    for case in small().flat_map(|bodies| cases(&bodies)) {
        for solver in all_solvers() {
            let far = assert_finite_or_refused(&case, solver, N_FRAMES).unwrap_or(f32::INFINITY);
            let is_bounded =
                solver.safeguard && !(is_sliver(&case) && solver.relaxation == Relaxation::Direct);
            let bound = bound(&case, N_FRAMES);
            assert!(!is_bounded || far <= bound, "{} {solver:?}: {far} m > {bound} m", case.what);
        }
    }
}

/// Y has entries that are 10⁶ times others, and more.
#[test]
fn the_direct_solver_refuses_slivers_or_stays_bounded() {
    for case in small().flat_map(|bodies| cases(&bodies)).filter(is_sliver) {
        if let Some(far) = assert_finite_or_refused(&case, plain(Relaxation::Direct), 5) {
            assert!(far <= bound(&case, 5), "{}: {far} m", case.what);
        }
    }
}

#[test]
fn what_is_pinned_stays() {
    for bodies in small() {
        let (model, start) = Bodies { held: Held::All, ..bodies }.build();
        for solver in all_solvers() {
            let mut state = start.clone();
            let mut system = System::new(model.clone(), solver).unwrap();
            system.step(&mut state, &Forces::default(), STEP, Budget::iterations(9)).unwrap();
            assert_eq!(bits(&state), bits(&start), "{solver:?}");
        }
    }
}

/// `solver` with ω in the place of its own, if it has one.
fn with_omega(solver: Solver, new: f32) -> Option<Solver> {
    let mut relaxation = solver.relaxation;
    match &mut relaxation {
        Relaxation::Jacobi { omega }
        | Relaxation::GaussSeidel { omega, .. }
        | Relaxation::Lexicographic { omega } => *omega = new,
        _ => return None,
    }
    Some(Solver { relaxation, ..solver })
}

#[test]
fn omega_at_both_ends() {
    for bodies in small() {
        let mut scene = bodies.build();
        jitter(&scene.0, &mut scene.1, 0.01, 7);
        let case = Case { what: format!("{:?}", bodies.kinds), scene, h: STEP, iterations: 20 };
        for omega in [f32::MIN_POSITIVE, 1e-6, 2.0 - f32::EPSILON] {
            for solver in all_solvers().filter_map(|solver| with_omega(solver, omega)) {
                let far = assert_finite_or_refused(&case, solver, 20).unwrap_or(f32::INFINITY);
                assert!(!solver.safeguard || far <= bound(&case, 20), "{} {solver:?}: {far} m", case.what);
            }
        }
    }
}

/// The default, and in each framework.
fn shipped() -> impl Iterator<Item = Solver> {
    let frameworks = projective_dynamics().into_iter().chain([Framework::PositionBased]);
    frameworks.map(|framework| Solver { framework, ..Solver::default() }).chain([Solver::default()])
}

#[test]
fn ten_thousand_iterations() {
    for bodies in small() {
        let mut scene = bodies.build();
        jitter(&scene.0, &mut scene.1, 0.01, 7);
        let case = Case { what: format!("{:?}", bodies.kinds), scene, h: STEP, iterations: 10_000 };
        for solver in shipped() {
            let far = assert_finite_or_refused(&case, solver, 1);
            assert!(far.is_some_and(|far| far <= bound(&case, 1)), "{} {solver:?}: {far:?}", case.what);
        }
    }
}

/// A refusal leaves no trace: the frames after it are those of a run that never met it.
fn assert_no_trace(
    refuse: impl Fn(&mut System, &mut State) -> SolverError,
    n_frames: u32,
    solvers: impl Fn() -> Vec<Solver>,
) {
    for bodies in small() {
        let (model, start) = bodies.build();
        for solver in solvers() {
            let [mut disturbed, mut alone] = [(); 2].map(|()| System::new(model.clone(), solver).unwrap());
            let (mut a, mut b) = (start.clone(), start.clone());
            let frames = |system: &mut System, state: &mut State, n: u32| {
                for _ in 0..n {
                    system.step(state, &Forces::default(), STEP, Budget::iterations(9)).unwrap();
                }
            };
            frames(&mut disturbed, &mut a, n_frames);
            let before = bits(&a);
            let error = refuse(&mut disturbed, &mut a);
            assert_eq!(bits(&a), before, "{solver:?} {error}");
            frames(&mut disturbed, &mut a, 3);
            frames(&mut alone, &mut b, n_frames + 3);
            assert_eq!(bits(&a), bits(&b), "{:?} {solver:?} after {error}", bodies.kinds);
        }
    }
}

#[test]
fn not_a_number_at_frame_100_is_refused_without_a_trace() {
    let refuse = |system: &mut System, state: &mut State| {
        let last = state.positions.len() - 1;
        let good = state.clone();
        state.positions[last].y = f32::NAN;
        let before = bits(state);
        let error = system.step(state, &Forces::default(), STEP, Budget::iterations(9)).unwrap_err();
        assert_eq!(bits(state), before);
        *state = good;
        let is_named = |e: &SolverError| matches!(e, SolverError::Model(ModelError::NotFinite { particle, .. }) if *particle == last);
        assert!(is_named(&error), "{error}");
        error
    };
    assert_no_trace(refuse, 100, || shipped().collect());
}

/// Gravity takes all particles out of the range of numbers.
#[test]
fn divergence_is_refused_without_a_trace() {
    let refuse = |system: &mut System, state: &mut State| {
        let forces = Forces { gravity: Vec3::splat(3e38), ..Forces::default() };
        let error = system.step(state, &forces, 10.0, Budget::iterations(9)).unwrap_err();
        let first_free = (0..).find(|&p| !system.model().is_pinned(p)).unwrap();
        let is_named = |e: &SolverError| matches!(e, SolverError::Diverged { particle } if *particle == first_free as usize);
        assert!(is_named(&error), "{error}");
        error
    };
    assert_no_trace(refuse, 2, || all_solvers().collect());
}
