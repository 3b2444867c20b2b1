//! The stages of Projective Dynamics as runs of kernels: see `pd/mod.rs`, of which this is the twin.

use glam::{Vec3, Vec3A, Vec4};
use vivace_collision::Detector;
use vivace_coloring::Vivace;
use vivace_kernels::Backend;
use vivace_kernels::pd::{
    Anchor, FusedResidual, LinearResidual, MoveByBlock, MoveByDiagonal, Omega, RelaxFused, RelaxLinear,
    RowEnergy, ShiftAnchor, SpringBlock, SpringPull,
};
use vivace_kernels::step::{CopyVector, ExtrapolateUniform, SquaredDistance, SquaredLength};
use vivace_model::{Forces, Model, State};

use super::collide::Resists;
use super::history::History;
use super::linear::Linear;
use super::motion::Motion;
use super::pass::{Pass, Passes};
use super::recolor::Recolor;
use super::rows::DeviceRows;
use super::sums::Sums;
use super::watch::Watch;
use super::{Solve, failure};
use crate::error::narrow;
use crate::pd::layout::Layout;
use crate::pd::rows::Rows;
use crate::pd::{attachments, masses, weigh};
use crate::stages::TOLERATED_RISE;
use crate::{
    Base, Ease, Framework, LocalStep, Preconditioner, Relaxation, Solver, SolverError, StepReport,
    VertexSolve,
};

/// How a particle is relaxed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Local {
    /// Projections apart, so many sweeps for each.
    Split {
        sweeps: u32,
    },
    /// Projections from the latest positions, by the diagonal of Y or by blocks.
    Fused,
    Blocks,
}

/// A model prepared for a solver on a device, and all that changes in a frame.
pub(super) struct Frame<B: Backend> {
    local: Local,
    has_previous_in_place: bool,
    layout: Layout,
    rows_on_host: Rows,
    rows: DeviceRows<B>,
    passes: Vec<Box<dyn Pass<B>>>,
    colors: Vec<B::List>,
    recolor: Option<Recolor<B>>,
    free: B::List,
    n_free: u32,
    /// Attachments: particle, target, stiffness; and whether the device has not seen the last change of theirs.
    attachments: Vec<(u32, Vec3A, f32)>,
    are_targets_new: bool,
    masses: Vec<f32>,
    /// The time step that these hold for.
    h: f32,
    anchor_weights: Vec<f32>,
    inverse_diagonal: Vec<f32>,
    holds: B::Buffer<Vec4>,
    anchors: Anchors<B>,
    motion: Motion<B>,
    history: History<B>,
    pulls: B::Buffer<Vec4>,
    /// `b − Y q` \[N\]; where nothing is left of it, scratch.
    residuals: B::Buffer<Vec4>,
    blocks: B::Buffer<[Vec4; 2]>,
    latest: B::Buffer<Vec4>,
    /// Numbers that are added up together.
    groups: Vec<u32>,
    sums: Sums<B>,
    watch: Watch<B, Omega>,
    linear: Option<Linear<B>>,
    /// What the device could not do in this frame.
    failed: Option<SolverError>,
}

/// Where inertia and attachments pull the particles together.
struct Anchors<B: Backend> {
    own: B::Buffer<Vec4>,
    /// The same as contacts shift them, if there may be any.
    shifted: Option<Shifted<B>>,
}

impl<B: Backend> Anchors<B> {
    /// Those that sweeps see.
    fn seen(&self) -> &B::Buffer<Vec4> {
        self.shifted.as_ref().map_or(&self.own, |shifted| &shifted.anchors)
    }
}

/// Anchors that the forces of contacts shift.
struct Shifted<B: Backend> {
    anchors: B::Buffer<Vec4>,
    /// Where vertices were before their contacts moved them \[m\].
    from: B::Buffer<Vec4>,
    history: History<B>,
}

impl<B: Backend> Shifted<B> {
    fn new(backend: &B, n_free: u32) -> Self {
        let vectors = || backend.filled(n_free as usize, Vec4::ZERO);
        Self { anchors: vectors(), from: vectors(), history: History::new(backend, n_free, n_free) }
    }
}

