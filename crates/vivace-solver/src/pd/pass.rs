//! What a kind of constraint adds beyond Y: projections that move with q. One pass for each kind that the scene holds and that is
//! neither linear nor built into the rows; none, no cost.

use std::ops::Range;

use glam::{Mat3, Vec3, Vec3A};
use rayon::prelude::*;
use vivace_graph::Incidence;
use vivace_kernels::constraint::Constraint;
use vivace_model::{KindVisitor, Model, Store};

use super::layout::Layout;
use super::points::Points;
use crate::SolverError;
use crate::error::narrow;
use crate::parallel::sum;

/// A kind's local step.
pub(crate) trait Pass: Send + Sync + std::fmt::Debug {
    /// Computes all projections from q.
    fn project(&mut self, q: &Points);
    /// Adds `w Aᵀ p` for the particles in `range`, p as last projected.
    fn pull_projected(&self, range: Range<usize>, out: &mut [Vec3A]);
    /// Adds `w Aᵀ p(q)` for the particles in `range`.
    fn pull_fused(&self, range: Range<usize>, q: &Points, out: &mut [Vec3A]);
    /// Adds to `block` by how much the kind's exact block at `particle` differs from its part in Y.
    fn add_to_block(&self, particle: usize, q: &Points, block: &mut Mat3);
    /// The energy of the kind's constraints \[J\].
    fn energy(&self, q: &Points) -> f64;
}

/// The pass of kind `C`.
#[derive(Debug)]
struct KindPass<C, const N: usize, const R: usize> {
    particles: Vec<[u32; N]>,
    rest: Vec<C>,
    projected: Vec<[Vec3; R]>,
    /// Particle to `constraint · N + slot`.
    offsets: Vec<u32>,
    slots: Vec<u32>,
}

/// Collects the passes of a model.
pub(crate) struct Passes<'a> {
    layout: &'a Layout,
    passes: Vec<Box<dyn Pass>>,
    failed: Option<SolverError>,
}

impl<'a> Passes<'a> {
    /// One pass for each kind that needs it.
    pub(crate) fn of(model: &Model, layout: &'a Layout) -> Result<Vec<Box<dyn Pass>>, SolverError> {
        let mut passes = Self { layout, passes: Vec::new(), failed: None };
        model.constraints().visit(&mut passes);
        passes.failed.map_or(Ok(passes.passes), Err)
    }
}

impl KindVisitor for Passes<'_> {
    fn visit<C: Constraint<N, R>, const N: usize, const R: usize>(&mut self, store: &Store<C, N>) {
        let Some((particles, rest)) = nonlinear(store, self.layout) else { return };
        match KindPass::new(particles, rest, self.layout.n_free) {
            Ok(pass) => self.passes.push(Box::new(pass)),
            Err(error) => self.failed = Some(error),
        }
    }
}

/// The constraints of a kind that need a pass, if there are any, particles by the solver's numbers.
pub(crate) fn nonlinear<C: Constraint<N, R>, const N: usize, const R: usize>(
    store: &Store<C, N>,
    layout: &Layout,
) -> Option<(Vec<[u32; N]>, Vec<C>)> {
    // Springs and attachments are built into rows and anchors; hinges at rest when flat need no projection.
    let needs_pass = |(_, rest): &(&[u32; N], &C)| N > 2 && !rest.is_linear();
    let all = store.particles.iter().zip(&store.rest).filter(needs_pass);
    let (particles, rest): (Vec<_>, Vec<_>) = all.map(|(&p, &rest)| (layout.places(p), rest)).unzip();
    (!rest.is_empty()).then_some((particles, rest))
}

/// By free particle, the places `constraint · N + slot` that it has: where each particle's begin, and the places.
pub(crate) fn slots<const N: usize>(
    particles: &[[u32; N]],
    n_free: usize,
) -> Result<(Vec<u32>, Vec<u32>), SolverError> {
    let n_particles = particles.iter().flatten().max().map_or(0, |&most| most as usize + 1).max(n_free);
    let incidence = Incidence::from_constraints(n_particles, particles)?;
    let (mut offsets, mut slots) = (vec![0], Vec::new());
    for particle in (0..).take(n_free) {
        for &constraint in incidence.constraints(particle) {
            let members = &particles[constraint as usize];
            let at = (0..).zip(members).filter(|&(_, &p)| p == particle).map(|(slot, _)| slot);
            // 4 · 2^30 slots: more than memory holds.
            let n = u32::try_from(N).unwrap_or(u32::MAX);
            slots.extend(at.map(|slot: u32| constraint * n + slot));
        }
        offsets.push(narrow("particles of constraints", slots.len())?);
    }
    Ok((offsets, slots))
}

impl<C: Constraint<N, R>, const N: usize, const R: usize> KindPass<C, N, R> {
    fn new(particles: Vec<[u32; N]>, rest: Vec<C>, n_free: usize) -> Result<Self, SolverError> {
        let (offsets, slots) = slots(&particles, n_free)?;
        let projected = vec![[Vec3::ZERO; R]; particles.len()];
        Ok(Self { particles, rest, projected, offsets, slots })
    }

    fn slots(&self, particle: usize) -> impl Iterator<Item = (usize, usize)> {
        let range = self.offsets[particle] as usize..self.offsets[particle + 1] as usize;
        self.slots[range].iter().map(|&slot| (slot as usize / N, slot as usize % N))
    }

