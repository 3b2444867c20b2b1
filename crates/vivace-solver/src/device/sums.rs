//! Sums over a device: most of the adding there, in a fixed order, the rest on the host in `f64`.

use vivace_kernels::Backend;
use vivace_kernels::step::{BLOCK, Sum, SumUniform};

/// Numbers, and sums of them.
pub(super) struct Sums<B: Backend> {
    /// What is to be added up.
    pub(super) numbers: B::Buffer<f32>,
    sums: B::Buffer<f32>,
    most: usize,
    /// Sums of sums, and of those.
    folds: [B::Buffer<f32>; 2],
    on_host: Vec<f32>,
    /// Sums so far.
    n_sums: u32,
}

impl<B: Backend> Sums<B> {
    /// For so many numbers at a time, in several groups with these numbers of them.
    pub(super) fn new(backend: &B, groups: &[u32]) -> Self {
        let most = groups.iter().max().map_or(0, |&most| most as usize);
        let n_sums: usize = groups.iter().map(|n| n.div_ceil(BLOCK) as usize).sum();
        Self {
            numbers: backend.filled(most, 0.0),
            most,
            sums: backend.filled(n_sums, 0.0),
            folds: [1, 2].map(|depth| backend.filled(n_sums.div_ceil((BLOCK as usize).pow(depth)), 0.0)),
            on_host: vec![0.0; n_sums],
            n_sums: 0,
        }
    }

    /// Sets all numbers to 0, for kernels that write some.
    pub(super) fn clear(&mut self, backend: &B) {
        self.numbers = backend.filled(self.most, 0.0);
    }

    /// Adds up the first `n` numbers.
    pub(super) fn add(&mut self, backend: &B, n: u32) {
        self.n_sums += sum(backend, &self.numbers, n, self.n_sums, &mut self.sums);
    }

    /// All that was added up as `BLOCK` numbers at most, which stay on the device; begins anew.
    pub(super) fn fold(&mut self, backend: &B) -> (&B::Buffer<f32>, u32) {
        let mut n = std::mem::take(&mut self.n_sums);
        let (mut from, [first, second]) = (&self.sums, &mut self.folds);
        // With numbers of 32 bits there are 256³ at most to begin with.
        for fold in [first, second] {
            if n > BLOCK {
                n = sum(backend, from, n, 0, fold);
                from = fold;
            }
        }
        (from, n)
    }

    /// Waits for all that was added up, and begins anew.
    pub(super) fn total(&mut self, backend: &B) -> Result<f64, B::Error> {
        let sums = &mut self.on_host[..std::mem::take(&mut self.n_sums) as usize];
        backend.fetch(&self.sums, sums)?;
        Ok(sums.iter().map(|&sum| f64::from(sum)).sum())
    }
}

/// The first `n` numbers as one for each `BLOCK` of them, from place `first` on: how many.
fn sum<B: Backend>(
    backend: &B,
    numbers: &B::Buffer<f32>,
    n: u32,
    first: u32,
    sums: &mut B::Buffer<f32>,
) -> u32 {
    let n_sums = n.div_ceil(BLOCK);
    let uniform = SumUniform { first, n_sums, n_numbers: n };
    backend.map::<Sum>(&backend.range(first..first + n_sums), &uniform, (backend.view(numbers),), sums);
    n_sums
}
