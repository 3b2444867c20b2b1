//! Projective Dynamics (Bouaziz et al. 2014): `Y q = b`, Eq. 1, with b from local projections.
//!
//! A vertex is relaxed by `q_i += ω (b_i − (Y q)_i) / Y_ii`. Attachments are springs to a fixed point, so they join the inertia:
//! together they pull the particle to its *anchor*. Springs and flat hinges live in the rows of Y (`rows.rs`); every other kind
//! adds a pass (`pass.rs`).

pub(crate) mod conjugate_gradient;
mod contacts;
#[cfg(feature = "direct")]
pub(crate) mod direct;
mod islands;
pub(crate) mod layout;
pub(crate) mod pass;
mod points;
pub(crate) mod rows;
mod slices;
mod sweep;
#[cfg(test)]
mod tests;

use glam::{Vec3, Vec3A};
use vivace_model::Model;
use wide::f32x8;

use crate::contacts::Found;
use crate::history::History;
use crate::host::Solve;
use crate::parallel::{Split, in_pieces, sum};
use crate::{LocalStep, Preconditioner, Relaxation, SolverError, Stages, VertexSolve};
use contacts::Touching;
use islands::Islands;
use layout::Layout;
use pass::{Pass, Passes};
use points::{LANES, Lanes3, Points, PointsMut};
use rows::Rows;
use slices::Slices;
use sweep::Vertices;

/// A model prepared for Projective Dynamics, and the positions while a step is solved.
#[derive(Debug)]
pub(crate) struct ProjectiveDynamics {
    local: LocalStep,
    vertex: VertexSolve,
    layout: Layout,
    rows: Rows,
    slices: Slices,
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
    /// One over what a sweep resists a push on each free vertex with \[m/N\].
    mobility: Vec<f32>,
    #[cfg(feature = "direct")]
    factor: Option<direct::Factor>,
    is_direct: bool,
    /// Whether a linear solver takes the place of sweeps.
    is_linear: bool,
    conjugate_gradient: conjugate_gradient::ConjugateGradient,
    contacts: Touching,
    /// What hangs together by contacts; `None` until there are any.
    islands: Option<Box<Islands>>,
    // The frame.
    anchors: Points,
    q: Points,
    history: History<f32>,
    /// `Σ w Aᵀ p` of the local step \[N\], where it is apart from the sweeps.
    pulls: Points,
    /// By how much vertices will move \[m\].
    steps: Points,
    /// What linear solvers start from \[N\] and end with \[m\].
    residual: Vec<Vec3>,
}

/// The attachments of a model, particles by the solver's numbers.
pub(crate) fn attachments(model: &Model, layout: &Layout) -> Vec<(u32, Vec3A, f32)> {
    let all = &model.constraints().attachments;
    let held = all.particles.iter().zip(&all.rest);
    held.map(|(&[particle], rest)| (layout.place[particle as usize], rest.target.into(), rest.stiffness))
        .collect()
}

/// The masses of a model by the solver's numbers.
pub(crate) fn masses(model: &Model, layout: &Layout) -> Vec<f32> {
    layout.order.iter().map(|&p| model.masses()[p as usize]).collect()
}

/// For a time step `h`: the weight of each anchor, and one over the diagonal of Y.
///
/// # Errors
/// A diagonal that `f32` cannot hold.
pub(crate) fn weigh(
    h: f32,
    masses: &[f32],
    attachments: &[(u32, Vec3A, f32)],
    rows: &Rows,
    layout: &Layout,
    (anchor_weights, inverse_diagonal): (&mut [f32], &mut [f32]),
) -> Result<(), SolverError> {
    for (weight, mass) in anchor_weights.iter_mut().zip(masses) {
        *weight = mass / (h * h);
    }
    for &(slot, _, stiffness) in attachments {
        if let Some(weight) = anchor_weights.get_mut(slot as usize) {
            *weight += stiffness;
        }
    }
    let diagonal = rows.diagonal.iter().zip(anchor_weights).map(|(a, b)| a + *b);
    for ((inverse, diagonal), &particle) in inverse_diagonal.iter_mut().zip(diagonal).zip(&layout.order) {
        *inverse = 1.0 / diagonal;
        // Otherwise what is heavy or stiff beyond numbers would be pinned, and nobody would know.
        if !inverse.is_normal() {
            return Err(SolverError::Weight { particle, weight: diagonal });
        }
    }
    Ok(())
}