impl<B: Backend + 'static> Frame<B> {
    /// Colors the model's graph, lays out the rows of Y, and takes all memory.
    pub(super) fn new(
        backend: &B,
        model: &Model,
        solver: &Solver,
        colors: &[u32],
    ) -> Result<Self, SolverError> {
        let local = match solver.framework {
            // What solves the linear system needs b apart.
            _ if solver.relaxation.is_linear() => Local::Split { sweeps: 1 },
            Framework::ProjectiveDynamics { vertex: VertexSolve::Block, .. } => Local::Blocks,
            Framework::ProjectiveDynamics { local: LocalStep::Split { sweeps }, .. } => {
                Local::Split { sweeps }
            }
            _ => Local::Fused,
        };
        let base = match solver.relaxation {
            Relaxation::GaussSeidel { base, .. } => base,
            _ => Base::Latest,
        };
        let graph = model.graph()?;
        let layout = Layout::new(model, &graph, colors)?;
        let rows_on_host = Rows::new(model, &graph, &layout);
        let rows = DeviceRows::new(backend, &rows_on_host);
        let passes = Passes::of(backend, model, &layout)?;
        let (n, n_free) = (narrow("particles", model.n_particles())?, narrow("particles", layout.n_free)?);
        let linear = Linear::of(backend, solver.relaxation, &rows_on_host, [n, n_free])?;
        let groups: Vec<u32> = [n_free].into_iter().chain(passes.iter().map(|pass| pass.len())).collect();
        let vectors = |is_used: bool| backend.filled(if is_used { layout.n_free } else { 0 }, Vec4::ZERO);
        let is_split = matches!(local, Local::Split { .. });
        let n_blocks = if local == Local::Blocks { layout.n_free } else { 0 };
        let has_previous_in_place = base == Base::PreviousInPlace;
        let frame = Self {
            local,
            has_previous_in_place,
            rows_on_host,
            rows,
            colors: ranges(backend, &layout),
            recolor: None,
            free: backend.range(0..n_free),
            n_free,
            attachments: attachments(model, &layout),
            are_targets_new: true,
            masses: masses(model, &layout),
            h: 0.0,
            anchor_weights: vec![0.0; layout.n_free],
            inverse_diagonal: vec![0.0; layout.n_free],
            holds: vectors(true),
            anchors: Anchors { own: vectors(true), shifted: None },
            motion: Motion::new(backend, model, &layout, n),
            history: History::new(backend, n, n_free),
            pulls: vectors(is_split),
            residuals: vectors(true),
            blocks: backend.filled(n_blocks, [Vec4::ZERO; 2]),
            latest: vectors(has_previous_in_place),
            sums: Sums::new(backend, &groups),
            groups,
            watch: Watch::new(backend),
            linear,
            failed: None,
            passes,
            layout,
        };
        frame.check(backend)?;
        Ok(frame)
    }

    /// Whether the device holds the larger arrays.
    fn check(&self, backend: &B) -> Result<(), SolverError> {
        backend.fetch(&self.rows.springs, &mut []).map_err(failure)?;
        backend.fetch(&self.rows.taps, &mut []).map_err(failure)?;
        backend.fetch(&self.motion.q, &mut []).map_err(failure)
    }

    /// What attachments add to the anchors \[m\], and the share of the prediction in them.
    fn holds(&self) -> Vec<Vec4> {
        let share = |(mass, weight): (&f32, &f32)| Vec3::ZERO.extend(mass / (self.h * self.h) / weight);
        let mut holds: Vec<Vec4> = self.masses.iter().zip(&self.anchor_weights).map(share).collect();
        for &(slot, target, stiffness) in &self.attachments {
            if let Some(hold) = holds.get_mut(slot as usize) {
                *hold += (Vec3::from(target) * (stiffness / self.anchor_weights[slot as usize])).extend(0.0);
            }
        }
        holds
    }

    /// All of `list` from the same positions.
    fn relax_together(&mut self, backend: &B, list: &B::List, omega: f32) {
        if matches!(self.local, Local::Split { .. }) {
            self.linear_residuals(backend, list);
        } else {
            self.fused_residuals(backend, list);
        }
        if self.local == Local::Blocks {
            self.find_blocks(backend, list);
        }
        let (rows, residuals) = (backend.view(&self.rows.rows), backend.view(&self.residuals));
        let anchors = backend.view(self.anchors.seen());
        let (q, omega) = (&mut self.motion.q, &Omega { omega });
        let omega = self.watch.sweep(omega);
        if self.local == Local::Blocks {
            let inputs = (rows, residuals, anchors, backend.view(&self.blocks));
            backend.map::<MoveByBlock>(list, omega, inputs, q);
        } else {
            backend.map::<MoveByDiagonal>(list, omega, (rows, residuals, anchors), q);
        }
    }

    /// Projects contacts, whose forces shift the anchors that sweeps see.
    fn relax_apart(&mut self, backend: &B, resists: Resists) {
        let Some(Shifted { anchors, from, .. }) = &mut self.anchors.shifted else { return };
        backend.map::<CopyVector>(&self.free, &(), (backend.view(&self.motion.q),), from);
        self.motion.relax_contacts(backend, resists);
        if let Some(contacts) = &self.motion.contacts {
            let q = backend.view(&self.motion.q);
            let inputs = (q, backend.view(from), backend.view(contacts.mobility(resists)));
            backend.update::<ShiftAnchor>(&self.free, &(), inputs, anchors);
        }
    }

    fn linear_residuals(&mut self, backend: &B, list: &B::List) {
        let (rows, taps) = (backend.view(&self.rows.rows), backend.view(&self.rows.taps));
        let (anchors, pulls) = (backend.view(self.anchors.seen()), backend.view(&self.pulls));
        let inputs = (rows, taps, anchors, pulls, backend.view(&self.motion.q));
        backend.map::<LinearResidual>(list, &(), inputs, &mut self.residuals);
    }

    fn fused_residuals(&mut self, backend: &B, list: &B::List) {
        let (rows, q) = (&self.rows, &self.motion.q);
        let (of_rows, taps) = (backend.view(&rows.rows), backend.view(&rows.taps));
        let (pulls, anchors) = (backend.view(&rows.pulls), backend.view(self.anchors.seen()));
        let inputs = (of_rows, taps, pulls, anchors, backend.view(q));
        backend.map::<FusedResidual>(list, &(), inputs, &mut self.residuals);
        self.passes.iter().for_each(|pass| pass.pull_fused(backend, list, q, &mut self.residuals));
    }

    fn find_blocks(&mut self, backend: &B, list: &B::List) {
        let (rows, q) = (&self.rows, &self.motion.q);
        let (of_rows, taps) = (backend.view(&rows.rows), backend.view(&rows.taps));
        let inputs = (of_rows, taps, backend.view(&rows.springs), backend.view(q));
        backend.map::<SpringBlock>(list, &(), inputs, &mut self.blocks);
        self.passes.iter().for_each(|pass| pass.add_to_blocks(backend, list, q, &mut self.blocks));
    }

    /// Adds up the objective \[J\].
    fn add_objective(&mut self, backend: &B) {
        let (rows, q) = (&self.rows, &self.motion.q);
        let (of_rows, taps) = (backend.view(&rows.rows), backend.view(&rows.taps));
        let (springs, anchors) = (backend.view(&rows.springs), backend.view(&self.anchors.own));
        let inputs = (of_rows, taps, springs, anchors, backend.view(q));
        backend.map::<RowEnergy>(&self.free, &(), inputs, &mut self.sums.numbers);
        self.sums.add(backend, self.n_free);
        for pass in &self.passes {
            pass.energies(backend, q, &mut self.sums.numbers);
            self.sums.add(backend, pass.len());
        }
        if let Some(contacts) = &self.motion.contacts {
            contacts.add_energy(backend, Resists::Vertex, 1.0, q, &mut self.sums);
        }
    }

    /// What was added up; not a number where the device fails, which is a rise to the safeguard.
    fn total(&mut self, backend: &B) -> f64 {
        self.sums.total(backend).unwrap_or_else(|error| {
            self.failed = Some(failure(error));
            f64::NAN
        })
    }

    fn mean_root(&mut self, backend: &B) -> f64 {
        (self.total(backend) / f64::from(self.n_free.max(1))).sqrt()
    }
}

