//! What moves, on a device: lines 1 and 9 of Algorithm 1.

use glam::{Vec3, Vec4};
use vivace_collision::{Detector, Obstacle};
use vivace_kernels::Backend;
use vivace_kernels::step::{
    Blow, BlowUniform, Place, Predict, PredictUniform, SetVector, SetVectorUniform, UpdateVelocity,
    UpdateVelocityUniform,
};
use vivace_model::{Forces, Model, State, Wind};

use super::collide::{Collider, Resists};
use super::failure;
use super::sums::Sums;
use crate::host::check_end;
use crate::pd::layout::Layout;
use crate::{ContactReport, SolverError};

/// Positions, with the inverse mass \[1/kg\], and velocities; what they collide with.
pub(super) struct Motion<B: Backend> {
    all: B::List,
    /// The latest positions \[m\].
    pub(super) q: B::Buffer<Vec4>,
    /// Those at the start of the (small) step \[m\].
    pub(super) before: B::Buffer<Vec4>,
    /// Contacts, if there may be any.
    pub(super) contacts: Option<Collider<B>>,
    velocities: B::Buffer<Vec4>,
    accelerations: B::Buffer<Vec4>,
    /// What `accelerations` are everywhere, if they are.
    gravity: Option<Vec3>,
    /// The triangles at each particle: made when wind first blows.
    surface: Option<Surface<B>>,
    /// Where pinned particles go, and 1; 0 where they stay. Made when one first goes.
    places: Option<B::Buffer<Vec4>>,
    pub(super) inverse_masses: Vec<f32>,
    /// What the host has handed out last, and whether the device still has it.
    stored: State,
    is_stored: bool,
    /// Whether `q`, and not `before`, is where the next (small) step begins.
    has_ended: bool,
    on_host: [Vec<Vec4>; 2],
}

/// The corners of the triangles at each particle.
struct Surface<B: Backend> {
    offsets: B::Buffer<u32>,
    corners: B::Buffer<[u32; 3]>,
}

impl<B: Backend> Motion<B> {
    /// Of the particles of a model.
    pub(super) fn new(backend: &B, model: &Model, layout: &Layout, n: u32) -> Self {
        let zeros = || backend.filled(n as usize, Vec4::ZERO);
        let inverse_mass = |&particle: &u32| 1.0 / model.masses()[particle as usize];
        let nowhere = || vec![Vec3::NAN; n as usize];
        Self {
            all: backend.range(0..n),
            q: zeros(),
            before: zeros(),
            contacts: None,
            velocities: zeros(),
            accelerations: zeros(),
            gravity: Some(Vec3::ZERO),
            surface: None,
            places: None,
            inverse_masses: layout.order.iter().map(inverse_mass).collect(),
            stored: State { positions: nowhere(), velocities: nowhere() },
            is_stored: false,
            has_ended: false,
            on_host: [(); 2].map(|()| vec![Vec4::ZERO; n as usize]),
        }
    }

    /// Begins with `state`, which is written if it is not what was stored last.
    pub(super) fn load(&mut self, backend: &B, layout: &Layout, state: &State) {
        if std::mem::take(&mut self.is_stored) && *state == self.stored {
            return;
        }
        let [q, v] = &mut self.on_host;
        for (slot, &particle) in layout.order.iter().enumerate() {
            q[slot] = state.positions[particle as usize].extend(self.inverse_masses[slot]);
            v[slot] = state.velocities[particle as usize].extend(0.0);
        }
        backend.write(&mut self.before, q);
        backend.write(&mut self.velocities, v);
        self.has_ended = false;
    }

    /// Line 1: `q⁰ = q + h v + h² M⁻¹ f`.
    pub(super) fn predict(&mut self, backend: &B, model: &Model, layout: &Layout, forces: &Forces, h: f32) {
        if std::mem::take(&mut self.has_ended) {
            std::mem::swap(&mut self.before, &mut self.q);
        }
        self.accelerate(backend, model, layout, forces, h);
        let accelerations = backend.view(&self.accelerations);
        let inputs = (backend.view(&self.before), backend.view(&self.velocities), accelerations);
        backend.map::<Predict>(&self.all, &PredictUniform { h }, inputs, &mut self.q);
    }

    /// Puts pinned particles elsewhere.
    pub(super) fn place(&mut self, backend: &B, layout: &Layout, pins: &[(u32, Vec3)]) {
        let [on_host, _] = &mut self.on_host;
        on_host.fill(Vec4::ZERO);
        for &(particle, at) in pins {
            on_host[layout.place[particle as usize] as usize] = at.extend(1.0);
        }
        let places = self.places.get_or_insert_with(|| backend.filled(on_host.len(), Vec4::ZERO));
        backend.write(places, on_host);
        backend.update::<Place>(&self.all, &(), (backend.view(places),), &mut self.q);
    }

