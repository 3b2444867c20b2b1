//! rapier3d's soft bodies on workload A (feature `rapier`).
//!
//! Springs have the energy of ours, k/2 (l − l₀)²: rapier takes a frequency for each, √(k (1/mᵢ + 1/mⱼ)) / 2π, and its steps are
//! implicit Euler's with directions frozen at the start of a substep. Hinges differ: their energy is of the angle, and all have
//! one frequency, here the root mean square of what ours have. Sweeps are colored Gauss-Seidel over impulses, on one thread.

use std::f32::consts::TAU;
use std::time::Instant;

use glam::Vec3;
use rapier3d::dynamics::{
    IntegrationParameters, SoftBodyBuilder, SoftBodyHandle, SoftBodyMaterial, SpringCoefficients,
};
use rapier3d::geometry::ColliderBuilder;
use rapier3d::math::Vector;
use rapier3d::pipeline::PhysicsWorld;
use rayon::ThreadPool;
use vivace_scene::Scene;
use vivace_solver::reference::Answer;
use vivace_solver::{Forces, Model, State};

use super::Sizes;
use super::animation::{Animated, Running};
use super::drape::Drape;
use super::frames::{self, Kind, Left};
use super::scenes::{self, STEP};
use super::sweeps::{SUBSTEP, SWEEP, Task};
use crate::figures::FigureError;

/// How many substeps a step has, and how many sweeps each of them.
type Plan = [usize; 2];

/// What an iteration can be.
struct Iterations {
    /// A step of so many.
    plan: fn(usize) -> Plan,
    /// What one is called.
    one: &'static str,
    many: &'static str,
}

const ITERATIONS: [Iterations; 2] = [
    Iterations { plan: |n| [n, 1], one: SUBSTEP, many: "rapier3d, substeps of one sweep" },
    Iterations { plan: |n| [1, n], one: SWEEP, many: "rapier3d, sweeps" },
];

/// Workload A in rapier's terms.
struct Cloth {
    world: PhysicsWorld,
    body: SoftBodyHandle,
}

impl Cloth {
    /// The springs and hinges of `model`, at rest at `start`.
    fn new(model: &Model, start: &State) -> Self {
        let mut parameters = IntegrationParameters::default();
        // Nothing collides: what contacts need is left out.
        parameters.num_internal_stabilization_iterations = 0;
        parameters.soft_bodies.resweep_strain = f32::MAX;
        parameters.soft_bodies.max_extra_substeps = 0;
        Self::in_world(Self::builder(model, start).no_surface_collider(), parameters)
    }

    fn builder(model: &Model, start: &State) -> SoftBodyBuilder {
        let inverse_mass = |particle: &u32| 1.0 / model.masses()[*particle as usize];
        let undamped = |square: f32| SpringCoefficients::new(square.sqrt() / TAU, 0.0);
        let constraints = model.constraints();
        let springs = constraints.springs.particles.iter().zip(&constraints.springs.rest);
        let edge_softness = springs
            .map(|(pair, spring)| undamped(spring.stiffness * pair.iter().map(inverse_mass).sum::<f32>()));
        let hinges = constraints.bending.particles.iter().zip(&constraints.bending.rest);
        let squares = hinges.map(|(particles, hinge)| {
            let terms = particles.iter().zip(hinge.row).map(|(particle, k)| inverse_mass(particle) * k * k);
            hinge.weight * terms.sum::<f32>()
        });
        let bending = squares.sum::<f32>() / constraints.bending.len().max(1) as f32;
        let pinned = (0..).zip(model.masses()).filter(|(_, mass)| mass.is_infinite());
        let mut builder = SoftBodyBuilder::new(vectors(&start.positions).collect())
            .masses(model.masses().iter().map(|mass| if mass.is_finite() { *mass } else { 1.0 }).collect())
            .pinned_particles(pinned.map(|(particle, _)| particle))
            .edges(constraints.springs.particles.clone())
            .dihedrals(constraints.bending.particles.clone())
            .material(SoftBodyMaterial { bend_softness: undamped(bending), ..SoftBodyMaterial::default() })
            .additional_pgs_iterations(0)
            .can_sleep(false);
        builder.edge_softness = (0..).zip(edge_softness).collect();
        builder
    }

    fn in_world(builder: SoftBodyBuilder, integration_parameters: IntegrationParameters) -> Self {
        let [x, y, z] = Forces::default().gravity.to_array();
        let gravity = Vector::new(x, y, z);
        let mut world = PhysicsWorld { gravity, integration_parameters, ..PhysicsWorld::default() };
        let body = world.insert_soft_body(builder);
        Self { world, body }
    }

    /// Puts all particles where `state` has them.
    fn set(&mut self, state: &State) {
        let body = &mut self.world.soft_bodies[self.body];
        let all = vectors(&state.positions).zip(vectors(&state.velocities));
        for (i, (position, velocity)) in all.enumerate() {
            body.set_particle_position(i, position);
            body.set_particle_velocity(i, velocity);
        }
    }

    /// Time of a step of `h` \[s\] \[ms\].
    fn step(&mut self, h: f32, [substeps, sweeps]: Plan) -> f64 {
        let parameters = &mut self.world.integration_parameters;
        parameters.dt = h;
        parameters.num_solver_iterations = substeps;
        parameters.num_internal_pgs_iterations = sweeps;
        let begin = Instant::now();
        self.world.step();
        begin.elapsed().as_secs_f64() * 1e3
    }

