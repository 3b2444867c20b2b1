//! Chebyshev acceleration of a stationary iteration (Golub and Van Loan 1996; Wang 2015, Algorithm 1).

use crate::Stages;

/// The weights ω_1, ω_2, …: 1 until acceleration begins, then 2 / (2 − ρ²), then 4 / (4 − ρ² ω), which tends to
/// 2 / (1 + √(1 − ρ²)).
#[derive(Debug, Clone, Copy)]
pub(super) struct Weights {
    rho: f32,
    delay: u32,
    k: u32,
    omega: f32,
}

impl Weights {
    /// For the estimated spectral radius `rho`; the first `delay` iterations are plain.
    pub(super) fn new(rho: f32, delay: u32) -> Self {
        Self { rho, delay, k: 0, omega: 1.0 }
    }

    /// The weight of the next iteration.
    pub(super) fn next(&mut self) -> f32 {
        let squared = self.rho * self.rho;
        // The very first iteration has no predecessor to extrapolate from.
        let first = self.delay.max(1);
        self.omega = match self.k {
            k if k < first => 1.0,
            k if k == first => 2.0 / (2.0 - squared),
            _ => 4.0 / (4.0 - squared * self.omega),
        };
        self.k = self.k.saturating_add(1);
        self.omega
    }
}

/// One iteration of `sweep`, extrapolated from the positions before the last: `q = q⁻ + weight · (q̂ − q⁻)`.
pub(super) fn accelerated(stages: &mut dyn Stages, weight: f32, sweep: impl FnOnce(&mut dyn Stages)) {
    stages.remember();
    sweep(stages);
    stages.extrapolate(weight);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_tend_to_their_limit() {
        for rho in [0.5_f32, 0.9, 0.99, 0.999] {
            let mut weights = Weights::new(rho, 3);
            let first: Vec<f32> = (0..4).map(|_| weights.next()).collect();
            assert_eq!(first, [1.0, 1.0, 1.0, 2.0 / (2.0 - rho * rho)]);
            let last = (0..2000).map(|_| weights.next()).last().unwrap();
            assert!((last - 2.0 / (1.0 + (1.0 - rho * rho).sqrt())).abs() < 2e-4, "{rho}: {last}");
        }
    }
}
