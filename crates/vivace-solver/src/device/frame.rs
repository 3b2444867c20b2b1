//! The stages of Projective Dynamics as runs of kernels: see `pd/mod.rs`, of which this is the twin.

use glam::{Vec3, Vec3A, Vec4};
use vivace_collision::Obstacle;
use vivace_kernels::Backend;
use vivace_kernels::pd::{
    Anchor, FusedResidual, LinearResidual, MoveByBlock, MoveByDiagonal, Omega, RelaxFused, RelaxLinear,
    RowEnergy, SpringBlock, SpringPull,
};
use vivace_kernels::step::{CopyVector, SquaredDistance, SquaredLength};
use vivace_model::{Forces, Model, State};

use super::Solve;
use super::collide::Collider;
use super::history::History;
use super::motion::Motion;
use super::pass::{Pass, Passes};
use super::rows::DeviceRows;
use super::sums::Sums;
use crate::collisions::Collisions;
use crate::contacts::STIFFNESS;
use crate::error::narrow;
use crate::pd::layout::Layout;
use crate::pd::rows::Rows;
use crate::pd::{attachments, masses, weigh};
use crate::stages::TOLERATED_RISE;
use crate::{Base, ContactReport, Framework, LocalStep, Relaxation, Solver, SolverError, VertexSolve};

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
    anchors: B::Buffer<Vec4>,
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
    contacts: Option<Collider<B>>,
    /// The anchors as contacts push them; none where there are no contacts.
    pushed: Option<B::Buffer<Vec4>>,
    /// What the device could not do in this frame.
    failed: Option<SolverError>,
}

impl<B: Backend + 'static> Frame<B> {
    /// Colors the model's graph, lays out the rows of Y, and takes all memory.
    pub(super) fn new(backend: &B, model: &Model, solver: &Solver) -> Result<Self, SolverError> {
        let local = match solver.framework {
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
        let layout = Layout::new(model, &graph);
        let rows_on_host = Rows::new(model, &graph, &layout);
        let rows = DeviceRows::new(backend, &rows_on_host);
        let passes = Passes::of(backend, model, &layout)?;
        let (n, n_free) = (narrow("particles", model.n_particles())?, narrow("particles", layout.n_free)?);
        // Particle numbers have 32 bits.
        #[expect(clippy::cast_possible_truncation, reason = "below n, which is narrow")]
        let color = |class: &std::ops::Range<usize>| backend.range(class.start as u32..class.end as u32);
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
            colors: layout.classes.iter().map(color).collect(),
            free: backend.range(0..n_free),
            n_free,
            attachments: attachments(model, &layout),
            are_targets_new: true,
            masses: masses(model, &layout),
            h: 0.0,
            anchor_weights: vec![0.0; layout.n_free],
            inverse_diagonal: vec![0.0; layout.n_free],
            holds: vectors(true),
            anchors: vectors(true),
            motion: Motion::new(backend, model, &layout, n),
            history: History::new(backend, n, n_free),
            pulls: vectors(is_split),
            residuals: vectors(true),
            blocks: backend.filled(n_blocks, [Vec4::ZERO; 2]),
            latest: vectors(has_previous_in_place),
            sums: Sums::new(backend, &groups),
            groups,
            contacts: None,
            pushed: None,
            failed: None,
            passes,
            layout,
        };
        frame.check(backend)?;
        Ok(frame)
    }

    /// Whether the device holds the larger arrays.
    fn check(&self, backend: &B) -> Result<(), SolverError> {
        let device = |error: B::Error| SolverError::Device(Box::new(error));
        backend.fetch(&self.rows.springs, &mut []).map_err(device)?;
        backend.fetch(&self.rows.taps, &mut []).map_err(device)?;
        backend.fetch(&self.motion.q, &mut []).map_err(device)
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
        let q = &mut self.motion.q;
        if self.local == Local::Blocks {
            let inputs = (rows, residuals, backend.view(&self.blocks));
            backend.map::<MoveByBlock>(list, &Omega { omega }, inputs, q);
        } else {
            backend.map::<MoveByDiagonal>(list, &Omega { omega }, (rows, residuals), q);
        }
    }

    fn linear_residuals(&mut self, backend: &B, list: &B::List) {
        let (rows, taps) = (backend.view(&self.rows.rows), backend.view(&self.rows.taps));
        let anchors = self.pushed.as_ref().unwrap_or(&self.anchors);
        let (anchors, pulls) = (backend.view(anchors), backend.view(&self.pulls));
        let inputs = (rows, taps, anchors, pulls, backend.view(&self.motion.q));
        backend.map::<LinearResidual>(list, &(), inputs, &mut self.residuals);
    }

    fn fused_residuals(&mut self, backend: &B, list: &B::List) {
        let (rows, q) = (&self.rows, &self.motion.q);
        let (of_rows, taps) = (backend.view(&rows.rows), backend.view(&rows.taps));
        let anchors = self.pushed.as_ref().unwrap_or(&self.anchors);
        let (pulls, anchors) = (backend.view(&rows.pulls), backend.view(anchors));
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

    /// What was added up; not a number where the device fails, which is a rise to the safeguard.
    fn total(&mut self, backend: &B) -> f64 {
        self.sums.total(backend).unwrap_or_else(|error| {
            self.failed = Some(SolverError::Device(Box::new(error)));
            f64::NAN
        })
    }

    /// Makes room for what is added up.
    fn fit_sums(&mut self, backend: &B) {
        let groups = self.groups.iter().copied();
        let all: Vec<u32> = groups.chain(self.contacts.iter().flat_map(Collider::groups)).collect();
        self.sums = Sums::new(backend, &all);
    }

    fn mean_root(&mut self, backend: &B) -> f64 {
        (self.total(backend) / f64::from(self.n_free.max(1))).sqrt()
    }
}

