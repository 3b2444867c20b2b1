//! What roundings may add to an objective.

use glam::Vec3;
use vivace_kernels::constraint::Constraint;
use vivace_model::{KindVisitor, Model, Store};

/// Positions in `f32` are off by as much as they are large, and the objective by the diagonal of Y times the square of that. Where it is near 0,
/// as in free fall, that is all there is of it.
#[derive(Debug)]
pub(crate) struct Rounding {
    /// Of all free particles \[kg\].
    mass: f64,
    /// The trace of what constraints add to Y \[N/m\].
    stiffness: f64,
    /// Mean square of the positions \[m²\].
    squared_size: f64,
}

impl Rounding {
    pub(crate) fn new(model: &Model) -> Self {
        let free = model.masses().iter().filter(|mass| mass.is_finite());
        let mut trace = Trace(0.0);
        model.constraints().visit(&mut trace);
        Self { mass: free.map(|&mass| f64::from(mass)).sum(), stiffness: trace.0, squared_size: 0.0 }
    }

    /// Particles are there \[m\].
    pub(crate) fn see(&mut self, positions: &[Vec3]) {
        let squares = positions.iter().map(|p| p.as_dvec3().length_squared());
        self.squared_size = squares.sum::<f64>() / positions.len().max(1) as f64;
    }

    /// Of a (small) step of `h` \[s\], in \[J\].
    pub(crate) fn of(&self, h: f32) -> f64 {
        let (epsilon, h) = (f64::from(f32::EPSILON), f64::from(h));
        epsilon * epsilon * self.squared_size * (self.mass / (h * h) + self.stiffness)
    }
}

struct Trace(f64);

impl KindVisitor for Trace {
    fn visit<C: Constraint<N, R>, const N: usize, const R: usize>(&mut self, store: &Store<C, N>) {
        let diagonal = store.rest.iter().flat_map(|rest| (0..N).map(|slot| rest.entry(slot, slot)));
        self.0 += diagonal.map(f64::from).sum::<f64>();
    }
}
