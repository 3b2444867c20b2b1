//! Projective Dynamics (Bouaziz et al. 2014): `Y q = b`, Eq. 1, with b from local projections.
//!
//! A vertex is relaxed by `q_i += ω (b_i − (Y q)_i) / Y_ii`. Attachments are springs to a fixed point, so they join the inertia:
//! together they pull the particle to its *anchor*. Springs and flat hinges live in the rows of Y (`rows.rs`); every other kind
//! adds a pass (`pass.rs`).

mod conjugate_gradient;
#[cfg(feature = "direct")]
mod direct;
mod layout;
mod pass;
mod rows;
mod sweep;

use std::ops::Range;

use glam::{Mat3, Vec3, Vec3A};
use vivace_model::Model;

use crate::{Framework, LocalStep, Preconditioner, Relaxation, Solver, SolverError, Stages, VertexSolve};
use layout::Layout;
use pass::{Pass, Passes};
use rows::Rows;
pub(crate) use sweep::{GRAIN, sum_in_pieces};
use sweep::{Vertices, fill};

/// A model prepared for Projective Dynamics, and the positions while a step is solved.
#[derive(Debug)]
pub struct ProjectiveDynamics {
    local: LocalStep,
    vertex: VertexSolve,
    layout: Layout,
    rows: Rows,
    passes: Vec<Box<dyn Pass>>,
    /// Free particles in the model's own order, for the lexicographic sweep.
    in_order: Vec<u32>,
    /// Attachments: particle, target, stiffness.
    attachments: Vec<(u32, Vec3A, f32)>,
    masses: Vec<f32>,
    /// The time step that these hold for.
    h: f32,
    anchor_weights: Vec<f32>,
    inverse_diagonal: Vec<f32>,
    #[cfg(feature = "direct")]
    factor: Option<direct::Factor>,
    is_direct: bool,
    conjugate_gradient: conjugate_gradient::ConjugateGradient,
    // The frame.
    anchors: Vec<Vec3A>,
    q: Vec<Vec3A>,
    /// q an iteration earlier, and before that.
    remembered: Vec<Vec3A>,
    previous: Vec<Vec3A>,
    is_extrapolated: bool,
    saved: Vec<Vec3A>,
    pulls: Vec<Vec3A>,
    next: Vec<Vec3A>,
    residual: Vec<Vec3>,
}

impl ProjectiveDynamics {
    /// Colors the model's graph and gathers the rows of Y.
    ///
    /// # Errors
    /// More constraints than 32 bits can number.
    pub fn new(model: &Model, solver: &Solver) -> Result<Self, SolverError> {
        let Framework::ProjectiveDynamics { local, vertex } = solver.framework else {
            return Err(SolverError::NotPositionBased { relaxation: solver.relaxation.name() });
        };
        let is_direct = matches!(solver.relaxation, Relaxation::Direct);
        // What solves the linear system needs b apart from the sweeps.
        let needs_split = is_direct || matches!(solver.relaxation, Relaxation::ConjugateGradient { .. });
        let local = if needs_split { LocalStep::Split { sweeps: 1 } } else { local };
        let graph = model.graph()?;
        let layout = Layout::new(model, &graph);
        let rows = Rows::new(model, &graph, &layout);
        let passes = Passes::of(model, &layout)?;
        let all = &model.constraints().attachments;
        let held = all.particles.iter().zip(&all.rest);
        let attachments = held
            .map(|(&[particle], rest)| (layout.place[particle as usize], rest.target.into(), rest.stiffness))
            .collect();
        let masses = layout.order.iter().map(|&p| model.masses()[p as usize]).collect();
        let in_order = layout.place.iter().copied().filter(|&slot| layout.is_free(slot)).collect();
        let n = model.n_particles();
        let zeros = || vec![Vec3A::ZERO; n];
        Ok(Self {
            local,
            vertex,
            rows,
            passes,
            in_order,
            attachments,
            masses,
            h: 0.0,
            anchor_weights: vec![0.0; layout.n_free],
            inverse_diagonal: vec![0.0; layout.n_free],
            #[cfg(feature = "direct")]
            factor: None,
            is_direct,
            conjugate_gradient: conjugate_gradient::ConjugateGradient::default(),
            anchors: vec![Vec3A::ZERO; layout.n_free],
            q: zeros(),
            remembered: zeros(),
            previous: zeros(),
            is_extrapolated: false,
            saved: zeros(),
            pulls: vec![Vec3A::ZERO; layout.n_free],
            next: vec![Vec3A::ZERO; layout.n_free],
            residual: vec![Vec3::ZERO; layout.n_free],
            layout,
        })
    }