    fn accelerate(&mut self, backend: &B, model: &Model, layout: &Layout, forces: &Forces, h: f32) {
        let gravity = forces.gravity;
        if let Some(Wind { velocity, drag }) = forces.wind {
            let surface = self.surface.get_or_insert_with(|| Surface::new(backend, model, layout));
            let (offsets, corners) = (backend.view(&surface.offsets), backend.view(&surface.corners));
            let inputs = (offsets, corners, backend.view(&self.before), backend.view(&self.velocities));
            let uniform = BlowUniform {
                gravity,
                h,
                velocity,
                sixth_of_drag: drag / 6.0,
                skin: Wind::SKIN,
                padding: [0; 3],
            };
            backend.map::<Blow>(&self.all, &uniform, inputs, &mut self.accelerations);
            self.gravity = None;
        } else if self.gravity != Some(gravity) {
            let uniform = SetVectorUniform { value: gravity.extend(0.0) };
            backend.map::<SetVector>(&self.all, &uniform, (), &mut self.accelerations);
            self.gravity = Some(gravity);
        }
    }

    /// Line 9: `v = (q' − q) / h`, damped.
    pub(super) fn update_velocities(&mut self, backend: &B, forces: &Forces, h: f32) {
        let scale = (-forces.damping * h).exp() / h;
        let inputs = (backend.view(&self.q), backend.view(&self.before));
        let uniform = UpdateVelocityUniform { scale };
        backend.map::<UpdateVelocity>(&self.all, &uniform, inputs, &mut self.velocities);
        self.has_ended = true;
        self.is_stored = false;
    }

    /// Lets it collide, or no more.
    pub(super) fn set_collisions(
        &mut self,
        backend: &B,
        layout: &Layout,
        detector: Option<&Detector>,
    ) -> Result<(), SolverError> {
        let of = |detector| Collider::new(backend, detector, &layout.place, &self.inverse_masses);
        self.contacts = detector.map(of).transpose()?;
        Ok(())
    }

    /// A frame begins: what contacts do in it is counted anew.
    pub(super) fn begin_frame(&mut self, backend: &B) {
        self.contacts.iter_mut().for_each(|contacts| contacts.clear_counts(backend));
    }

    /// Finds the contacts of a (small) step, whose end has been predicted; whether there are other obstacles than before.
    pub(super) fn detect(&mut self, backend: &B, obstacles: &[Obstacle]) -> Result<bool, SolverError> {
        let Self { contacts, before, q, .. } = self;
        contacts.as_mut().map_or(Ok(false), |contacts| contacts.detect(backend, before, q, obstacles))
    }

    /// Forgets contacts, until there are others.
    pub(super) fn drop_contacts(&mut self, backend: &B) {
        self.contacts.iter_mut().for_each(|contacts| contacts.drop_contacts(backend));
    }

    /// Projects all contacts.
    pub(super) fn relax_contacts(&mut self, backend: &B, resists: Resists) {
        if let Some(contacts) = &mut self.contacts {
            contacts.relax(backend, resists, &mut self.q);
        }
    }

    /// Holds back what passes through something on its way from the start of the (small) step to where it has come.
    pub(super) fn guard(&mut self, backend: &B) {
        let Self { contacts, before, q, .. } = self;
        contacts.iter_mut().for_each(|contacts| contacts.guard(backend, before, q));
    }

    /// What contacts did in the step; whether some found no room, and there is more now.
    pub(super) fn report_contacts(
        &mut self,
        backend: &B,
        sums: &mut Sums<B>,
        report: &mut ContactReport,
    ) -> Result<bool, SolverError> {
        let Some(contacts) = &mut self.contacts else { return Ok(false) };
        *report = contacts.report(backend, &self.q, sums).map_err(failure)?;
        contacts.grow(backend)
    }

    /// Reads back where the frame has ended.
    pub(super) fn store(
        &mut self,
        backend: &B,
        model: &Model,
        layout: &Layout,
        state: &mut State,
    ) -> Result<(), SolverError> {
        let [q, v] = &mut self.on_host;
        let fetched = backend.fetch(&self.q, q).and_then(|()| backend.fetch(&self.velocities, v));
        fetched.map_err(failure)?;
        for (slot, &particle) in layout.order.iter().enumerate() {
            self.stored.positions[particle as usize] = q[slot].truncate();
            self.stored.velocities[particle as usize] = v[slot].truncate();
        }
        check_end(model, &self.stored.positions, &self.stored.velocities)?;
        state.clone_from(&self.stored);
        self.is_stored = true;
        Ok(())
    }
}

impl<B: Backend> Surface<B> {
    fn new(backend: &B, model: &Model, layout: &Layout) -> Self {
        let mut at = vec![Vec::new(); model.n_particles()];
        for &triangle in model.surface() {
            let corners = layout.places(triangle);
            corners.iter().for_each(|&particle| at[particle as usize].push(corners));
        }
        let mut offsets = vec![0];
        // Three for each triangle, and triangles are numbered in 32 bits.
        offsets.extend(at.iter().scan(0_u32, |end, corners| {
            *end += u32::try_from(corners.len()).unwrap_or(u32::MAX);
            Some(*end)
        }));
        Self { offsets: backend.upload(&offsets), corners: backend.upload(&at.concat()) }
    }
}
