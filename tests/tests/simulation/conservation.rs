//! What constraints keep: energy under rigid motion, and linear and angular momentum.

use glam::{EulerRot, Quat, Vec3};
use vivace_kernels::constraint::Constraint;
use vivace_model::{Constraints, KindVisitor, Model, State, Store};
use vivace_solver::{Budget, Framework, Relaxation, Solver, System};
use vivace_tests::scenes::{
    Bodies, Held, Kind, STEP, Scene, gauss_seidel, jitter, plain, projective_dynamics, solvers,
};

use crate::{EPS, NO_FORCE, distance, extent, frames, moment, stall};

/// A kind more does not build before it is here, and then in every loop over kinds.
#[test]
fn loops_over_kinds_see_every_kind() {
    let model = Bodies::default().build().0;
    let Constraints { springs, bending, triangle_strain, tet_strain, tet_volume, attachments } =
        model.constraints();
    assert!(
        bending.rest.iter().any(|hinge| hinge.rest == 0.0)
            && bending.rest.iter().any(|hinge| hinge.rest > 0.0)
    );
    let numbers =
        [springs.len(), triangle_strain.len(), tet_strain.len(), tet_volume.len(), attachments.len()];
    assert!(numbers.into_iter().all(|n| n > 0), "{numbers:?}");
}

fn free(kind: Kind) -> Bodies {
    Bodies { kinds: vec![kind], held: Held::Nothing, ..Bodies::default() }
}

/// Kinds whose forces are inner ones, as free bodies in disorder that turn and move.
fn in_motion() -> impl Iterator<Item = (Kind, Scene)> {
    Kind::ALL.into_iter().filter(|kind| kind.is_inner()).map(|kind| {
        let (model, mut start) = free(kind).build();
        jitter(&model, &mut start, 0.02, 5);
        start.velocities.iter_mut().zip(&start.positions).for_each(|(v, q)| *v = Vec3::new(q.z, 0.3, -q.x));
        (kind, (model, start))
    })
}

/// The energy of constraints in a state \[J\], as the solver sees it: its objective where nothing moves.
fn energy(model: &Model, framework: Framework, positions: &[Vec3]) -> f64 {
    let mut system = System::new(model.clone(), Solver { framework, ..plain(gauss_seidel(1.0)) }).unwrap();
    system.set_measuring(true);
    let mut state = State::at_rest(positions.to_vec());
    system.step(&mut state, &NO_FORCE, STEP, Budget::iterations(0)).unwrap().objective.unwrap()
}

/// Sums over the constraints of a model at some positions.
struct Sums<'a> {
    at: &'a [Vec3],
    extent: f64,
    /// Σ W and Σ w/2 C² \[J\].
    energy: f64,
    deviation: f64,
    /// Σ w/2 |δ|², δ being what A q is off by where each of its terms rounds twice \[J\].
    rounding: f64,
    /// Σ of the terms of quadratic energies, which cancel where they are summed by entries of Y \[J\].
    terms: f64,
}

impl KindVisitor for Sums<'_> {
    fn visit<C: Constraint<N, R>, const N: usize, const R: usize>(&mut self, store: &Store<C, N>) {
        for (particles, rest) in store.particles.iter().zip(&store.rest) {
            let q = particles.map(|p| self.at[p as usize]);
            let half = 0.5 * f64::from(rest.weight());
            let columns = (0..N).flat_map(|slot| rest.column(slot));
            let norm: f64 = columns.map(|a| f64::from(a.abs())).sum();
            self.energy += f64::from(rest.energy(&q));
            self.deviation += half * f64::from(rest.deviation(&q).0).powi(2);
            self.rounding += half * (2.0 * EPS * norm * self.extent).powi(2);
            if rest.is_linear() {
                let pairs = (0..N).flat_map(|a| (0..a).map(move |b| (a, b)));
                let of = |(a, b)| f64::from(rest.entry(a, b).abs() * q[a].distance_squared(q[b]));
                self.terms += 0.5 * pairs.map(of).sum::<f64>();
            }
        }
    }
}

fn sums<'a>(model: &Model, at: &'a [Vec3]) -> Sums<'a> {
    let none = Sums { at, extent: extent(at), energy: 0.0, deviation: 0.0, rounding: 0.0, terms: 0.0 };
    let mut sums = none;
    model.constraints().visit(&mut sums);
    sums
}

impl Sums<'_> {
    /// How far an energy E may be off whose residuals are off by those of an energy δ, 2 √(E δ) + δ by Cauchy and Schwarz, and by the
    /// rounding of the sum itself.
    fn slack(&self, energy: f64, framework: Framework) -> f64 {
        let terms = if framework == Framework::PositionBased { 0.0 } else { self.terms };
        2.0 * (energy * self.rounding).sqrt() + self.rounding + 8.0 * EPS * (energy + terms)
    }
}

