//! Seeded random numbers, the same on every machine.

use rand_pcg::Pcg32;
use rand_pcg::rand_core::{Rng, SeedableRng};

/// A stream of random numbers.
#[derive(Debug, Clone)]
pub struct Random(Pcg32);

impl Random {
    /// One seed, one stream.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self(Pcg32::seed_from_u64(seed))
    }

    /// Uniform below `n`, which is not 0; off by less than n / 2^32.
    pub fn below(&mut self, n: u32) -> u32 {
        let scaled = (u64::from(self.0.next_u32()) * u64::from(n)) >> 32;
        u32::try_from(scaled).expect("below n")
    }

    /// Uniform in [0, 1), 32 bits.
    pub fn unit(&mut self) -> f64 {
        f64::from(self.0.next_u32()) / 2_f64.powi(32)
    }

    /// The first `len` of a random order of `0..n`.
    pub fn sample(&mut self, n: u32, len: u32) -> Vec<u32> {
        let mut all: Vec<u32> = (0..n).collect();
        for i in 0..len.min(n) {
            all.swap(i as usize, (i + self.below(n - i)) as usize);
        }
        all.truncate(len as usize);
        all
    }

    /// A random order of `0..n`.
    pub fn permutation(&mut self, n: u32) -> Vec<u32> {
        self.sample(n, n)
    }
}