/// The classes of a layout. Particle numbers have 32 bits.
fn ranges<B: Backend>(backend: &B, layout: &Layout) -> Vec<B::List> {
    #[expect(clippy::cast_possible_truncation, reason = "particles, which are counted in 32 bits")]
    let range = |class: &std::ops::Range<usize>| backend.range(class.start as u32..class.end as u32);
    layout.classes.iter().map(range).collect()
}

impl<B: Backend + 'static> Solve<B> for Frame<B> {
    fn n_colors(&self) -> usize {
        self.recolor.as_ref().map_or(self.colors.len(), Recolor::n_colors)
    }

    fn set_recoloring(&mut self, backend: &B, recoloring: Option<Vivace>) -> Result<(), SolverError> {
        let of = |options| Recolor::new(backend, &self.rows_on_host, &self.layout, options);
        self.recolor = recoloring.map(of).transpose()?;
        self.colors = ranges(backend, &self.layout);
        Ok(())
    }

    fn begin_frame(&mut self, backend: &B) {
        self.motion.begin_frame(backend);
        if let Some(recolor) = &mut self.recolor {
            // What they hold goes to those that come.
            self.colors.clear();
            self.colors = recolor.next(backend);
        }
    }

    fn positions(&self) -> (&B::Buffer<Vec4>, &[u32]) {
        (&self.motion.q, &self.layout.place)
    }

    fn n_passes(&self) -> usize {
        self.passes.len()
    }

    fn n_sweeps(&self) -> u32 {
        if let Local::Split { sweeps } = self.local { sweeps.max(1) } else { 1 }
    }

    fn set_attachment_target(&mut self, idx: usize, target: Vec3) {
        if let Some(attachment) = self.attachments.get_mut(idx) {
            attachment.1 = target.into();
            self.are_targets_new = true;
        }
    }

    fn set_attachments(&mut self, model: &Model) -> bool {
        self.attachments = attachments(model, &self.layout);
        self.h = 0.0;
        true
    }

    /// The parameters of a time step `h` \[s\]: inertia and diagonal.
    fn prepare(&mut self, backend: &B, h: f32) -> Result<(), SolverError> {
        if self.h != h {
            self.h = 0.0;
            let (weights, inverse) = (&mut self.anchor_weights, &mut self.inverse_diagonal);
            weigh(h, &self.masses, &self.attachments, &self.rows_on_host, &self.layout, (weights, inverse))?;
            self.rows.set_inverse_diagonal(backend, &self.inverse_diagonal);
            #[cfg(feature = "direct")]
            if let Some(Linear::Direct(direct)) = &mut self.linear {
                direct.factor(backend, &self.rows_on_host, &self.anchor_weights)?;
            }
            let anchors: Vec<Vec4> = self.anchor_weights.iter().map(|&w| Vec3::ZERO.extend(w)).collect();
            backend.write(&mut self.anchors.own, &anchors);
            self.h = h;
            self.are_targets_new = true;
            if let Some(contacts) = &mut self.motion.contacts {
                // As on the host: blocks and linear solvers resist along a normal with little more than inertia.
                let is_scalar = self.local != Local::Blocks && self.linear.is_none();
                let inertia = || self.anchor_weights.iter().map(|weight| 1.0 / weight).collect();
                let mobility = if is_scalar { self.inverse_diagonal.clone() } else { inertia() };
                contacts.set_mobility(backend, Resists::Vertex, mobility);
                contacts.set_mobility(backend, Resists::Inertia, inertia());
            }
        }
        if std::mem::take(&mut self.are_targets_new) {
            let holds = self.holds();
            backend.write(&mut self.holds, &holds);
        }
        Ok(())
    }

    fn load(&mut self, backend: &B, state: &State) {
        self.failed = None;
        self.motion.load(backend, &self.layout, state);
    }

    fn predict(&mut self, backend: &B, model: &Model, forces: &Forces, h: f32) {
        self.motion.predict(backend, model, &self.layout, forces, h);
    }

    fn place(&mut self, backend: &B, pins: &[(u32, Vec3)]) {
        self.motion.place(backend, &self.layout, pins);
    }

    fn set_collisions(&mut self, backend: &B, detector: Option<&Detector>) -> Result<(), SolverError> {
        self.motion.set_collisions(backend, &self.layout, detector)?;
        self.anchors.shifted = detector.map(|_| Shifted::new(backend, self.n_free));
        // Contacts have to be told what vertices resist with.
        self.h = 0.0;
        self.fit_sums(backend);
        Ok(())
    }

    fn motion(&mut self) -> (&mut Motion<B>, &mut Sums<B>, &[u32]) {
        (&mut self.motion, &mut self.sums, &self.groups)
    }

    fn meet(&mut self, backend: &B) {
        self.relax_apart(backend, Resists::Inertia);
    }

    fn touch(&mut self, backend: &B) {
        self.relax_apart(backend, Resists::Vertex);
    }

    /// Makes anchors of what was predicted.
    fn begin(&mut self, backend: &B, _: f32) {
        let inputs = (backend.view(&self.motion.q), backend.view(&self.holds));
        let Anchors { own, shifted } = &mut self.anchors;
        backend.map::<Anchor>(&self.free, &(), inputs, own);
        if let Some(Shifted { anchors, .. }) = shifted {
            backend.map::<CopyVector>(&self.free, &(), (backend.view(own),), anchors);
        }
        self.motion.contacts.iter_mut().for_each(|contacts| contacts.begin(backend));
        // All other relaxations remember before they extrapolate.
        if self.has_previous_in_place {
            self.history.begin(backend, &self.motion.q);
        }
    }

    fn store(&mut self, backend: &B, model: &Model, state: &mut State) -> Result<(), SolverError> {
        self.failed.take().map_or(Ok(()), Err)?;
        self.motion.store(backend, model, &self.layout, state)
    }

    fn project(&mut self, backend: &B) {
        if !matches!(self.local, Local::Split { .. }) {
            return;
        }
        let (rows, q) = (&self.rows, &self.motion.q);
        let (of_rows, taps) = (backend.view(&rows.rows), backend.view(&rows.taps));
        let inputs = (of_rows, taps, backend.view(&rows.pulls), backend.view(q));
        backend.map::<SpringPull>(&self.free, &(), inputs, &mut self.pulls);
        for pass in &mut self.passes {
            pass.project(backend, q);
            pass.pull_projected(backend, &self.free, &mut self.pulls);
        }
    }

    fn relax_color(&mut self, backend: &B, color: usize, omega: f32) {
        let (rows, q) = (&self.rows, &mut self.motion.q);
        let (of_rows, taps) = (backend.view(&rows.rows), backend.view(&rows.taps));
        let (anchors, list) = (backend.view(self.anchors.seen()), &self.colors[color]);
        let known = &Omega { omega };
        let params = self.watch.sweep(known);
        match self.local {
            Local::Split { .. } => {
                let inputs = (of_rows, taps, anchors, backend.view(&self.pulls));
                backend.update::<RelaxLinear>(list, params, inputs, q);
            }
            Local::Fused if self.passes.is_empty() => {
                let inputs = (of_rows, taps, backend.view(&rows.pulls), anchors);
                backend.update::<RelaxFused>(list, params, inputs, q);
            }
            Local::Fused | Local::Blocks => {
                let list = list.clone();
                self.relax_together(backend, &list, omega);
            }
        }
    }

    fn relax_color_from_previous(&mut self, backend: &B, color: usize, omega: f32) {
        let list = self.colors[color].clone();
        backend.map::<CopyVector>(&list, &(), (backend.view(&self.motion.q),), &mut self.latest);
        self.relax_color(backend, color, 1.0);
        let weight = &ExtrapolateUniform { omega };
        let weight = self.watch.extrapolation(weight);
        self.history.extrapolate_some(backend, &list, &mut self.motion.q, weight);
        self.history.set_previous(backend, &list, &self.latest);
    }

    fn relax_all(&mut self, backend: &B, omega: f32) {
        let free = self.free.clone();
        self.relax_together(backend, &free, omega);
    }

    fn moved(&mut self, backend: &B) -> f32 {
        let inputs = (backend.view(&self.motion.q), backend.view(self.history.before()));
        backend.map::<SquaredDistance>(&self.free, &(), inputs, &mut self.sums.numbers);
        self.sums.add(backend, self.n_free);
        #[expect(clippy::cast_possible_truncation, reason = "positions are f32")]
        let moved = self.mean_root(backend) as f32;
        moved
    }

    fn objective(&mut self, backend: &B) -> f64 {
        self.add_objective(backend);
        self.total(backend)
    }

    fn residual(&mut self, backend: &B) -> f64 {
        let free = self.free.clone();
        self.fused_residuals(backend, &free);
        let residuals = (backend.view(&self.residuals),);
        backend.map::<SquaredLength>(&free, &(), residuals, &mut self.sums.numbers);
        self.sums.add(backend, self.n_free);
        self.mean_root(backend)
    }

    fn wait(&mut self, backend: &B) {
        let mut first = [Vec4::ZERO];
        let n = first.len().min(self.n_free as usize);
        if let Err(error) = backend.fetch(&self.residuals, &mut first[..n]) {
            self.failed = Some(failure(error));
        }
    }

    fn update_velocities(&mut self, backend: &B, forces: &Forces, h: f32) {
        self.motion.update_velocities(backend, forces, h);
    }

    fn solve_by_conjugate_gradient(&mut self, backend: &B, preconditioner: Preconditioner, inner: u32) {
        let free = self.free.clone();
        self.linear_residuals(backend, &free);
        if let Some(Linear::ConjugateGradient(solver)) = &mut self.linear {
            let system = (&self.rows, self.anchors.seen(), &*self.colors);
            let (residuals, q) = (&mut self.residuals, &mut self.motion.q);
            solver.solve(backend, system, preconditioner, inner, residuals, q);
        }
    }

    #[cfg(feature = "direct")]
    fn solve_directly(&mut self, backend: &B) {
        let free = self.free.clone();
        self.linear_residuals(backend, &free);
        if let Some(Linear::Direct(direct)) = &mut self.linear {
            direct.solve(backend, &self.residuals, &mut self.motion.q);
        }
    }

    // `check` lets it come to Position Based Dynamics alone.
    fn relax_in_order(&mut self, _: &B, _: f32) {}

    fn remember(&mut self, backend: &B) {
        self.history.remember(backend, &self.motion.q);
    }

    fn extrapolate(&mut self, backend: &B, omega: f32) {
        let weight = &ExtrapolateUniform { omega };
        self.history.extrapolate(backend, &mut self.motion.q, self.watch.extrapolation(weight));
    }

    fn tolerated_rise(&self) -> f64 {
        TOLERATED_RISE
    }

    fn save(&mut self, backend: &B) {
        self.history.save(backend, &self.motion.q);
        self.motion.contacts.iter_mut().for_each(|contacts| contacts.save(backend));
        self.anchors.shifted.iter_mut().for_each(|shifted| shifted.history.save(backend, &shifted.anchors));
    }

    fn restore(&mut self, backend: &B) {
        self.history.restore(backend, &mut self.motion.q);
        self.motion.contacts.iter_mut().for_each(|contacts| contacts.restore(backend));
        self.anchors
            .shifted
            .iter_mut()
            .for_each(|shifted| shifted.history.restore(backend, &mut shifted.anchors));
    }

    fn watch(&mut self, backend: &B, of: (Relaxation, u32), ease: Ease, rounding: f64) {
        self.watch.begin(backend, of, ease, rounding, 0.0, |omega| Omega { omega });
        self.look(backend, 0, false);
        self.meet(backend);
        self.save(backend);
    }

    fn turn(&mut self, k: u32) {
        self.watch.turn(k);
    }

    fn look(&mut self, backend: &B, k: u32, is_last: bool) {
        self.add_objective(backend);
        let rise = self.tolerated_rise();
        self.watch.look(backend, &mut self.sums, k, is_last, rise);
        if k > 0 {
            self.history.follow(backend, self.watch.known(), &mut self.motion.q);
            let known = self.watch.known();
            self.motion.contacts.iter_mut().for_each(|contacts| contacts.follow(backend, known));
            if let Some(Shifted { anchors, history, .. }) = &mut self.anchors.shifted {
                history.follow(backend, known, anchors);
            }
        }
    }

    fn learn(&mut self, backend: &B, ease: &mut Ease, report: &mut StepReport) {
        if let Err(error) = self.watch.learn(backend, ease, report) {
            self.failed = Some(failure(error));
        }
    }

    fn forget(&mut self) {
        self.watch.forget();
    }
}