    /// Time of an iteration, and of all else in a step \[ms\].
    fn cost(&mut self, state: &State, plan: fn(usize) -> Plan) -> [f64; 2] {
        const MORE: usize = 20;
        self.set(state);
        // The first warms up.
        let [_, one, many] = [1, 1, 1 + MORE].map(|n| self.step(STEP, plan(n)));
        let each = (many - one) / MORE as f64;
        [each, one - each]
    }

    /// Where all particles are.
    fn positions(&self) -> Vec<Vec3> {
        let body = &self.world.soft_bodies[self.body];
        body.particle_positions().map(|q| Vec3::from_array(q.to_array())).collect()
    }
}

fn vectors(values: &[Vec3]) -> impl Iterator<Item = Vector> {
    values.iter().map(|v| Vector::from_array(v.to_array()))
}

/// Iterations of both kinds.
pub(super) fn tasks((model, start): &(Model, State)) -> impl Iterator<Item = Task> {
    ITERATIONS.into_iter().map(|Iterations { plan, one, .. }| {
        let (mut cloth, start) = (Cloth::new(model, start), start.clone());
        Task::of_others(one, move || cloth.cost(&start, plan)[0])
    })
}

/// What the frame from `state` leaves of its error. Impulses start from nothing, as positions do from their prediction.
pub(super) fn errors(
    sizes: &Sizes,
    stiffness: f32,
    (model, start): (&Model, &State),
    state: &State,
    answer: &Answer,
) -> Vec<Left> {
    let mut all = Vec::new();
    for Iterations { plan, many, .. } in ITERATIONS {
        let mut cloth = Cloth::new(model, start);
        let costs = (0..sizes.runs.div_ceil(3)).map(|_| cloth.cost(state, plan));
        let [each, rest] = costs.fold([f64::INFINITY; 2], |[a, b], [c, d]| [a.min(c), b.min(d)]);
        for &ms in &sizes.budgets {
            let iterations = frames::fitting(ms - rest, each);
            cloth.set(state);
            cloth.step(STEP, plan(iterations as usize));
            all.push(Left {
                stiffness,
                setting: many.to_owned(),
                has_safeguard: false,
                kind: Kind::Rival,
                ms_per_iteration: each,
                ms,
                iterations,
                error: answer.error(&cloth.positions()),
                backoffs: 0,
            });
        }
    }
    all
}

/// The name of the rival on workload C.
pub(super) const DRAPE: &str = "rapier3d, self-collision";

/// Frames of workload C: each takes about a second.
const N_FRAMES: usize = 4;

/// Frames of workload C from where it has come to, with rapier's own settings and contacts of the cloth with itself.
pub(super) fn drape(scene: &Scene, model: &Model, state: &State) -> Drape {
    let thickness = scene.collisions.as_ref().map_or(0.0, |collisions| collisions.thickness);
    let friction = 0.3;
    let parameters = IntegrationParameters::default();
    let builder = Cloth::builder(model, state)
        .surface(model.surface().to_vec())
        .surface_collider(ColliderBuilder::ball(thickness).density(0.0).friction(friction))
        .particle_radius(0.5 * thickness)
        .self_contacts(true);
    let mut cloth = Cloth::in_world(builder, parameters);
    let floor =
        ColliderBuilder::cuboid(10.0, 1.0, 10.0).translation(Vector::new(0.0, -1.0, 0.0)).friction(friction);
    let sphere = ColliderBuilder::ball(0.3).translation(Vector::Y * 0.3).friction(friction);
    cloth.world.insert_collider(floor, None);
    cloth.world.insert_collider(sphere, None);
    cloth.set(state);
    let mut drape = Drape::new(DRAPE.to_owned());
    let plan = [parameters.num_solver_iterations, parameters.num_internal_pgs_iterations];
    (0..N_FRAMES).for_each(|_| drape.push(cloth.step(1.0 / 60.0, plan)));
    drape.strain = scenes::mean_strain(model, &cloth.positions());
    drape
}

struct Animation {
    cloth: Cloth,
    plan: Plan,
}

impl Animated for Animation {
    fn step(&mut self, _: &ThreadPool, h: f32) -> Result<Option<f64>, FigureError> {
        Ok(Some(self.cloth.step(h, self.plan)))
    }

    fn positions(&self) -> Vec<Vec3> {
        self.cloth.positions()
    }
}

/// Substeps of one sweep; and what rapier does unless told otherwise.
pub(super) fn animations(model: &Model, start: &State) -> impl Iterator<Item = Running> {
    let plans = [[2, 1], [5, 1], [10, 1], [20, 1], [4, 4]];
    plans.into_iter().map(|plan @ [substeps, sweeps]| {
        let name = format!("rapier3d, {substeps} substeps of {sweeps}");
        Running::new(name, 60, Animation { cloth: Cloth::new(model, start), plan })
    })
}

#[cfg(test)]
mod tests {
    use vivace_solver::reference::Reference;

    use super::*;
    use crate::bench_simulation::scenes;

    #[test]
    fn a_converged_step_of_a_stretched_cloth_is_ours() {
        let (model, start) = scenes::cloth(6, 100.0, true).unwrap();
        let mut state = start.clone();
        state.positions.iter_mut().for_each(|q| *q *= 1.05);
        // Short, or directions turn.
        let h = 0.1 * STEP;
        let mut reference = Reference::new(&model, f64::from(h)).unwrap();
        let answer = reference.solve(&state, &Forces::default()).unwrap();
        let mut cloth = Cloth::new(&model, &start);
        cloth.set(&state);
        cloth.step(h, [1, 500]);
        let error = answer.error(&cloth.positions());
        assert!(error < 0.01, "{error}");
    }
}
