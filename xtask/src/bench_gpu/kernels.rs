//! Time by kernel, beside what a copy reaches on the same device.

use std::time::Instant;

use vivace_coloring::{Algorithm, Vivace};
use vivace_gpu::{Gpu, GpuError, KernelTime, wgpu};
use vivace_kernels::Backend;
use vivace_tests::workloads::Workload;

use super::BenchError;
use crate::report::{Table, quantile};

/// Bandwidth of copies: bytes read and written over time \[bytes / s\].
#[derive(Debug, Clone, Copy)]
pub(super) struct Copies {
    /// Bytes of the array.
    pub(super) bytes: usize,
    /// The best of the runs, which kernels are compared with.
    pub(super) best: f64,
    /// The median.
    pub(super) median: f64,
}

impl Copies {
    pub(super) fn table(self) -> Table {
        let numbers = [self.bytes as f64, self.best * 1e-9, self.median * 1e-9];
        Table::new("Rate of a copy, reading and writing", &["bytes", "gb_per_s", "gb_per_s_median"])
            .row(numbers.map(Into::into))
    }
}

/// Copies an array that no cache holds, ten times a run.
pub(super) fn copies(gpu: &Gpu) -> Result<Copies, BenchError> {
    const N_COPIES: usize = 10;
    // A cache of a server's CPU may hold 64 MiB; of a GPU's none holds 256.
    let bytes: usize = if gpu.is_software() { 64 << 20 } else { 256 << 20 };
    let limits = gpu.device().limits();
    let limit = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
    let bytes = bytes.min(usize::try_from(limit / 256 * 256).unwrap_or(bytes));
    let (from, to) = (gpu.filled(bytes / 4, 1_u32), gpu.filled(bytes / 4, 0_u32));
    let mut speeds = Vec::new();
    // The first run is not counted.
    for run in 0..8 {
        gpu.wait()?;
        let start = Instant::now();
        let mut encoder = gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        for _ in 0..N_COPIES {
            encoder.copy_buffer_to_buffer(from.raw()?, 0, to.raw()?, 0, bytes as u64);
        }
        gpu.queue().submit([encoder.finish()]);
        gpu.wait()?;
        if run > 0 {
            speeds.push((2 * N_COPIES * bytes) as f64 / start.elapsed().as_secs_f64());
        }
    }
    speeds.sort_by(f64::total_cmp);
    Ok(Copies { bytes, best: quantile(&speeds, 1.0), median: quantile(&speeds, 0.5) })
}

/// The columns that [`push`] fills.
pub(super) fn table() -> Table {
    Table::new(
        "Time by kernel",
        &[
            "work",
            "kernel",
            "dispatches",
            "us_per_dispatch",
            "ms",
            "share_of_time",
            "gb_per_s",
            "share_of_copy",
        ],
    )
}

/// Adds a row for each kernel of some work.
pub(super) fn push(work: &str, kernels: &[KernelTime], copies: Copies, table: &mut Table) {
    let seconds: f64 = kernels.iter().map(|kernel| kernel.seconds).sum();
    for kernel in kernels {
        table.push(vec![
            work.into(),
            kernel.name.into(),
            (kernel.n_dispatches as f64).into(),
            (kernel.seconds_per_dispatch() * 1e6).into(),
            (kernel.seconds * 1e3).into(),
            (kernel.seconds / seconds).into(),
            (kernel.bandwidth() * 1e-9).into(),
            (kernel.bandwidth() / copies.best).into(),
        ]);
    }
}

/// Adds the kernels of the paper's coloring of a graph; `None` where the device has no clock.
pub(super) fn coloring(
    gpu: &Gpu,
    workload: &Workload,
    seed: u64,
    copies: Copies,
    table: &mut Table,
) -> Result<Option<()>, BenchError> {
    let algorithm = Algorithm::Vivace(Vivace::DEFAULT).with_seed(seed);
    let color = |gpu: &Gpu| algorithm.color_on(gpu, workload.shared());
    // The first run makes pipelines and buffers.
    drop(color(gpu));
    match gpu.profile(color) {
        Ok((_, times)) => {
            push(&format!("coloring {}", workload.name), times.kernels(), copies, table);
            Ok(Some(()))
        }
        Err(GpuError::NoTimestamps { .. }) => Ok(None),
        Err(error) => Err(error.into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Value;

    #[test]
    fn a_row_for_each_kernel() {
        let kernel = |name, n_dispatches, seconds, bytes| KernelTime { name, n_dispatches, seconds, bytes };
        let kernels = [kernel("sweep", 3, 3e-3, 6e6), kernel("fill", 1, 1e-3, 4e6)];
        let mut table = table();
        push("a frame", &kernels, Copies { bytes: 4, best: 8e9, median: 1e9 }, &mut table);
        let row = |kernel: &str, numbers: [f64; 6]| -> Vec<Value> {
            let words = ["a frame", kernel].map(Value::from);
            words.into_iter().chain(numbers.map(Value::from)).collect()
        };
        let expected =
            [row("sweep", [3.0, 1e3, 3.0, 0.75, 2.0, 0.25]), row("fill", [1.0, 1e3, 1.0, 0.25, 4.0, 0.5])];
        for (row, expected) in table.rows.iter().flatten().zip(expected.iter().flatten()) {
            match (row, expected) {
                (Value::Real(a), Value::Real(b)) => assert!((a - b).abs() < 1e-9 * b, "{a} is not {b}"),
                (a, b) => assert_eq!(a, b),
            }
        }
        assert_eq!(table.rows.len(), 2);
    }
}
