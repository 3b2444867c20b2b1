//! Colorings timed and counted: interleaved runs, each with a seed of its own and each checked.

use std::time::Instant;

use rayon::ThreadPool;
use vivace_coloring::{Algorithm, Certificate, Coloring, Order, Outcome, Vivace, balance};
use vivace_gpu::Gpu;
use vivace_graph::ConstraintGraph;

use super::FigureError;
use super::device::OnGpu;
use crate::report::{Look, quantile};

/// An algorithm as figures show it.
#[derive(Clone, Copy, Debug)]
pub struct Method {
    /// In legends.
    pub name: &'static str,
    /// The algorithm; its seed is set for each run.
    pub algorithm: Algorithm,
    /// Color, marker and dash of its curves: whole lines work in rounds, dotted ones do so on the GPU, dashed ones are the CPU's own.
    pub look: Look,
    /// Whether it runs on the GPU.
    pub is_on_gpu: bool,
}

impl Method {
    const fn new(name: &'static str, algorithm: Algorithm, color: usize, marker: usize, dash: usize) -> Self {
        Self { name, algorithm, look: Look { color, marker, dash }, is_on_gpu: false }
    }

    const fn on_gpu(self, name: &'static str) -> Self {
        Self { name, look: Look { dash: Look::DOTTED, ..self.look }, is_on_gpu: true, ..self }
    }

    /// Luby (1985).
    pub const LUBY: Self = Self::new("Luby", Algorithm::Luby { seed: 0 }, 0, 0, 0);
    /// Jones and Plassmann (1993).
    pub const JONES_PLASSMANN: Self =
        Self::new("Jones\u{2013}Plassmann", Algorithm::JonesPlassmann { seed: 0 }, 2, 2, 0);
    /// Largest-Degree-First.
    pub const LDF: Self = Self::new("LDF", Algorithm::LargestDegreeFirst { seed: 0 }, 4, 3, 0);
    /// The paper's.
    pub const VIVACE: Self = Self::new("Vivace", Algorithm::Vivace(Vivace::DEFAULT), 1, 1, 0);
    /// The CPU's best on several threads.
    pub const BLOCKED: Self = Self::new("First fit in blocks (CPU)", Algorithm::BlockedFirstFit, 3, 4, 5);
    /// The CPU's best on one thread.
    pub const SERIAL: Self =
        Self::new("First fit, serial (CPU)", Algorithm::FirstFit(Order::Natural), 7, 5, 2);

    /// The paper's columns of figure 2.
    pub const PAPER: [Self; 4] = [Self::LUBY, Self::JONES_PLASSMANN, Self::LDF, Self::VIVACE];
    /// The same on the GPU.
    pub const GPU: [Self; 4] = [
        Self::LUBY.on_gpu("Luby (GPU)"),
        Self::JONES_PLASSMANN.on_gpu("Jones\u{2013}Plassmann (GPU)"),
        Self::LDF.on_gpu("LDF (GPU)"),
        Self::VIVACE.on_gpu("Vivace (GPU)"),
    ];
    /// The paper's, and what is best on a CPU.
    pub const ALL: [Self; 6] =
        [Self::LUBY, Self::JONES_PLASSMANN, Self::LDF, Self::VIVACE, Self::BLOCKED, Self::SERIAL];

    /// Whether rounds and visits mean anything.
    pub fn is_in_rounds(&self) -> bool {
        self.algorithm.is_seeded()
    }
}

/// What runs the colorings.
#[derive(Clone, Copy)]
pub struct Devices<'a> {
    /// The CPU's threads.
    pub pool: &'a ThreadPool,
    /// The GPU, if curves of it are wanted.
    pub gpu: Option<&'a Gpu>,
}