    /// The coloring's number of classes.
    #[must_use]
    pub fn n_colors(&self) -> usize {
        self.layout.classes.len()
    }

    /// How many local passes there are beside the rows of Y: one for each kind whose projections move with q.
    #[must_use]
    pub fn n_passes(&self) -> usize {
        self.passes.len()
    }

    /// How many entries Y has off its diagonal.
    #[must_use]
    pub fn n_entries(&self) -> usize {
        self.rows.columns.len()
    }

    /// The parameters of a time step `h` \[s\]: inertia, diagonal, factor. Returns at once where they are the same.
    ///
    /// # Errors
    /// Y cannot be factored, or the feature `direct` is missing.
    pub(crate) fn prepare(&mut self, h: f32) -> Result<(), SolverError> {
        if self.h == h {
            return Ok(());
        }
        for (weight, mass) in self.anchor_weights.iter_mut().zip(&self.masses) {
            *weight = mass / (h * h);
        }
        for &(slot, _, stiffness) in &self.attachments {
            if let Some(weight) = self.anchor_weights.get_mut(slot as usize) {
                *weight += stiffness;
            }
        }
        let diagonal = self.rows.diagonal.iter().zip(&self.anchor_weights).map(|(a, b)| a + b);
        for (inverse, diagonal) in self.inverse_diagonal.iter_mut().zip(diagonal) {
            *inverse = 1.0 / diagonal;
        }
        if self.is_direct {
            #[cfg(feature = "direct")]
            {
                self.factor = Some(direct::Factor::new(&self.rows, &self.anchor_weights)?);
            }
            #[cfg(not(feature = "direct"))]
            return Err(SolverError::NoDirect);
        }
        self.h = h;
        Ok(())
    }

    /// Moves the target of attachment `idx` \[m\].
    pub(crate) fn set_attachment_target(&mut self, idx: usize, target: Vec3) {
        if let Some(attachment) = self.attachments.get_mut(idx) {
            attachment.1 = target.into();
        }
    }

    /// Begins a step of `h` \[s\] from `predicted` (s of Eq. 1) \[m\], in the model's order.
    pub(crate) fn begin(&mut self, predicted: &[Vec3]) {
        let Self { layout, q, anchors, anchor_weights, masses, h, .. } = self;
        for (q, &particle) in q.iter_mut().zip(&layout.order) {
            *q = predicted[particle as usize].into();
        }
        anchors.copy_from_slice(&q[..layout.n_free]);
        if !self.attachments.is_empty() {
            for ((anchor, mass), weight) in anchors.iter_mut().zip(masses).zip(&*anchor_weights) {
                *anchor *= *mass / (*h * *h * *weight);
            }
            for &(slot, target, stiffness) in &self.attachments {
                if let Some(anchor) = anchors.get_mut(slot as usize) {
                    *anchor += target * (stiffness / anchor_weights[slot as usize]);
                }
            }
        }
        self.previous.copy_from_slice(&self.q);
        self.is_extrapolated = false;
    }

    /// Writes the positions, in the model's order \[m\].
    pub(crate) fn end(&self, positions: &mut [Vec3]) {
        for (q, &particle) in self.q.iter().zip(&self.layout.order) {
            positions[particle as usize] = (*q).into();
        }
    }

