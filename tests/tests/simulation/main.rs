//! Simulation: closed forms, the linear problem, and what every solver promises.

#![expect(clippy::unwrap_used, reason = "what fails here fails a test")]

#[path = "../../../crates/vivace-collision/tests/common/mod.rs"]
mod common;

mod budgets;
mod conservation;
mod contacts;
mod convergence;
mod determinism;
mod dragging;
mod estimate;
mod extremes;
mod heap;
mod linear;
mod on_device;
mod pays_for_what_it_holds;
mod symmetry;
mod tearing;
mod verification;
mod wind;

use glam::{DVec3, Vec3};
use vivace_kernels::constraint::Constraint;
use vivace_model::{Forces, KindVisitor, Model, State, Store};
use vivace_solver::{Budget, Solver, System};
use vivace_tests::scenes::{STEP, Scene};

/// The distance between two neighboring numbers at 1.
const EPS: f64 = f32::EPSILON as f64;

/// One frame of `scene`.
fn frame(scene: &Scene, solver: Solver, iterations: u32) -> State {
    frames(scene, solver, &Forces::default(), iterations, 1)
}

fn frames(scene: &Scene, solver: Solver, forces: &Forces, iterations: u32, n: u32) -> State {
    let (model, mut state) = scene.clone();
    let mut system = System::new(model, solver).unwrap();
    for _ in 0..n {
        system.step(&mut state, forces, STEP, Budget::iterations(iterations)).unwrap();
    }
    state
}

/// The largest distance between positions \[m\].
fn distance(a: &[Vec3], b: &[Vec3]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| a.as_dvec3().distance(b.as_dvec3())).fold(0.0, f64::max)
}

/// The largest coordinate \[m\].
fn extent(q: &[Vec3]) -> f64 {
    f64::from(q.iter().map(|q| q.abs().max_element()).fold(0.0, f32::max))
}

const NO_FORCE: Forces = Forces { gravity: Vec3::ZERO, damping: 0.0, wind: None };

/// Σ m x \[kg m\] over the particles.
fn moment(model: &Model, x: impl Iterator<Item = DVec3>) -> DVec3 {
    model.masses().iter().zip(x).map(|(&m, x)| f64::from(m) * x).sum()
}

/// max Y_ii h²/m_i over the free particles: a bound of the condition of D⁻¹ Y, whose largest eigenvalue is at least 1 and whose least
/// is at least min (m/h²)/Y_ii.
fn condition(model: &Model) -> f64 {
    struct Diagonal(Vec<f64>);
    impl KindVisitor for Diagonal {
        fn visit<C: Constraint<N, R>, const N: usize, const R: usize>(&mut self, store: &Store<C, N>) {
            for (particles, rest) in store.particles.iter().zip(&store.rest) {
                for (slot, &particle) in particles.iter().enumerate() {
                    self.0[particle as usize] += f64::from(rest.entry(slot, slot));
                }
            }
        }
    }
    let mut diagonal = Diagonal(vec![0.0; model.n_particles()]);
    model.constraints().visit(&mut diagonal);
    let squared_h = f64::from(STEP).powi(2);
    let of = |(y, &mass): (&f64, &f32)| 1.0 + y * squared_h / f64::from(mass);
    diagonal.0.iter().zip(model.masses()).map(of).fold(1.0, f64::max)
}

/// Where `q += ω r_i/Y_ii` stalls: each step is below half a rounding, ε |q|/2, over ω ≥ 2/3, and what is left of the error is that
/// times the condition; residuals are sums that round a few times more.
fn stall(model: &Model, q: &[Vec3]) -> f64 {
    3.0 * EPS * extent(q) * condition(model)
}
