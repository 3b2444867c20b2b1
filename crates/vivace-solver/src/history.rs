//! Earlier values of what is solved for: what acceleration extrapolates from, and what the safeguard comes back to.

use std::ops::{Add, Mul, Sub};

/// Earlier values of a vector: of positions, of multipliers.
#[derive(Debug, Clone, Default)]
pub(crate) struct History<T> {
    /// As of the last [`History::remember`], and an iteration before that.
    remembered: Vec<T>,
    previous: Vec<T>,
    saved: Vec<T>,
    is_extrapolated: bool,
}

impl<T: Copy + Default + Add<Output = T> + Sub<Output = T> + Mul<f32, Output = T>> History<T> {
    pub(crate) fn new(n: usize) -> Self {
        let zeros = || vec![T::default(); n];
        Self { remembered: zeros(), previous: zeros(), saved: zeros(), is_extrapolated: false }
    }

    /// Makes room for `n`.
    pub(crate) fn fit(&mut self, n: usize) {
        for values in [&mut self.remembered, &mut self.previous, &mut self.saved] {
            values.resize(n, T::default());
        }
    }

    /// A step begins with `values`.
    pub(crate) fn begin(&mut self, values: &[T]) {
        self.previous.copy_from_slice(values);
        self.is_extrapolated = false;
    }

    /// Keeps a copy to extrapolate from.
    pub(crate) fn remember(&mut self, values: &[T]) {
        self.remembered.copy_from_slice(values);
        self.is_extrapolated = false;
    }

    /// `previous + omega · (values − previous)`; then what was remembered becomes previous.
    pub(crate) fn extrapolate(&mut self, values: &mut [T], omega: f32) {
        if omega != 1.0 {
            for (value, &previous) in values.iter_mut().zip(&self.previous) {
                *value = previous + (*value - previous) * omega;
            }
        }
        std::mem::swap(&mut self.previous, &mut self.remembered);
        self.is_extrapolated = true;
    }

    /// An iteration earlier, to be read and set by who extrapolates element by element.
    pub(crate) fn previous_mut(&mut self) -> &mut [T] {
        &mut self.previous
    }

    /// What the last [`History::remember`] saw.
    pub(crate) fn before(&self) -> &[T] {
        if self.is_extrapolated { &self.previous } else { &self.remembered }
    }

    /// Keeps a copy to come back to.
    pub(crate) fn save(&mut self, values: &[T]) {
        self.saved.copy_from_slice(values);
    }

    /// Brings back what was saved, and forgets the iterations since.
    pub(crate) fn restore(&mut self, values: &mut [T]) {
        values.copy_from_slice(&self.saved);
        self.previous.copy_from_slice(&self.saved);
        self.is_extrapolated = false;
    }
}
