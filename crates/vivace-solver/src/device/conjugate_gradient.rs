//! Preconditioned conjugate gradients on a device: see `pd/conjugate_gradient.rs`, of which this is the twin.

use bytemuck::Zeroable;
use glam::Vec4;
use vivace_kernels::Backend;
use vivace_kernels::linear::{
    AddScaled, AddScaledUniform, Divide, Dot, FindScalars, FindScalarsUniform, Multiply, Scalars, SumPairs,
    Sweep, SweepUniform, Turn,
};
use vivace_kernels::step::{BLOCK, CopyVector, SetVector, SetVectorUniform, SumUniform};

use super::rows::DeviceRows;
use crate::Preconditioner;
use crate::pd::conjugate_gradient::ROUNDING;

/// Work vectors, kept from solve to solve. Those that rows read are 0 at what is pinned.
pub(super) struct ConjugateGradient<B: Backend> {
    free: B::List,
    one: B::List,
    n_free: u32,
    solution: B::Buffer<Vec4>,
    direction: B::Buffer<Vec4>,
    /// Y times the direction.
    image: B::Buffer<Vec4>,
    /// M⁻¹ r.
    preconditioned: B::Buffer<Vec4>,
    scalars: B::Buffer<Scalars>,
    /// Two dot products in pieces, and sums of those.
    sums: [B::Buffer<[Vec4; 2]>; 3],
}

impl<B: Backend> ConjugateGradient<B> {
    /// For `n` particles, `n_free` of which move.
    pub(super) fn new(backend: &B, n: u32, n_free: u32) -> Self {
        let zeros = |n: u32| backend.filled(n as usize, Vec4::ZERO);
        let n_sums = |depth: u32| (0..depth).fold(n_free, |n, _| n.div_ceil(BLOCK));
        Self {
            free: backend.range(0..n_free),
            one: backend.range(0..1),
            n_free,
            solution: zeros(n_free),
            direction: zeros(n),
            image: zeros(n_free),
            preconditioned: zeros(n),
            scalars: backend.filled(1, Scalars::zeroed()),
            sums: [1, 2, 3].map(|depth| backend.filled(n_sums(depth) as usize, [Vec4::ZERO; 2])),
        }
    }

    /// Adds to q the δ \[m\] of `Y δ = residual` after `iterations` iterations; what is left of `residual` \[N\] is scratch. Columns that
    /// have reached rounding stay as they are.
    pub(super) fn solve(
        &mut self,
        backend: &B,
        (rows, anchors, colors): (&DeviceRows<B>, &B::Buffer<Vec4>, &[B::List]),
        preconditioner: Preconditioner,
        iterations: u32,
        residual: &mut B::Buffer<Vec4>,
        q: &mut B::Buffer<Vec4>,
    ) {
        let nothing = SetVectorUniform { value: Vec4::ZERO };
        backend.map::<SetVector>(&self.free, &nothing, (), &mut self.solution);
        self.precondition(backend, rows, colors, preconditioner, residual);
        let z = (backend.view(&self.preconditioned),);
        backend.map::<CopyVector>(&self.free, &(), z, &mut self.direction);
        self.dots(backend, residual, 0);
        for k in 0..iterations {
            let (of_rows, taps) = (backend.view(&rows.rows), backend.view(&rows.taps));
            let inputs = (of_rows, taps, backend.view(anchors), backend.view(&self.direction));
            backend.map::<Multiply>(&self.free, &(), inputs, &mut self.image);
            self.dots(backend, residual, 1);
            let [along, against] = [1.0, -1.0].map(|factor| AddScaledUniform { factor, by_alpha: 1 });
            let step = (backend.view(&self.scalars), backend.view(&self.direction));
            backend.map::<AddScaled>(&self.free, &along, step, &mut self.solution);
            // The last step is all that is left to do.
            if k + 1 < iterations {
                let image = (backend.view(&self.scalars), backend.view(&self.image));
                backend.map::<AddScaled>(&self.free, &against, image, residual);
                self.precondition(backend, rows, colors, preconditioner, residual);
                self.dots(backend, residual, 2);
                let turn = (backend.view(&self.scalars), backend.view(&self.preconditioned));
                backend.map::<Turn>(&self.free, &(), turn, &mut self.direction);
            }
        }
        let solution = (backend.view(&self.scalars), backend.view(&self.solution));
        backend.map::<AddScaled>(&self.free, &AddScaledUniform { factor: 1.0, by_alpha: 0 }, solution, q);
    }

    fn precondition(
        &mut self,
        backend: &B,
        rows: &DeviceRows<B>,
        colors: &[B::List],
        preconditioner: Preconditioner,
        residual: &B::Buffer<Vec4>,
    ) {
        let of_rows = backend.view(&rows.rows);
        match preconditioner {
            Preconditioner::Jacobi => {
                let inputs = (of_rows, backend.view(residual));
                backend.map::<Divide>(&self.free, &(), inputs, &mut self.preconditioned);
            }
            Preconditioner::SymmetricGaussSeidel => {
                let inputs = (of_rows, backend.view(&rows.taps), backend.view(residual));
                let [forward, backward] = [0, 1].map(|is_backward| SweepUniform { is_backward });
                for color in colors {
                    backend.update::<Sweep>(color, &forward, inputs, &mut self.preconditioned);
                }
                // Behind the last color there is nothing.
                for color in colors.iter().rev().skip(1) {
                    backend.update::<Sweep>(color, &backward, inputs, &mut self.preconditioned);
                }
            }
        }
    }

    /// The dot products of a stage of [`FindScalars`], and its scalars.
    fn dots(&mut self, backend: &B, residual: &B::Buffer<Vec4>, stage: u32) {
        let [r, z, d, image] =
            [residual, &self.preconditioned, &self.direction, &self.image].map(|vector| backend.view(vector));
        let vectors = if stage == 1 { (d, image, image) } else { (r, z, r) };
        let sum = |n_numbers: u32| {
            let n_sums = n_numbers.div_ceil(BLOCK);
            (SumUniform { first: 0, n_sums, n_numbers }, backend.range(0..n_sums))
        };
        let [pairs, folds @ ..] = &mut self.sums;
        let (uniform, list) = sum(self.n_free);
        backend.map::<Dot>(&list, &uniform, vectors, pairs);
        let (mut n, mut from) = (uniform.n_sums, &*pairs);
        for fold in folds {
            if n > BLOCK {
                let (uniform, list) = sum(n);
                backend.map::<SumPairs>(&list, &uniform, (backend.view(from),), fold);
                n = uniform.n_sums;
                from = fold;
            }
        }
        #[expect(clippy::cast_possible_truncation, reason = "a small number")]
        let squared_tolerance = (ROUNDING * ROUNDING) as f32;
        let uniform = FindScalarsUniform { stage, n_sums: n, squared_tolerance };
        backend.map::<FindScalars>(&self.one, &uniform, (backend.view(from),), &mut self.scalars);
    }
}