/// Vertices that are worth a thread of their own.
const GRAIN: usize = 32 * LANES;
/// The same, where there is little to compute.
const LARGE_GRAIN: usize = 1 << 14;

impl ProjectiveDynamics {
    /// Colors the model's graph, if there are no `colors`, and gathers the rows of Y, as `relaxation` needs them.
    ///
    /// # Errors
    /// More constraints than 32 bits can number; neighbors of one color.
    pub(crate) fn new(
        model: &Model,
        local: LocalStep,
        vertex: VertexSolve,
        relaxation: Relaxation,
        colors: &[u32],
    ) -> Result<Self, SolverError> {
        let is_direct = matches!(relaxation, Relaxation::Direct);
        // What solves the linear system needs b apart from the sweeps.
        let is_linear = relaxation.is_linear();
        let (local, vertex) =
            if is_linear { (LocalStep::Split { sweeps: 1 }, VertexSolve::Diagonal) } else { (local, vertex) };
        let graph = model.graph()?;
        let layout = Layout::new(model, &graph, colors)?;
        let rows = Rows::new(model, &graph, &layout);
        let slices = Slices::new(&rows, &layout.classes);
        let passes = Passes::of(model, &layout)?;
        let (attachments, masses) = (attachments(model, &layout), masses(model, &layout));
        let in_order = layout.place.iter().copied().filter(|&slot| layout.is_free(slot)).collect();
        let (n, n_free) = (model.n_particles(), layout.n_free);
        let q = Points::zeros(n);
        Ok(Self {
            local,
            vertex,
            rows,
            slices,
            passes,
            in_order,
            attachments,
            masses,
            h: 0.0,
            anchor_weights: vec![0.0; n_free],
            inverse_diagonal: vec![0.0; n_free],
            mobility: vec![0.0; n_free],
            #[cfg(feature = "direct")]
            factor: None,
            is_direct,
            is_linear,
            conjugate_gradient: conjugate_gradient::ConjugateGradient::default(),
            contacts: Touching::default(),
            islands: None,
            anchors: Points::zeros(n_free),
            history: History::new(q.data().len()),
            q,
            pulls: Points::zeros(n_free),
            steps: Points::zeros(n_free),
            residual: vec![Vec3::ZERO; n_free],
            layout,
        })
    }

    /// Takes what hangs together by contacts.
    fn join_islands(&mut self, found: &Found<'_>) {
        if found.contacts.is_empty() && self.islands.is_none() {
            return;
        }
        let Self { islands, rows, attachments, layout, .. } = self;
        let attached = attachments.iter().map(|attachment| attachment.0);
        let islands = islands.get_or_insert_with(|| Box::new(Islands::new(rows, attached)));
        islands.update(found.contacts.iter().map(|contact| layout.places(contact.particles)));
    }

    fn vertices(&self) -> Vertices<'_> {
        Vertices {
            slices: &self.slices,
            anchor_weights: &self.anchor_weights,
            anchors: self.contacts.shifted(&self.anchors),
            diagonal: &self.rows.diagonal,
            inverse_diagonal: &self.inverse_diagonal,
            passes: &self.passes,
        }
    }

    /// By how much the vertices of a slice move from `q`, over-relaxed by `omega` \[m\].
    #[inline]
    fn step(&self, slice: usize, q: &Points, omega: f32) -> Lanes3 {
        let vertices = self.vertices();
        let residual = self.forces(slice, q);
        let step = match self.vertex {
            VertexSolve::Block if self.is_fused() => vertices.by_blocks(slice, q, residual),
            _ => vertices.by_diagonal(slice, residual),
        };
        if self.contacts.is_empty() || omega <= 1.0 {
            return step * f32x8::splat(omega);
        }
        step * self.contacts.weights(self.slices.slices[slice].0, omega)
    }

    /// `b − Y q` of the vertices of a slice \[N\].
    #[inline]
    fn forces(&self, slice: usize, q: &Points) -> Lanes3 {
        if self.is_fused() {
            self.vertices().fused(slice, q)
        } else {
            self.vertices().linear(slice, q, &self.pulls)
        }
    }

    /// `f` of every slice of a color, into `out`.
    fn of_color(&self, color: usize, out: &mut Points, f: impl Fn(usize) -> Lanes3 + Sync) {
        if color >= self.layout.classes.len() {
            return;
        }
        let (range, slices) = (self.layout.classes[color].clone(), self.slices.colors[color].clone());
        in_pieces(0, out.range_mut(range), GRAIN, &|first, mut out: PointsMut<'_>| {
            for at in (0..out.len()).step_by(LANES) {
                let n = (out.len() - at).min(LANES);
                out.store(at, n, f(slices.start + (first + at) / LANES));
            }
        });
    }

    /// `f` of every slice, into `out`.
    fn of_all(&self, out: &mut Points, f: impl Fn(usize) -> Lanes3 + Sync) {
        (0..self.layout.classes.len()).for_each(|color| self.of_color(color, out, &f));
    }

    fn is_fused(&self) -> bool {
        matches!(self.local, LocalStep::Fused) || self.vertex == VertexSolve::Block
    }

    /// `b − Y q` of all free vertices, into `residual` \[N\].
    fn residuals(&mut self) {
        let mut residuals = std::mem::take(&mut self.steps);
        self.of_all(&mut residuals, |slice| self.vertices().linear(slice, &self.q, &self.pulls));
        for (slot, residual) in self.residual.iter_mut().enumerate() {
            *residual = residuals.get(slot).into();
        }
        self.steps = residuals;
    }

    fn apply_residual_solution(&mut self) {
        for (slot, step) in self.residual.iter().enumerate() {
            self.q.set(slot, self.q.get(slot) + Vec3A::from(*step));
        }
    }
}

