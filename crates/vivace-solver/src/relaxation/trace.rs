//! What a relaxation asks of its stages, without any.

use super::Schedule;
use crate::step::Ease;
use crate::{Preconditioner, Relaxation, Stages};

/// The weights of an iteration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Weights {
    /// Of its sweeps.
    pub(crate) sweep: f32,
    /// Of its extrapolation.
    pub(crate) extrapolation: f32,
}

impl Weights {
    const PLAIN: Self = Self { sweep: 1.0, extrapolation: 1.0 };

    /// Those of the first `n` iterations under the safeguard, with acceleration eased as `ease` says. All sweeps of an iteration have
    /// the same.
    pub(crate) fn of(relaxation: Relaxation, ease: Ease, n: usize) -> impl Iterator<Item = Self> {
        let mut schedule = Schedule::new(relaxation, ease, true);
        (0..n).map(move |_| {
            let mut weights = Self::PLAIN;
            schedule.iterate(&mut weights);
            weights
        })
    }
}

impl Stages for Weights {
    fn n_colors(&self) -> u32 {
        1
    }

    fn project(&mut self) {}

    fn relax_color(&mut self, _: u32, omega: f32) {
        self.sweep = omega;
    }

    fn relax_color_from_previous(&mut self, _: u32, omega: f32) {
        self.extrapolation = omega;
    }

    fn relax_all(&mut self, omega: f32) {
        self.sweep = omega;
    }

    fn relax_in_order(&mut self, omega: f32) {
        self.sweep = omega;
    }

    fn solve_by_conjugate_gradient(&mut self, _: Preconditioner, _: u32) {}

    fn solve_directly(&mut self) {}

    fn remember(&mut self) {}

    fn extrapolate(&mut self, omega: f32) {
        self.extrapolation = omega;
    }

    fn moved(&mut self) -> f32 {
        0.0
    }

    fn objective(&mut self) -> f64 {
        0.0
    }

    fn residual(&mut self) -> f64 {
        0.0
    }

    fn save(&mut self) {}

    fn restore(&mut self) {}
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Base, Rho};

    #[test]
    fn weights_are_those_of_the_schedule() {
        let of = |relaxation, level| {
            Weights::of(relaxation, Ease::default().at([level, 0]), 7).collect::<Vec<_>>()
        };
        let sor = |base| Relaxation::GaussSeidel { omega: 1.8, base };
        let sweeps = |weights: Vec<Weights>| weights.iter().map(|w| w.sweep).collect::<Vec<_>>();
        assert_eq!(sweeps(of(sor(Base::Latest), 0)), [1.0, 1.0, 1.0, 1.0, 1.0, 1.8, 1.8]);
        assert_eq!(sweeps(of(sor(Base::Latest), 1))[5..], [1.4, 1.4]);
        let printed = of(sor(Base::PreviousInPlace), 0);
        assert!(printed.iter().all(|w| w.sweep == 1.0) && printed[0].extrapolation == 1.0);
        assert!(printed[1..].iter().all(|w| w.extrapolation == 1.8));
        let wang = of(Relaxation::Chebyshev { rho: Rho::Given(0.5), gamma: 0.9, delay: 0 }, 0);
        assert!(wang.iter().all(|w| w.sweep == 0.9) && wang[4].extrapolation == 1.0);
        assert_eq!(wang[5].extrapolation, 2.0 / 1.75);
    }
}
