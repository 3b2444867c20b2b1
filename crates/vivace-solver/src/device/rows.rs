//! The rows of Y as a device reads them.

use vivace_kernels::Backend;
use vivace_kernels::pd::{Row, SLICE, SpringTap, Tap};

use crate::pd::rows::Rows;

/// Rows in slices, entry by entry.
pub(super) struct DeviceRows<B: Backend> {
    /// The rows on the host, for the next time step.
    on_host: Vec<Row>,
    pub(super) rows: B::Buffer<Row>,
    pub(super) taps: B::Buffer<Tap>,
    /// Stiffness times rest length of each entry \[N\]: all that a sweep needs of a spring.
    pub(super) pulls: B::Buffer<f32>,
    pub(super) springs: B::Buffer<SpringTap>,
}

impl<B: Backend> DeviceRows<B> {
    /// Lays out `rows`, without diagonals yet.
    pub(super) fn new(backend: &B, rows: &Rows) -> Self {
        let n_of = |i: usize| rows.offsets[i + 1] - rows.offsets[i];
        let mut on_host = vec![Row::default(); rows.len()];
        let mut end = 0;
        for (slice, rows_of) in on_host.chunks_mut(SLICE as usize).enumerate() {
            let start = slice * SLICE as usize;
            for (lane, row) in (0..).zip(rows_of.iter_mut()) {
                let i = start + lane as usize;
                let n_springs = rows.spring_ends[i] - rows.offsets[i];
                *row = Row { first: end + lane, n_springs, n: n_of(i), inverse_diagonal: 0.0 };
            }
            // Entries fit 32 bits; were it not for padding, which on rows of one color is little.
            end =
                end.saturating_add(SLICE.saturating_mul(rows_of.iter().map(|row| row.n).max().unwrap_or(0)));
        }
        let mut taps = vec![Tap::default(); end as usize];
        let mut springs = vec![SpringTap::default(); end as usize];
        for (i, row) in on_host.iter().enumerate() {
            for (k, entry) in (0..).zip(rows.offsets[i] as usize..rows.offsets[i + 1] as usize) {
                let at = (row.first + k * SLICE) as usize;
                let (stiffness, share) = (rows.stiffness[entry], rows.share(entry));
                taps[at] = Tap { column: rows.columns[entry], weight: rows.weights[entry] };
                springs[at] = SpringTap {
                    pull: rows.pulls[entry],
                    stiffness,
                    compliance: if stiffness > 0.0 { share / stiffness } else { 0.0 },
                    linear: rows.linear[entry] * share,
                };
            }
        }
        let pulls: Vec<f32> = springs.iter().map(|spring| spring.pull).collect();
        Self {
            rows: backend.upload(&on_host),
            taps: backend.upload(&taps),
            pulls: backend.upload(&pulls),
            springs: backend.upload(&springs),
            on_host,
        }
    }

    /// Sets one over the diagonal of Y.
    pub(super) fn set_inverse_diagonal(&mut self, backend: &B, inverse_diagonal: &[f32]) {
        for (row, &inverse) in self.on_host.iter_mut().zip(inverse_diagonal) {
            row.inverse_diagonal = inverse;
        }
        backend.write(&mut self.rows, &self.on_host);
    }
}
