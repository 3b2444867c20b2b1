//! Colorings on the GPU, and what is said about it.

use std::time::Instant;

use vivace_coloring::{Algorithm, ColorOnError, GraphView, Outcome};
use vivace_gpu::{Buffer, Gpu, GpuMemory};
use vivace_graph::ConstraintGraph;
use vivace_kernels::Backend;

use super::FigureError;

/// A graph that lies on the GPU.
pub(super) struct OnGpu<'a> {
    gpu: &'a Gpu,
    graph: &'a ConstraintGraph,
    offsets: Buffer<u32>,
    neighbors: Buffer<u32>,
}

impl<'a> OnGpu<'a> {
    pub(super) fn new(gpu: &'a Gpu, graph: &'a ConstraintGraph) -> Self {
        let csr = graph.csr();
        Self { gpu, graph, offsets: gpu.upload(csr.offsets()), neighbors: gpu.upload(csr.items()) }
    }

    /// A coloring, and how long it takes where the graph lies on the device and the colors stay there \[ms\]. They come to the
    /// host by a second run with the same seed, which gives the same bits.
    pub(super) fn color(&self, algorithm: Algorithm) -> Result<(Outcome, f64), FigureError> {
        let view = GraphView::<GpuMemory> {
            offsets: &self.offsets,
            neighbors: &self.neighbors,
            n_vertices: self.graph.n_vertices(),
            n_neighbors: self.graph.csr().len(),
        };
        self.gpu.wait()?;
        let started = Instant::now();
        drop(algorithm.run(self.gpu, view));
        self.gpu.wait()?;
        let ms = 1e3 * started.elapsed().as_secs_f64();
        match algorithm.color_on(self.gpu, self.graph) {
            Ok(outcome) => Ok((outcome, ms)),
            Err(ColorOnError::Backend(error)) => Err(error.into()),
            Err(ColorOnError::NotInRounds(algorithm)) => {
                unreachable!("{algorithm} is not among the GPU's methods")
            }
        }
    }
}

/// How a caption names the GPU whose curves a figure has.
pub(super) fn sentence(gpu: Option<&Gpu>) -> String {
    let Some(gpu) = gpu else {
        return "No GPU time is shown: see --backend gpu.".to_owned();
    };
    let adapter = crate::bench_gpu::adapter(gpu);
    let caution = if gpu.is_software() {
        " A CPU plays the GPU: its curves say what works, and are no claim of speed."
    } else {
        ""
    };
    format!(
        "Dotted: the same algorithms on {adapter}, where the graph lies and the colors stay; they are the CPU\u{2019}s, bit for bit.{caution}"
    )
}