impl Devices<'_> {
    /// The methods of the CPU, and those of the GPU if there is one.
    pub fn methods(&self, cpu: &[Method]) -> Vec<Method> {
        let gpu: &[Method] = if self.gpu.is_some() { &Method::GPU } else { &[] };
        [cpu, gpu].concat()
    }

    /// Threads that a method runs on; none on the GPU.
    pub fn n_threads(&self, method: &Method) -> Option<usize> {
        (!method.is_on_gpu).then(|| self.pool.current_num_threads())
    }

    /// Where a method runs: `cpu`, or the adapter's name.
    pub fn name(&self, method: &Method) -> &str {
        let gpu = self.gpu.filter(|_| method.is_on_gpu);
        gpu.map_or("cpu", |gpu| gpu.adapter().name.as_str())
    }
}

/// How often to run.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Runs where time allows, each with a seed of its own.
    pub most: u32,
    /// Runs in any case.
    pub fewest: u32,
    /// Time for all runs of all methods on one graph \[s\].
    pub seconds: f64,
    /// Whether to balance each coloring, too.
    pub balance: bool,
}

/// Sizes of the largest and of the smallest class over the mean size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shares {
    /// Largest class over the mean.
    pub largest: f64,
    /// Smallest class over the mean.
    pub smallest: f64,
}

impl Shares {
    /// Of a coloring; 1 and 1 for an empty one.
    pub fn of(coloring: &Coloring) -> Self {
        let sizes = coloring.class_sizes();
        let mean = coloring.colors().len() as f64 / sizes.len().max(1) as f64;
        let share = |size: Option<&u32>| size.map_or(1.0, |&size| f64::from(size) / mean);
        Self { largest: share(sizes.iter().max()), smallest: share(sizes.iter().min()) }
    }
}

/// One run.
#[derive(Clone, Debug)]
pub struct Run {
    /// Seed of the coloring.
    pub seed: u64,
    /// Time to complete \[ms\].
    pub ms: f64,
    /// Number of colors.
    pub colors: u32,
    /// Rounds.
    pub rounds: u32,
    /// Vertices that acted, summed over the rounds, over all vertices.
    pub visits: f64,
    /// Vertices colored one by one after the bound on rounds.
    pub stragglers: u32,
    /// Vertices whose color is the last of the degree + 1 that they may ever have.
    pub at_limit: u32,
    /// Class sizes.
    pub shares: Shares,
    /// Class sizes after balancing.
    pub balanced: Option<Shares>,
    /// Time of balancing \[ms\].
    pub balance_ms: Option<f64>,
}

/// All runs of one method on one graph.
#[derive(Clone, Debug)]
pub struct Measured {
    /// The method.
    pub method: Method,
    /// Its runs.
    pub runs: Vec<Run>,
    /// The coloring of the first run.
    pub first: Coloring,
}

impl Measured {
    /// A quantity of each run.
    pub fn samples(&self, of: impl Fn(&Run) -> f64) -> Vec<f64> {
        self.runs.iter().map(of).collect()
    }

    /// A quantile of a quantity over the runs.
    pub fn quantile(&self, q: f64, of: impl Fn(&Run) -> f64) -> f64 {
        let mut samples = self.samples(of);
        samples.sort_by(f64::total_cmp);
        quantile(&samples, q)
    }

    /// The median over the runs.
    pub fn median(&self, of: impl Fn(&Run) -> f64) -> f64 {
        self.quantile(0.5, of)
    }

    /// The mean over the runs.
    pub fn mean(&self, of: impl Fn(&Run) -> f64) -> f64 {
        self.samples(of).iter().sum::<f64>() / self.runs.len() as f64
    }
}