impl<B: Backend + 'static> Solve<B> for Frame<B> {
    fn n_colors(&self) -> usize {
        self.colors.len()
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

    /// The parameters of a time step `h` \[s\]: inertia and diagonal.
    fn prepare(&mut self, backend: &B, h: f32) -> Result<(), SolverError> {
        if self.h != h {
            self.h = 0.0;
            let (weights, inverse) = (&mut self.anchor_weights, &mut self.inverse_diagonal);
            weigh(h, &self.masses, &self.attachments, &self.rows_on_host, &self.layout, (weights, inverse))?;
            self.rows.set_inverse_diagonal(backend, &self.inverse_diagonal);
            let anchors: Vec<Vec4> = self.anchor_weights.iter().map(|&w| Vec3::ZERO.extend(w)).collect();
            backend.write(&mut self.anchors, &anchors);
            self.h = h;
            self.are_targets_new = true;
            if let Some(contacts) = &mut self.contacts {
                contacts.set_mobility(backend, &self.inverse_diagonal);
            }
        }
        self.contacts.iter_mut().for_each(|contacts| contacts.begin_step(backend));
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

    fn set_collisions(&mut self, backend: &B, collisions: Option<&Collisions>) -> Result<(), SolverError> {
        let of = |collisions| Collider::new(backend, collisions, &self.layout.place, STIFFNESS, true);
        self.contacts = collisions.map(of).transpose()?;
        self.pushed = self.contacts.is_some().then(|| backend.filled(self.layout.n_free, Vec4::ZERO));
        // Contacts have to be told the diagonal.
        self.h = 0.0;
        self.fit_sums(backend);
        Ok(())
    }

    fn has_collisions(&self) -> bool {
        self.contacts.is_some()
    }

    fn collide(&mut self, backend: &B, obstacles: &[Obstacle]) -> Result<(), SolverError> {
        let Some(contacts) = &mut self.contacts else { return Ok(()) };
        if contacts.detect(backend, &self.motion.before, &self.motion.q, obstacles)? {
            self.fit_sums(backend);
        }
        Ok(())
    }

    fn relax_contacts(&mut self, backend: &B, omega: f32) {
        if let Some(contacts) = &mut self.contacts {
            contacts.relax(backend, omega, &mut self.motion.q, self.pushed.as_mut());
        }
    }

    fn guard(&mut self, backend: &B) {
        if let Some(contacts) = &mut self.contacts {
            contacts.guard(backend, &self.motion.before, &mut self.motion.q);
        }
    }

    fn report_contacts(&mut self, backend: &B, report: &mut ContactReport) -> Result<(), SolverError> {
        if let Some(contacts) = &mut self.contacts {
            let found = contacts.report(backend, &self.motion.q, &mut self.sums);
            *report = found.map_err(|error| SolverError::Device(Box::new(error)))?;
        }
        Ok(())
    }

    /// Makes anchors of what was predicted.
    fn begin(&mut self, backend: &B, h: f32) {
        let inputs = (backend.view(&self.motion.q), backend.view(&self.holds));
        backend.map::<Anchor>(&self.free, &(), inputs, &mut self.anchors);
        if let (Some(contacts), Some(pushed)) = (&mut self.contacts, &mut self.pushed) {
            backend.map::<CopyVector>(&self.free, &(), (backend.view(&self.anchors),), pushed);
            contacts.begin(backend, h);
        }
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
        let anchors = self.pushed.as_ref().unwrap_or(&self.anchors);
        let (anchors, list) = (backend.view(anchors), &self.colors[color]);
        match self.local {
            Local::Split { .. } => {
                let inputs = (of_rows, taps, anchors, backend.view(&self.pulls));
                backend.update::<RelaxLinear>(list, &Omega { omega }, inputs, q);
            }
            Local::Fused if self.passes.is_empty() => {
                let inputs = (of_rows, taps, backend.view(&rows.pulls), anchors);
                backend.update::<RelaxFused>(list, &Omega { omega }, inputs, q);
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
        self.history.extrapolate_some(backend, &list, &mut self.motion.q, omega);
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
        let (rows, q) = (&self.rows, &self.motion.q);
        let (of_rows, taps) = (backend.view(&rows.rows), backend.view(&rows.taps));
        let (springs, anchors) = (backend.view(&rows.springs), backend.view(&self.anchors));
        let inputs = (of_rows, taps, springs, anchors, backend.view(q));
        backend.map::<RowEnergy>(&self.free, &(), inputs, &mut self.sums.numbers);
        self.sums.add(backend, self.n_free);
        for pass in &self.passes {
            pass.energies(backend, q, &mut self.sums.numbers);
            self.sums.add(backend, pass.len());
        }
        if let Some(contacts) = &self.contacts {
            contacts.add_energy(backend, 1.0, q, &mut self.sums);
        }
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
            self.failed = Some(SolverError::Device(Box::new(error)));
        }
    }

    fn update_velocities(&mut self, backend: &B, forces: &Forces, h: f32) {
        self.motion.update_velocities(backend, forces, h);
    }

    // `check` lets it come to Position Based Dynamics alone.
    fn relax_in_order(&mut self, _: &B, _: f32) {}

    fn remember(&mut self, backend: &B) {
        self.history.remember(backend, &self.motion.q);
        self.contacts.iter_mut().for_each(|contacts| contacts.remember(backend));
    }

    fn extrapolate(&mut self, backend: &B, omega: f32) {
        self.history.extrapolate(backend, &mut self.motion.q, omega);
        self.contacts.iter_mut().for_each(|contacts| contacts.extrapolate(backend, omega));
    }

    fn tolerated_rise(&self) -> f64 {
        TOLERATED_RISE
    }

    fn save(&mut self, backend: &B) {
        self.history.save(backend, &self.motion.q);
        self.contacts.iter_mut().for_each(|contacts| contacts.save(backend));
    }

    fn restore(&mut self, backend: &B) {
        self.history.restore(backend, &mut self.motion.q);
        self.contacts.iter_mut().for_each(|contacts| contacts.restore(backend));
    }
}