#[test]
fn energy_is_nothing_at_rest_and_stays_under_rigid_motion() {
    let turn = Quat::from_euler(EulerRot::XYZ, 0.7, -1.1, 2.3);
    let shift = Vec3::new(1.0, -2.0, 0.5);
    for (kind, framework) in Kind::ALL.into_iter().flat_map(|kind| {
        [projective_dynamics()[0], Framework::PositionBased].map(|framework| (kind, framework))
    }) {
        let (model, rest) = free(kind).build();
        let mut bent = rest.clone();
        jitter(&model, &mut bent, 0.02, 3);
        let assert_energy = |q: &[Vec3], expected: f64| {
            let (found, slack) = (energy(&model, framework, q), sums(&model, q).slack(expected, framework));
            assert!((found - expected).abs() <= slack, "{kind:?} {framework:?}: {found}, not {expected}");
        };
        assert_energy(&rest.positions, 0.0);
        let at_bent = sums(&model, &bent.positions);
        let is_position_based = framework == Framework::PositionBased;
        let expected = if is_position_based { at_bent.deviation } else { at_bent.energy };
        assert!(expected > 100.0 * at_bent.slack(0.0, framework), "{kind:?}: {expected} is rounding");
        if kind.is_inner() {
            let moved = |state: &State| state.positions.iter().map(|q| turn * *q + shift).collect::<Vec<_>>();
            assert_energy(&moved(&rest), 0.0);
            assert_energy(&moved(&bent), expected);
        }
        // In Projective Dynamics attachments join the inertia, and a constant is left away.
        if kind.is_inner() || is_position_based {
            assert_energy(&bent.positions, expected);
        }
    }
}

fn mass(model: &Model) -> f64 {
    model.masses().iter().map(|&m| f64::from(m)).sum()
}

/// The most constraints that one particle has.
fn busiest(model: &Model) -> u32 {
    struct Counts(Vec<u32>);
    impl KindVisitor for Counts {
        fn visit<C: Constraint<N, R>, const N: usize, const R: usize>(&mut self, store: &Store<C, N>) {
            store.particles.iter().flatten().for_each(|&p| self.0[p as usize] += 1);
        }
    }
    let mut counts = Counts(vec![0; model.n_particles()]);
    model.constraints().visit(&mut counts);
    counts.0.into_iter().max().unwrap()
}

/// Inner forces add up to 0: XPBD keeps Σ m v in every projection, and so does an exact global step in every iteration.
#[test]
fn linear_momentum_is_kept() {
    let is_extrapolating = |solver: &Solver| {
        let (jacobi, sweep) =
            (Relaxation::Jacobi { omega: 2.0 / 3.0 }, Relaxation::Lexicographic { omega: 1.5 });
        ![jacobi, sweep, gauss_seidel(1.0), gauss_seidel(1.7)].contains(&solver.relaxation)
    };
    for (kind, scene) in in_motion() {
        let (model, start) = &scene;
        for solver in solvers() {
            let is_position_based = solver.framework == Framework::PositionBased;
            if solver.relaxation != Relaxation::Direct && (!is_position_based || is_extrapolating(&solver)) {
                continue;
            }
            for iterations in [1, 4] {
                let end = frames(&scene, solver, &NO_FORCE, iterations, 1);
                let momentum = |v: &[Vec3]| moment(model, v.iter().map(|v| v.as_dvec3()));
                let off = (momentum(&end.velocities) - momentum(&start.velocities)).length();
                // Each constraint of a particle rounds q once in an iteration; then v by ε q / h.
                let roundings = f64::from(2 + busiest(model) * iterations);
                let bound = mass(model) * roundings * 0.5 * EPS * extent(&end.positions) * 3_f64.sqrt()
                    / f64::from(STEP);
                assert!(off <= bound, "{kind:?} {solver:?}: {off} > {bound}");
            }
        }
    }
}

/// Σ m q × (q' − s) \[kg m²\]: the torque of inner forces at q that move s to q', times h².
fn torque(model: &Model, q: &[Vec3], after: &[Vec3], s: &[Vec3]) -> f64 {
    let arms = q.iter().zip(after.iter().zip(s));
    moment(model, arms.map(|(q, (a, s))| q.as_dvec3().cross((*a - *s).as_dvec3()))).length()
}

/// Implicit Euler loses angular momentum; what holds at its answer q' is that inner forces have no torque: Σ m q' × (q' − s) = 0.
/// In Position Based Dynamics it holds where the forces were found, which is at s in one iteration of Jacobi's.
#[test]
fn inner_forces_have_no_torque() {
    for (kind, scene) in in_motion() {
        let model = &scene.0;
        let s = frames(&scene, plain(gauss_seidel(1.0)), &NO_FORCE, 0, 1).positions;
        let (mass, size) = (mass(model), extent(&s));
        for relaxation in [Relaxation::Direct, gauss_seidel(1.2)] {
            let end = frames(&scene, plain(relaxation), &NO_FORCE, 3000, 1).positions;
            let bound = mass * stall(model, &end) * size;
            let off = torque(model, &end, &end, &s);
            assert!(off <= bound, "{kind:?} {relaxation:?}: {off} > {bound}");
        }
        let relaxation = Relaxation::Jacobi { omega: 1.0 };
        let solver = Solver { framework: Framework::PositionBased, ..plain(relaxation) };
        let end = frames(&scene, solver, &NO_FORCE, 1, 1).positions;
        let (off, bound) = (torque(model, &s, &end, &s), mass * EPS * size * size);
        let moved = distance(&s, &end);
        assert!(
            off <= bound && mass * moved * size > 100.0 * bound,
            "{kind:?}: {off} > {bound}, moved {moved}"
        );
    }
}