/// Runs every method once to warm up, then all of them in turn, as often as `effort` says.
///
/// # Errors
/// [`FigureError::Coloring`] if a coloring is not proper: a mistake of ours, which no figure may hide. What the GPU runs into.
pub fn measure(
    devices: Devices<'_>,
    graph: &ConstraintGraph,
    methods: &[Method],
    effort: Effort,
    seed: u64,
) -> Result<Vec<Measured>, FigureError> {
    let started = Instant::now();
    let on_gpu = devices.gpu.map(|gpu| OnGpu::new(gpu, graph));
    let run = |method: &Method, seed| {
        let algorithm = method.algorithm.with_seed(seed);
        let (outcome, ms) = match &on_gpu {
            Some(on_gpu) if method.is_on_gpu => on_gpu.color(algorithm)?,
            _ => timed(devices.pool, || algorithm.color(graph)),
        };
        checked(devices.pool, graph, method, seed, outcome, ms, effort.balance)
    };
    let mut measured = Vec::new();
    for method in methods {
        let (_, first) = run(method, seed)?;
        measured.push(Measured { method: *method, runs: Vec::new(), first });
    }
    let round = started.elapsed().as_secs_f64();
    for idx in 0..effort.most {
        let spent = started.elapsed().as_secs_f64();
        if idx >= effort.fewest && spent + round > effort.seconds {
            break;
        }
        for Measured { method, runs, .. } in &mut measured {
            runs.push(run(method, seed + u64::from(idx))?.0);
        }
    }
    Ok(measured)
}

/// What is to be known of a coloring that took `ms`.
fn checked(
    pool: &ThreadPool,
    graph: &ConstraintGraph,
    method: &Method,
    seed: u64,
    outcome: Outcome,
    ms: f64,
    with_balance: bool,
) -> Result<(Run, Coloring), FigureError> {
    let check = |coloring: &Coloring| match Certificate::check(graph, coloring.colors()) {
        Ok(_) => Ok(()),
        Err(violation) => Err(FigureError::Coloring { method: method.name.to_owned(), violation }),
    };
    check(&outcome.coloring)?;
    let colors = outcome.coloring.colors();
    let at_limit = colors.iter().zip(graph.degrees()).filter(|&(c, degree)| *c >= degree).count();
    let mut balanced = None;
    let mut balance_ms = None;
    if with_balance {
        let copy = outcome.coloring.clone();
        let (result, ms) = timed(pool, || balance(graph, copy).coloring);
        check(&result)?;
        (balanced, balance_ms) = (Some(Shares::of(&result)), Some(ms));
    }
    let run = Run {
        seed,
        ms,
        colors: outcome.coloring.n_colors(),
        rounds: outcome.rounds,
        visits: outcome.visits as f64 / graph.n_vertices().max(1) as f64,
        stragglers: outcome.stragglers,
        at_limit: u32::try_from(at_limit).unwrap_or(u32::MAX),
        shares: Shares::of(&outcome.coloring),
        balanced,
        balance_ms,
    };
    Ok((run, outcome.coloring))
}

/// What `work` gives, and how long it takes in the pool \[ms\].
pub fn timed<T: Send>(pool: &ThreadPool, work: impl FnOnce() -> T + Send) -> (T, f64) {
    pool.install(|| {
        let started = Instant::now();
        let result = work();
        (result, 1e3 * started.elapsed().as_secs_f64())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_are_interleaved_counted_and_checked() {
        let graph = ConstraintGraph::from_edges(4, &[[0, 1], [1, 2], [2, 3], [3, 0], [0, 2]]).unwrap();
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
        let effort = Effort { most: 3, fewest: 2, seconds: 0.0, balance: true };
        let measured = measure(Devices { pool: &pool, gpu: None }, &graph, &Method::ALL, effort, 7).unwrap();
        assert_eq!(measured.len(), Method::ALL.len());
        for m in &measured {
            assert_eq!(m.samples(|run| run.seed as f64), [7.0, 8.0], "{}", m.method.name);
            assert!(m.median(|run| f64::from(run.colors)) == 3.0 && m.median(|run| run.ms) > 0.0);
            assert!(m.runs.iter().all(|run| run.balanced.is_some() && run.shares.largest >= 1.0));
        }
    }
}
