//! Earlier positions on a device: see `crate::history`, of which this is the twin.

use glam::Vec4;
use vivace_kernels::step::{
    CopyVector, CopyVectorWhere, CopyVectorWhereUniform, Extrapolate, ExtrapolateUniform, Watch,
};
use vivace_kernels::{Backend, Params};

/// Earlier positions.
pub(super) struct History<B: Backend> {
    all: B::List,
    free: B::List,
    /// As of the last [`History::remember`], and an iteration before that.
    remembered: B::Buffer<Vec4>,
    previous: B::Buffer<Vec4>,
    saved: B::Buffer<Vec4>,
    is_extrapolated: bool,
}

impl<B: Backend> History<B> {
    /// Of `n` particles, `n_free` of which move.
    pub(super) fn new(backend: &B, n: u32, n_free: u32) -> Self {
        let zeros = || backend.filled(n as usize, Vec4::ZERO);
        Self {
            all: backend.range(0..n),
            free: backend.range(0..n_free),
            remembered: zeros(),
            previous: zeros(),
            saved: zeros(),
            is_extrapolated: false,
        }
    }

    pub(super) fn begin(&mut self, backend: &B, q: &B::Buffer<Vec4>) {
        backend.map::<CopyVector>(&self.all, &(), (backend.view(q),), &mut self.previous);
        self.is_extrapolated = false;
    }

    pub(super) fn remember(&mut self, backend: &B, q: &B::Buffer<Vec4>) {
        backend.map::<CopyVector>(&self.all, &(), (backend.view(q),), &mut self.remembered);
        self.is_extrapolated = false;
    }

    pub(super) fn extrapolate(
        &mut self,
        backend: &B,
        q: &mut B::Buffer<Vec4>,
        weight: Params<'_, B, ExtrapolateUniform>,
    ) {
        if !matches!(weight, Params::Known(&ExtrapolateUniform { omega: 1.0 })) {
            self.extrapolate_some(backend, &self.free, q, weight);
        }
        std::mem::swap(&mut self.previous, &mut self.remembered);
        self.is_extrapolated = true;
    }

    /// `previous + omega · (q − previous)` of some particles.
    pub(super) fn extrapolate_some(
        &self,
        backend: &B,
        list: &B::List,
        q: &mut B::Buffer<Vec4>,
        weight: Params<'_, B, ExtrapolateUniform>,
    ) {
        backend.map::<Extrapolate>(list, weight, (backend.view(&self.previous),), q);
    }

    /// Sets the previous positions of some particles.
    pub(super) fn set_previous(&mut self, backend: &B, list: &B::List, q: &B::Buffer<Vec4>) {
        backend.map::<CopyVector>(list, &(), (backend.view(q),), &mut self.previous);
    }

    /// What the last [`History::remember`] saw.
    pub(super) fn before(&self) -> &B::Buffer<Vec4> {
        if self.is_extrapolated { &self.previous } else { &self.remembered }
    }

    pub(super) fn save(&mut self, backend: &B, q: &B::Buffer<Vec4>) {
        backend.map::<CopyVector>(&self.all, &(), (backend.view(q),), &mut self.saved);
    }

    pub(super) fn restore(&mut self, backend: &B, q: &mut B::Buffer<Vec4>) {
        backend.map::<CopyVector>(&self.all, &(), (backend.view(&self.saved),), q);
        backend.map::<CopyVector>(&self.all, &(), (backend.view(&self.saved),), &mut self.previous);
        self.is_extrapolated = false;
    }

    /// Saves or restores, as the last look has decided.
    pub(super) fn follow(&mut self, backend: &B, watch: &B::Buffer<Watch>, q: &mut B::Buffer<Vec4>) {
        let Self { all, saved, previous, .. } = self;
        let inputs = (backend.view(watch), backend.view(q));
        backend.map::<CopyVectorWhere>(all, &CopyVectorWhereUniform { is_back: 0 }, inputs, saved);
        for to in [q, previous] {
            let inputs = (backend.view(watch), backend.view(saved));
            backend.map::<CopyVectorWhere>(all, &CopyVectorWhereUniform { is_back: 1 }, inputs, to);
        }
    }
}
