//! The rows of Y (Eq. 1).

#[cfg(any(test, feature = "direct"))]
use glam::Vec3;
use vivace_coloring::ConstraintGraph;
use vivace_kernels::constraint::Constraint;
use vivace_model::{KindVisitor, Model, Store};

use super::layout::Layout;

/// The rows of the free particles, in the solver's order, without inertia on the diagonal.
///
/// Rows of constraints add up to 0, so `Σ_j −Y_ij (q_j − q_i)` is what they ask of particle i: differences only, and nothing
/// cancels far from the origin. The first entries of each row, up to `spring_ends`, are springs; two springs between the same
/// particles are one entry.
#[derive(Debug, Clone, Default)]
pub(crate) struct Rows {
    /// Entries of row i: `offsets[i]..offsets[i + 1]`.
    pub(crate) offsets: Vec<u32>,
    /// Where the springs of row i end.
    pub(crate) spring_ends: Vec<u32>,
    /// The other particle. Pinned ones are not below the number of rows.
    pub(crate) columns: Vec<u32>,
    /// −Y_ij \[N/m\].
    pub(crate) weights: Vec<f32>,
    /// The part of flat hinges in it \[N/m\]: for their energy.
    pub(crate) linear: Vec<f32>,
    /// k l, the spring's part in it times its rest length \[N\]; 0 where there is none.
    pub(crate) pulls: Vec<f32>,
    /// k, the spring's part in it \[N/m\].
    pub(crate) stiffness: Vec<f32>,
    /// Y_ii less inertia and attachments \[N/m\].
    pub(crate) diagonal: Vec<f32>,
}

/// One entry while rows are gathered.
#[derive(Debug, Clone, Copy, Default)]
struct Entry {
    weight: f64,
    linear: f64,
    pull: f64,
    stiffness: f64,
}

/// Adds each constraint to the rows of its particles.
struct Gather<'a> {
    graph: &'a ConstraintGraph,
    entries: Vec<Entry>,
    diagonal: Vec<f64>,
}

impl Gather<'_> {
    fn entry(&mut self, a: u32, b: u32) -> Option<&mut Entry> {
        let idx = self.graph.neighbors(a).binary_search(&b).ok()?;
        self.entries.get_mut(self.graph.csr().offsets()[a as usize] as usize + idx)
    }
}

impl KindVisitor for Gather<'_> {
    fn visit<C: Constraint<N, R>, const N: usize, const R: usize>(&mut self, store: &Store<C, N>) {
        if N == 1 {
            // Attachments belong to the particle's own inertia: see `ProjectiveDynamics::begin`.
            return;
        }
        for (particles, rest) in store.particles.iter().zip(&store.rest) {
            for (a, &i) in particles.iter().enumerate() {
                self.diagonal[i as usize] += f64::from(rest.entry(a, a));
                for (b, &j) in particles.iter().enumerate() {
                    if a != b
                        && let Some(entry) = self.entry(i, j)
                    {
                        let weight = -f64::from(rest.entry(a, b));
                        entry.weight += weight;
                        entry.linear += if rest.is_linear() { weight } else { 0.0 };
                    }
                }
            }
        }
    }
}

impl Rows {
    /// Rows from constraints. `graph` is the model's.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "matrices are f32; entries fit 32 bits as those of the graph do"
    )]
    pub(crate) fn new(model: &Model, graph: &ConstraintGraph, layout: &Layout) -> Self {
        let entries = vec![Entry::default(); graph.csr().len()];
        let mut gather = Gather { graph, entries, diagonal: vec![0.0; model.n_particles()] };
        model.constraints().visit(&mut gather);
        let springs = &model.constraints().springs;
        for (&[a, b], spring) in springs.particles.iter().zip(&springs.rest) {
            let (k, l) = (f64::from(spring.stiffness), f64::from(spring.rest));
            for (i, j) in [(a, b), (b, a)] {
                if let Some(entry) = gather.entry(i, j) {
                    entry.pull += k * l;
                    entry.stiffness += k;
                }
            }
        }
        let mut rows = Self { offsets: vec![0], ..Self::default() };
        for &particle in &layout.order[..layout.n_free] {
            let first = graph.csr().offsets()[particle as usize] as usize;
            let row = graph.neighbors(particle).iter().zip(&gather.entries[first..]);
            let (springs, others): (Vec<_>, Vec<_>) = row.partition(|(_, entry)| entry.stiffness > 0.0);
            for (k, (neighbor, entry)) in springs.iter().chain(&others).enumerate() {
                if k == springs.len() {
                    rows.spring_ends.push(rows.columns.len() as u32);
                }
                rows.columns.push(layout.place[**neighbor as usize]);
                rows.weights.push(entry.weight as f32);
                rows.linear.push(entry.linear as f32);
                rows.pulls.push(entry.pull as f32);
                rows.stiffness.push(entry.stiffness as f32);
            }
            if others.is_empty() {
                rows.spring_ends.push(rows.columns.len() as u32);
            }
            rows.offsets.push(rows.columns.len() as u32);
            rows.diagonal.push(gather.diagonal[particle as usize] as f32);
        }
        rows
    }

    /// What part of an entry's energy its row has: an entry towards a free particle stands in two rows.
    pub(crate) fn share(&self, entry: usize) -> f32 {
        if (self.columns[entry] as usize) < self.len() { 0.5 } else { 1.0 }
    }

    /// ‖r − Y δ‖ / ‖r‖, summed up in `f64`; 0 for r = 0.
    #[cfg(any(test, feature = "direct"))]
    pub(crate) fn relative_residual(&self, anchor_weights: &[f32], r: &[Vec3], solution: &[Vec3]) -> f64 {
        let (mut left, mut first) = (0.0, 0.0);
        for i in 0..self.len() {
            let d = f64::from(self.diagonal[i]) + f64::from(anchor_weights[i]);
            let mut sum = r[i].as_dvec3() - d * solution[i].as_dvec3();
            for k in self.offsets[i] as usize..self.offsets[i + 1] as usize {
                // Pinned particles, whose numbers are beyond the rows, do not move.
                if let Some(x) = solution.get(self.columns[k] as usize) {
                    sum += f64::from(self.weights[k]) * x.as_dvec3();
                }
            }
            left += sum.length_squared();
            first += r[i].as_dvec3().length_squared();
        }
        if first > 0.0 { (left / first).sqrt() } else { 0.0 }
    }

    /// How many rows there are.
    pub(crate) fn len(&self) -> usize {
        self.diagonal.len()
    }
}