    fn vertices(&self) -> Vertices<'_> {
        Vertices {
            rows: &self.rows,
            anchor_weights: &self.anchor_weights,
            anchors: &self.anchors,
            inverse_diagonal: &self.inverse_diagonal,
        }
    }

    /// What the vertices of `range` would move by, unrelaxed, from the present q: into `next`.
    fn corrections(&mut self, range: Range<usize>) {
        let mut next = std::mem::take(&mut self.next);
        let is_fused = self.is_fused();
        if is_fused && !self.passes.is_empty() {
            self.pulls[range.clone()].fill(Vec3A::ZERO);
            for pass in &self.passes {
                pass.pull_fused(range.clone(), &self.q, &mut self.pulls[range.clone()]);
            }
        }
        let (vertices, q, pulls, passes) = (self.vertices(), &self.q, &self.pulls, &self.passes);
        let out = &mut next[range.clone()];
        match (is_fused, self.vertex) {
            (true, VertexSolve::Diagonal) => {
                fill(range, out, |i| vertices.fused(i, q, pulls[i]) * vertices.inverse_diagonal[i]);
            }
            (true, VertexSolve::Block) => fill(range, out, |i| {
                let mut block = vertices.block(i, q);
                passes.iter().for_each(|pass| pass.add_to_block(i, q, &mut block));
                solve_block(block, vertices.fused(i, q, pulls[i]), vertices.inverse_diagonal[i])
            }),
            (false, _) => {
                fill(range, out, |i| vertices.linear(i, q, pulls[i]) * vertices.inverse_diagonal[i]);
            }
        }
        self.next = next;
    }

    fn is_fused(&self) -> bool {
        matches!(self.local, LocalStep::Fused) || self.vertex == VertexSolve::Block
    }

    /// `b − Y q` of all free vertices, into `residual` \[N\].
    fn residuals(&mut self) {
        let mut residual = std::mem::take(&mut self.residual);
        let (vertices, q, pulls) = (self.vertices(), &self.q, &self.pulls);
        fill(0..self.layout.n_free, &mut residual, |i| vertices.linear(i, q, pulls[i]).into());
        self.residual = residual;
    }

    fn apply_residual_solution(&mut self) {
        for (q, delta) in self.q.iter_mut().zip(&self.residual) {
            *q += Vec3A::from(*delta);
        }
    }
}

/// `block⁻¹ residual`; where the block is not invertible in `f32`, the scalar diagonal serves.
#[inline]
fn solve_block(block: Mat3, residual: Vec3A, inverse_diagonal: f32) -> Vec3A {
    let (x, y, z) = (block.x_axis, block.y_axis, block.z_axis);
    let (yz, zx, xy) = (y.cross(z), z.cross(x), x.cross(y));
    let determinant = x.dot(yz);
    let r = Vec3::from(residual);
    let solved = Vec3::new(yz.dot(r), zx.dot(r), xy.dot(r)) / determinant;
    if determinant > 0.0 && solved.is_finite() { solved.into() } else { residual * inverse_diagonal }
}

impl Stages for ProjectiveDynamics {
    fn n_colors(&self) -> u32 {
        u32::try_from(self.layout.classes.len()).unwrap_or(u32::MAX)
    }

    fn project(&mut self) {
        if self.is_fused() {
            return;
        }
        for pass in &mut self.passes {
            pass.project(&self.q);
        }
        let mut pulls = std::mem::take(&mut self.pulls);
        let (vertices, q, passes) = (self.vertices(), &self.q, &self.passes);
        fill(0..self.layout.n_free, &mut pulls, |i| {
            let mut pull = [vertices.spring_pull(i, q)];
            passes.iter().for_each(|pass| pass.pull_projected(i..i + 1, &mut pull));
            pull[0]
        });
        self.pulls = pulls;
    }