impl Solve for ProjectiveDynamics {
    /// One for each kind whose projections move with q.
    fn n_passes(&self) -> usize {
        self.passes.len()
    }

    /// Inertia, diagonal, factor. A diagonal may not fit `f32`, Y may have no factor, the feature `direct` may be missing.
    fn prepare(&mut self, h: f32) -> Result<(), SolverError> {
        if self.h == h {
            return Ok(());
        }
        // Nothing holds for any time step until all does.
        self.h = 0.0;
        let (weights, inverse) = (&mut self.anchor_weights, &mut self.inverse_diagonal);
        weigh(h, &self.masses, &self.attachments, &self.rows, &self.layout, (weights, inverse))?;
        if self.vertex == VertexSolve::Diagonal && !self.is_linear {
            self.mobility.clone_from(inverse);
        } else {
            // Blocks and linear solvers resist along a normal with little more than inertia.
            self.mobility.iter_mut().zip(weights).for_each(|(mobility, weight)| *mobility = 1.0 / *weight);
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

    fn set_attachment_target(&mut self, idx: usize, target: Vec3) {
        if let Some(attachment) = self.attachments.get_mut(idx) {
            attachment.1 = target.into();
        }
    }

    /// They are on the diagonal alone: all that is made of it is made anew for the next step.
    fn set_attachments(&mut self, model: &Model) {
        self.attachments = attachments(model, &self.layout);
        self.h = 0.0;
        // Others are held now.
        self.islands = None;
    }

    fn set_contacts(&mut self, found: &Found<'_>) -> usize {
        self.join_islands(found);
        self.contacts.set(found, &self.layout.place, &self.mobility);
        self.contacts.n_colors()
    }

    fn begin(&mut self, _: f32, predicted: &[Vec3]) {
        let Self { layout, q, anchors, anchor_weights, masses, h, .. } = self;
        for (slot, &particle) in layout.order.iter().enumerate() {
            q.set(slot, predicted[particle as usize].into());
        }
        for (slot, weight) in anchor_weights.iter().enumerate() {
            // 1 where nothing is attached.
            anchors.set(slot, q.get(slot) * (masses[slot] / (*h * *h) / weight));
        }
        for &(slot, target, stiffness) in &self.attachments {
            if layout.is_free(slot) {
                let slot = slot as usize;
                anchors.set(slot, anchors.get(slot) + target * (stiffness / anchor_weights[slot]));
            }
        }
        self.history.begin(self.q.data());
        self.contacts.begin(&self.anchors);
    }

    fn end(&mut self, positions: &mut [Vec3]) {
        if let Some(islands) = &mut self.islands {
            islands.put_back(&self.masses, &self.anchors, &mut self.q);
        }
        for (slot, &particle) in self.layout.order.iter().enumerate() {
            positions[particle as usize] = self.q.get(slot).into();
        }
    }
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
        self.of_all(&mut pulls, |slice| {
            let of_springs = self.vertices().spring_pulls(slice, &self.q);
            if self.passes.is_empty() {
                return of_springs;
            }
            let (first, n) = self.slices.slices[slice];
            let mut pulls = of_springs.to_array();
            self.passes.iter().for_each(|pass| pass.pull_projected(first..first + n, &mut pulls[..n]));
            Lanes3::from_array(pulls)
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
        let color = color as usize;
        if rayon::current_num_threads() == 1 {
            // No vertex of a color sees another: each may be written at once.
            let mut q = std::mem::take(&mut self.q);
            for slice in self.slices.colors[color].clone() {
                let (first, n) = self.slices.slices[slice];
                let step = self.step(slice, &q, omega);
                q.store(first, n, q.lanes(first) + step);
            }
            self.q = q;
        } else {
            let mut relaxed = std::mem::take(&mut self.steps);
            self.of_color(color, &mut relaxed, |slice| {
                self.q.lanes(self.slices.slices[slice].0) + self.step(slice, &self.q, omega)
            });
            let range = self.layout.classes[color].clone();
            in_pieces(range.start, self.q.range_mut(range), LARGE_GRAIN, &|first, mut q: PointsMut<'_>| {
                q.copy_from(first, &relaxed);
            });
            self.steps = relaxed;
        }
    }

    fn relax_color_from_previous(&mut self, color: u32, omega: f32) {
        let color = color as usize;
        let mut steps = std::mem::take(&mut self.steps);
        self.of_color(color, &mut steps, |slice| self.step(slice, &self.q, 1.0));
        let (mut q, mut history) = (std::mem::take(&mut self.q), std::mem::take(&mut self.history));
        let stride = q.stride();
        for vertex in self.layout.classes[color].clone() {
            for (axis, steps) in steps.axes().into_iter().enumerate() {
                let at = axis * stride + vertex;
                let (q, previous) = (&mut q.data_mut()[at], &mut history.previous_mut()[at]);
                let old = *q;
                *q = *previous + omega * (old + steps[vertex] - *previous);
                *previous = old;
            }
        }
        (self.q, self.history) = (q, history);
        self.steps = steps;
    }

    fn relax_all(&mut self, omega: f32) {
        let mut steps = std::mem::take(&mut self.steps);
        self.of_all(&mut steps, |slice| self.step(slice, &self.q, 1.0));
        let n_free = self.layout.n_free;
        in_pieces(0, self.q.range_mut(0..n_free), LARGE_GRAIN, &|first, mut q: PointsMut<'_>| {
            q.axpy(omega, first, &steps);
        });
        self.steps = steps;
    }

    fn relax_in_order(&mut self, omega: f32) {
        for k in 0..self.in_order.len() {
            let i = self.in_order[k] as usize;
            let slice = self.slices.of_vertex(i);
            let step = self.step(slice, &self.q, omega).to_array()[i - self.slices.slices[slice].0];
            self.q.set(i, self.q.get(i) + step);
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

    fn meet(&mut self) {
        self.contacts.meet(&self.anchor_weights, &mut self.q);
    }

    fn touch(&mut self) {
        self.contacts.project(&self.mobility, &self.anchor_weights, &mut self.q);
    }

    fn remember(&mut self) {
        self.history.remember(self.q.data());
    }

    fn extrapolate(&mut self, omega: f32) {
        self.history.extrapolate(self.q.data_mut(), omega);
    }

    fn moved(&mut self) -> f32 {
        let (q, before) = (self.q.data(), self.history.before());
        let squared = |k: usize| f64::from((q[k] - before[k]) * (q[k] - before[k]));
        #[expect(clippy::cast_possible_truncation, reason = "positions are f32")]
        let moved = (sum(0..q.len(), &squared) / self.layout.n_free.max(1) as f64).sqrt() as f32;
        moved
    }

    fn objective(&mut self) -> f64 {
        let vertices = Vertices { anchors: &self.anchors, ..self.vertices() };
        let rows = sum(0..self.slices.slices.len(), &|slice| vertices.objective(slice, &self.q));
        let passes = self.passes.iter().map(|pass| pass.energy(&self.q)).sum::<f64>();
        rows + passes + self.contacts.energy(&self.q)
    }

    fn residual(&mut self) -> f64 {
        let vertices = self.vertices();
        let squared = |slice: usize| {
            let residual = vertices.fused(slice, &self.q);
            let n = self.slices.slices[slice].1;
            residual.dot(residual).to_array()[..n].iter().map(|&squared| f64::from(squared)).sum()
        };
        (sum(0..self.slices.slices.len(), &squared) / self.layout.n_free.max(1) as f64).sqrt()
    }

    fn save(&mut self) {
        self.history.save(self.q.data());
        self.contacts.save();
    }

    fn restore(&mut self) {
        self.history.restore(self.q.data_mut());
        self.contacts.restore();
    }
}