    #[inline]
    fn corners(&self, constraint: usize, q: &Points) -> [Vec3; N] {
        self.particles[constraint].map(|particle| q.get(particle as usize).into())
    }
}

/// Constraints that one thread projects before another may take over.
const GRAIN: usize = 512;

/// Constraints of one or several particles that are projected together.
const AT_ONCE: usize = 64;

impl<C: Constraint<N, R>, const N: usize, const R: usize> Pass for KindPass<C, N, R> {
    fn project(&mut self, q: &Points) {
        let (particles, rest) = (&self.particles, &self.rest);
        let piece = |(piece, projected): (usize, &mut [[Vec3; R]])| {
            let first = piece * GRAIN;
            for (k, aq) in (first..).zip(projected.iter_mut()) {
                *aq = rest[k].apply(&particles[k].map(|p| q.get(p as usize).into()));
            }
            C::project_all(|k| &rest[first + k], projected);
        };
        if rayon::current_num_threads() == 1 {
            self.projected.chunks_mut(GRAIN).enumerate().for_each(piece);
        } else {
            self.projected.par_chunks_mut(GRAIN).enumerate().for_each(piece);
        }
    }

    fn pull_projected(&self, range: Range<usize>, out: &mut [Vec3A]) {
        for (particle, out) in range.zip(out) {
            for (constraint, slot) in self.slots(particle) {
                *out += Vec3A::from(self.rest[constraint].pull(slot, &self.projected[constraint]));
            }
        }
    }

    fn pull_fused(&self, range: Range<usize>, q: &Points, out: &mut [Vec3A]) {
        let (first, mut particle) = (range.start, range.start);
        let [begin, end] = [range.start, range.end].map(|particle| self.offsets[particle] as usize);
        let mut projected = [[Vec3::ZERO; R]; AT_ONCE];
        for at in (begin..end).step_by(AT_ONCE) {
            let slots = &self.slots[at..end.min(at + AT_ONCE)];
            let constraint = |k: usize| slots[k] as usize / N;
            let projected = &mut projected[..slots.len()];
            for (k, aq) in projected.iter_mut().enumerate() {
                *aq = self.rest[constraint(k)].apply(&self.corners(constraint(k), q));
            }
            C::project_all(|k| &self.rest[constraint(k)], projected);
            for (k, p) in projected.iter().enumerate() {
                while self.offsets[particle + 1] as usize <= at + k {
                    particle += 1;
                }
                out[particle - first] += Vec3A::from(self.rest[constraint(k)].pull(slots[k] as usize % N, p));
            }
        }
    }

    fn add_to_block(&self, particle: usize, q: &Points, block: &mut Mat3) {
        for (constraint, slot) in self.slots(particle) {
            let rest = &self.rest[constraint];
            *block += rest.block(&self.corners(constraint, q), slot);
            *block -= Mat3::from_diagonal(Vec3::splat(rest.entry(slot, slot)));
        }
    }

    fn energy(&self, q: &Points) -> f64 {
        let of = |constraint: usize| f64::from(self.rest[constraint].energy(&self.corners(constraint, q)));
        sum(0..self.particles.len(), &of)
    }
}

#[cfg(test)]
mod tests {
    use vivace_mesh::beam;
    use vivace_model::ModelBuilder;

    use super::*;

    /// However many particles at a time, and also where their constraints are more than are projected at once.
    #[test]
    fn fused_is_bitwise_projected_then_pulled() {
        let mesh = beam::regular([5, 3, 3], 0.1).unwrap();
        let mut builder = ModelBuilder::new();
        builder.volume(&mesh, 1000.0).unwrap();
        builder.tet_strain(0, mesh.tets(), 1e4).unwrap();
        let (some, others) = mesh.tets().split_at(100);
        builder.tet_volume(0, some, 1e4, [0.9, 1.1]).unwrap();
        builder.tet_volume(0, others, 1e4, [1.0, 1.0]).unwrap();
        builder.pin(3).unwrap();
        let (model, state) = builder.build().unwrap();
        let layout = Layout::new(&model, &model.graph().unwrap(), &[]).unwrap();
        let mut q = Points::zeros(model.n_particles());
        for (slot, &particle) in layout.order.iter().enumerate() {
            let k = particle as f32;
            let shift = Vec3::new((12.9 * k).sin(), (78.2 * k).sin(), (37.7 * k).sin());
            q.set(slot, (state.positions[particle as usize] + 0.05 * shift).into());
        }
        let mut passes = Passes::of(&model, &layout).unwrap();
        assert_eq!(passes.len(), 2);
        for pass in &mut passes {
            pass.project(&q);
            for n in [1, 3, 8, layout.n_free] {
                for first in (0..layout.n_free).step_by(n) {
                    let range = first..(first + n).min(layout.n_free);
                    let [mut projected, mut fused] = [(); 2].map(|()| vec![Vec3A::ZERO; range.len()]);
                    pass.pull_projected(range.clone(), &mut projected);
                    pass.pull_fused(range.clone(), &q, &mut fused);
                    assert_eq!(fused, projected, "{range:?}");
                    assert!(fused.iter().all(|pull| pull.length() > 0.0), "{range:?}");
                }
            }
        }
    }
}