    fn n_sweeps(&self) -> u32 {
        match self.local {
            LocalStep::Split { sweeps } if !self.is_fused() => sweeps.max(1),
            _ => 1,
        }
    }

    fn relax_color(&mut self, color: u32, omega: f32) {
        let range = self.layout.classes[color as usize].clone();
        self.corrections(range.clone());
        for (q, step) in self.q[range.clone()].iter_mut().zip(&self.next[range]) {
            *q += omega * *step;
        }
    }

    fn relax_color_from_previous(&mut self, color: u32, omega: f32) {
        let range = self.layout.classes[color as usize].clone();
        self.corrections(range.clone());
        let steps = self.previous[range.clone()].iter_mut().zip(&self.next[range.clone()]);
        for (q, (previous, step)) in self.q[range].iter_mut().zip(steps) {
            let old = *q;
            *q = *previous + omega * (old + *step - *previous);
            *previous = old;
        }
    }

    fn relax_all(&mut self, omega: f32) {
        self.corrections(0..self.layout.n_free);
        for (q, step) in self.q.iter_mut().zip(&self.next) {
            *q += omega * *step;
        }
    }

    fn relax_in_order(&mut self, omega: f32) {
        for k in 0..self.in_order.len() {
            let i = self.in_order[k] as usize;
            self.corrections(i..i + 1);
            self.q[i] += omega * self.next[i];
        }
    }

    fn solve_by_conjugate_gradient(&mut self, preconditioner: Preconditioner, inner: u32) {
        self.residuals();
        let Self { conjugate_gradient, rows, anchor_weights, residual, .. } = self;
        conjugate_gradient.solve_in_place(rows, anchor_weights, preconditioner, inner, residual);
        self.apply_residual_solution();
    }

    fn solve_directly(&mut self) {
        #[cfg(feature = "direct")]
        {
            self.residuals();
            if let Some(factor) = &mut self.factor {
                factor.solve_in_place(&mut self.residual);
            }
            self.apply_residual_solution();
        }
    }

    fn remember(&mut self) {
        self.remembered.copy_from_slice(&self.q);
        self.is_extrapolated = false;
    }

    fn extrapolate(&mut self, omega: f32) {
        if omega != 1.0 {
            for (q, previous) in self.q.iter_mut().zip(&self.previous) {
                *q = *previous + omega * (*q - *previous);
            }
        }
        std::mem::swap(&mut self.previous, &mut self.remembered);
        self.is_extrapolated = true;
    }

    fn moved(&self) -> f32 {
        let before = if self.is_extrapolated { &self.previous } else { &self.remembered };
        let n = self.layout.n_free;
        let sum = sum_in_pieces(n, |i| f64::from((self.q[i] - before[i]).length_squared()));
        #[expect(clippy::cast_possible_truncation, reason = "positions are f32")]
        let moved = (sum / n.max(1) as f64).sqrt() as f32;
        moved
    }

    fn objective(&self) -> f64 {
        let vertices = self.vertices();
        let rows = sum_in_pieces(self.layout.n_free, |i| vertices.objective(i, &self.q));
        rows + self.passes.iter().map(|pass| pass.energy(&self.q)).sum::<f64>()
    }

    fn residual(&mut self) -> f64 {
        let mut pulls = std::mem::take(&mut self.pulls);
        pulls.fill(Vec3A::ZERO);
        let n = self.layout.n_free;
        self.passes.iter().for_each(|pass| pass.pull_fused(0..n, &self.q, &mut pulls));
        let vertices = self.vertices();
        let sum = sum_in_pieces(n, |i| f64::from(vertices.fused(i, &self.q, pulls[i]).length_squared()));
        self.pulls = pulls;
        (sum / n.max(1) as f64).sqrt()
    }

    fn save(&mut self) {
        self.saved.copy_from_slice(&self.q);
    }

    fn restore(&mut self) {
        self.q.copy_from_slice(&self.saved);
        self.previous.copy_from_slice(&self.saved);
        self.is_extrapolated = false;
    }
}
