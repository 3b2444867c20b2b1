//! The safeguard where nobody waits for its decisions: see `crate::safeguard`, of which this is the twin.

use bytemuck::Zeroable;
use vivace_kernels::step::{
    Decide, DecideUniform, ExtrapolateUniform, PickWeight, PickWeightUniform, Watch as Known, Weight,
};
use vivace_kernels::{Backend, PARAMS_BYTES, Params};

use super::sums::Sums;
use crate::relaxation::Weights;
use crate::safeguard::LONGEST;
use crate::step::{LARGEST, RECOVERY};
use crate::{Ease, Relaxation, StepReport};

/// What the device knows and decides. `U` is what a sweep takes of the weights.
pub(super) struct Watch<B: Backend, U: Weight> {
    one: B::List,
    known: B::Buffer<Known>,
    /// The weights of each iteration since acceleration began, for each level; how many iterations, and what they are of.
    sweeps: Table<B, U>,
    extrapolations: Table<B, ExtrapolateUniform>,
    n: usize,
    of: Option<(Relaxation, f32, Option<f32>)>,
    /// What the host thinks that the device knows; `None` if it has changed its mind.
    ease: Option<Ease>,
    /// Whether the device knows more than the host.
    is_ahead: bool,
    n_backoffs: u32,
    /// What roundings may add to the objective \[J\].
    rounding: f32,
    /// Iterations at the last look, and at the present; `None` while the host decides.
    turn: Option<[u32; 2]>,
}

/// A table of weights, and those picked until the next look.
struct Table<B: Backend, U: Weight> {
    all: B::Buffer<U>,
    picked: B::Buffer<U>,
    list: B::List,
}

impl<B: Backend, U: Weight> Table<B, U> {
    /// Elements from iteration to iteration.
    const STRIDE: usize = PARAMS_BYTES / size_of::<U>();

    fn new(backend: &B) -> Self {
        let len = LONGEST as usize * Self::STRIDE;
        let end = u32::try_from(len).unwrap_or_else(|_| unreachable!("a thousand or so"));
        Self {
            all: backend.filled(0, U::zeroed()),
            picked: backend.filled(len, U::zeroed()),
            list: backend.range(0..end),
        }
    }

    fn pick(&mut self, backend: &B, known: &B::Buffer<Known>, k: u32, n: usize) {
        let [stride, n] = [Self::STRIDE, n].map(|n| u32::try_from(n).unwrap_or(u32::MAX));
        let inputs = (backend.view(known), backend.view(&self.all));
        backend.map::<PickWeight<U>>(
            &self.list,
            &PickWeightUniform { k, stride, n },
            inputs,
            &mut self.picked,
        );
    }

    fn at(&self, slot: u32) -> Params<'_, B, U> {
        Params::Found(&self.picked, slot as usize * Self::STRIDE)
    }
}

impl<B: Backend, U: Weight> Watch<B, U> {
    pub(super) fn new(backend: &B) -> Self {
        Self {
            one: backend.range(0..1),
            known: backend.filled(1, Known::zeroed()),
            sweeps: Table::new(backend),
            extrapolations: Table::new(backend),
            n: 0,
            of: None,
            ease: Some(Ease::default()),
            is_ahead: false,
            n_backoffs: 0,
            rounding: 0.0,
            turn: None,
        }
    }

    /// What the safeguard knows, for those who do as it says.
    pub(super) fn known(&self) -> &B::Buffer<Known> {
        &self.known
    }

    /// A small step of `most` iterations begins, whose weights `sweep` makes parameters of.
    pub(super) fn begin(
        &mut self,
        backend: &B,
        (relaxation, most): (Relaxation, u32),
        ease: Ease,
        rounding: f64,
        squared_h: f32,
        sweep: impl Fn(f32) -> U,
    ) {
        #[expect(clippy::cast_possible_truncation, reason = "a small number")]
        let rounding = rounding as f32;
        self.rounding = rounding;
        let n = self.n.max(most as usize);
        let of = Some((relaxation, squared_h, ease.rho()));
        if self.of != of || n > self.n {
            (self.of, self.n) = (of, n);
            let (mut sweeps, mut extrapolations) = (Vec::new(), Vec::new());
            for level in 0..=LARGEST {
                for weights in Weights::of(relaxation, ease.at([level, 0]), n) {
                    sweeps.push(sweep(weights.sweep));
                    extrapolations.push(ExtrapolateUniform { omega: weights.extrapolation });
                }
            }
            self.sweeps.all = backend.upload(&sweeps);
            self.extrapolations.all = backend.upload(&extrapolations);
        }
        if !self.is_ahead && self.ease != Some(ease) {
            let n_backoffs = self.n_backoffs;
            let [level, quiet_steps] = ease.parts();
            let known = Known { level, quiet_steps, n_backoffs, ..Known::zeroed() };
            backend.write(&mut self.known, &[known]);
        }
        self.is_ahead = true;
    }

    /// Looks after iteration `k`, the objective having been added up.
    pub(super) fn look(
        &mut self,
        backend: &B,
        sums: &mut Sums<B>,
        k: u32,
        is_last: bool,
        tolerated_rise: f64,
    ) {
        let (sums, n_sums) = sums.fold(backend);
        #[expect(clippy::cast_possible_truncation, reason = "a small number")]
        let tolerated_rise = tolerated_rise as f32;
        let uniform = DecideUniform {
            n_sums,
            k,
            is_last: is_last.into(),
            tolerated_rise,
            most: LARGEST,
            recovery: RECOVERY,
            rounding: self.rounding,
        };
        backend.map::<Decide>(&self.one, &uniform, (backend.view(sums),), &mut self.known);
        self.turn = (!is_last).then_some([k, k]);
        if !is_last {
            self.sweeps.pick(backend, &self.known, k, self.n);
            self.extrapolations.pick(backend, &self.known, k, self.n);
        }
    }

    /// Iteration `k` begins, from 0.
    pub(super) fn turn(&mut self, k: u32) {
        if let Some([_, now]) = &mut self.turn {
            *now = k;
        }
    }

    fn slot(&self) -> Option<u32> {
        self.turn.map(|[look, now]| now - look)
    }

    /// What a sweep takes in place of `known`.
    pub(super) fn sweep<'a>(&'a self, known: &'a U) -> Params<'a, B, U> {
        self.slot().map_or(known.into(), |slot| self.sweeps.at(slot))
    }

    /// What an extrapolation takes in place of `known`.
    pub(super) fn extrapolation<'a>(
        &'a self,
        known: &'a ExtrapolateUniform,
    ) -> Params<'a, B, ExtrapolateUniform> {
        self.slot().map_or(known.into(), |slot| self.extrapolations.at(slot))
    }

    /// Tells the host what the device has decided since it was last asked.
    pub(super) fn learn(
        &mut self,
        backend: &B,
        ease: &mut Ease,
        report: &mut StepReport,
    ) -> Result<(), B::Error> {
        if self.is_ahead {
            let mut known = [Known::zeroed()];
            backend.fetch(&self.known, &mut known)?;
            let [known] = known;
            *ease = ease.at([known.level, known.quiet_steps]);
            report.backoffs += known.n_backoffs.wrapping_sub(self.n_backoffs);
            report.objective = report.objective.or(Some(known.kept.into()));
            (self.ease, self.n_backoffs, self.is_ahead) = (Some(*ease), known.n_backoffs, false);
        }
        Ok(())
    }

    /// The host decides what is known.
    pub(super) fn forget(&mut self) {
        (self.ease, self.is_ahead, self.turn) = (None, false, None);
    }
}
