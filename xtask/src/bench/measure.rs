//! All tasks on one graph, in turns.

use std::time::Instant;

use rayon::{ThreadPool, ThreadPoolBuilder};
use vivace_coloring::{Algorithm, Certificate, Coloring, Order, Vivace, balance, recolor, reduce};
use vivace_graph::{Adjacency, ConstraintGraph, DynamicGraph};
use vivace_tests::workloads::Workload;

use super::Options;
use super::changes::{Change, Reach};
use crate::figures::FigureError;
use crate::figures::measure::{Shares, timed};
use crate::report::quantile;

/// One thread, and as many as are compared with it.
pub(super) struct Pools {
    one: ThreadPool,
    many: ThreadPool,
    /// To see that the number of threads does not show.
    seven: ThreadPool,
}

impl Pools {
    pub(super) fn new(n_threads: usize) -> Result<Self, FigureError> {
        let pool = |n_threads: usize| {
            let pool = ThreadPoolBuilder::new().num_threads(n_threads).build();
            pool.map_err(|error| FigureError::Threads { n_threads, reason: error.to_string() })
        };
        Ok(Self { one: pool(1)?, many: pool(n_threads)?, seven: pool(7)? })
    }
}

/// What is timed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Task {
    /// A coloring from nothing.
    Color(Algorithm),
    /// Fewer colors, from a coloring by first fit in blocks.
    Reduce,
    /// Equal classes, from a coloring by serial first fit.
    BalanceFirstFit,
    /// Equal classes, from a reduced coloring.
    BalanceReduced,
    /// Equal classes, from a coloring of the paper's.
    BalanceVivace,
    /// Repair after edges changed between neighbors of neighbors.
    RecolorNearby,
    /// Repair after edges changed anywhere.
    RecolorAnywhere,
    /// First fit in blocks on the graph after the nearby change.
    FullNearby,
    /// First fit in blocks on the graph after the change anywhere.
    FullAnywhere,
    /// The nearby change of the graph itself.
    ApplyNearby,
    /// The change anywhere of the graph itself.
    ApplyAnywhere,
}

impl Task {
    /// Serial first fit in natural order, the measure of all.
    pub const SFF: Self = Self::Color(Algorithm::FirstFit(Order::Natural));

    /// In tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Color(algorithm) => algorithm.name(),
            Self::Reduce => "reduce",
            Self::BalanceFirstFit => "balance first-fit",
            Self::BalanceReduced => "balance reduced",
            Self::BalanceVivace => "balance vivace",
            Self::RecolorNearby => "recolor 1% nearby",
            Self::RecolorAnywhere => "recolor 1% anywhere",
            Self::FullNearby => "blocked after 1% nearby",
            Self::FullAnywhere => "blocked after 1% anywhere",
            Self::ApplyNearby => "apply 1% nearby",
            Self::ApplyAnywhere => "apply 1% anywhere",
        }
    }
}

/// One run of a task.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Time \[ms\].
    pub ms: f64,
    /// Colors; 0 where there is no coloring.
    pub colors: u32,
    /// Rounds; 0 for what does not work in rounds.
    pub rounds: u32,
    /// Visits per vertex; 0 for what does not work in rounds.
    pub visits: f64,
    /// Sizes of the classes.
    pub shares: Option<Shares>,
}

/// All runs of a task on a graph.
#[derive(Clone, Debug)]
pub struct TaskBench {
    /// The task.
    pub task: Task,
    /// On how many threads.
    pub n_threads: usize,
    /// Its runs.
    pub samples: Vec<Sample>,
}

impl TaskBench {
    /// A quantile of a quantity over the runs.
    pub fn quantile(&self, q: f64, of: impl Fn(&Sample) -> f64) -> f64 {
        let mut values: Vec<f64> = self.samples.iter().map(of).collect();
        values.sort_by(f64::total_cmp);
        quantile(&values, q)
    }

    /// The median over the runs.
    pub fn median(&self, of: impl Fn(&Sample) -> f64) -> f64 {
        self.quantile(0.5, of)
    }
}

/// All tasks on a graph.
#[derive(Clone, Debug)]
pub struct GraphBench {
    /// The graph's name and what is known of it.
    pub workload: Workload,
    /// Edges.
    pub n_edges: usize,
    /// Largest degree.
    pub max_degree: u32,
    /// Whether first fit in blocks gives one answer on 1, 2 and 7 threads.
    pub same_on_all_threads: bool,
    /// The tasks.
    pub tasks: Vec<TaskBench>,
}

impl GraphBench {
    /// A task's runs.
    pub fn of(&self, task: Task, n_threads: usize) -> Option<&TaskBench> {
        self.tasks.iter().find(|t| t.task == task && t.n_threads == n_threads)
    }

    /// Median time of a task \[ms\]; NaN if it was not run.
    pub fn ms(&self, task: Task, n_threads: usize) -> f64 {
        self.of(task, n_threads).map_or(f64::NAN, |t| t.median(|s| s.ms))
    }

    /// Median time of a task over that of SFF.
    pub fn ratio(&self, task: Task, n_threads: usize) -> f64 {
        self.ms(task, n_threads) / self.ms(Task::SFF, 1)
    }

    /// Median number of colors of a task.
    pub fn colors(&self, task: Task, n_threads: usize) -> f64 {
        self.of(task, n_threads).map_or(f64::NAN, |t| t.median(|s| f64::from(s.colors)))
    }
}

/// A change with all that its tasks need.
struct Changed {
    change: Change,
    before: DynamicGraph,
    after: DynamicGraph,
    after_rows: ConstraintGraph,
}

/// Below this \[ms\] a task would pay for the caches that the task before it has filled: it runs once before it is timed.
const SHORT: f64 = 20.0;

/// What the tasks start from.
struct Inputs<'a> {
    graph: &'a ConstraintGraph,
    pools: &'a Pools,
    seed: u64,
    first_fit: Coloring,
    blocked: Coloring,
    reduced: Coloring,
    vivace: Coloring,
    nearby: Changed,
    anywhere: Changed,
}

/// Runs all tasks once to warm up, then in turns, each at once after an untimed run of its own where it is short.
pub(super) fn graph(
    options: &Options,
    pools: &Pools,
    workload: &Workload,
    graph: &ConstraintGraph,
) -> Result<GraphBench, FigureError> {
    let blocked = pools.one.install(|| Algorithm::BlockedFirstFit.color(graph).coloring);
    let same = [&pools.many, &pools.seven]
        .iter()
        .all(|pool| pool.install(|| Algorithm::BlockedFirstFit.color(graph).coloring) == blocked);
    let inputs = Inputs {
        graph,
        pools,
        seed: options.seed,
        first_fit: Algorithm::FirstFit(Order::Natural).color(graph).coloring,
        reduced: reduce(graph, blocked.clone()),
        vivace: Algorithm::Vivace(Vivace { seed: options.seed, ..Vivace::DEFAULT }).color(graph).coloring,
        blocked,
        nearby: changed(graph, Reach::Nearby, options.seed)?,
        anywhere: changed(graph, Reach::Anywhere, options.seed)?,
    };
    let mut tasks = Vec::new();
    let mut is_short = Vec::new();
    for (task, n_threads) in wanted(options.n_threads) {
        is_short.push(inputs.run(task, n_threads, 0)?.ms < SHORT);
        tasks.push(TaskBench { task, n_threads, samples: Vec::new() });
    }
    let started = Instant::now();
    for idx in 0..options.runs.1 {
        if idx >= options.runs.0 && started.elapsed().as_secs_f64() > options.seconds {
            break;
        }
        for (TaskBench { task, n_threads, samples }, &is_short) in tasks.iter_mut().zip(&is_short) {
            if is_short {
                inputs.run(*task, *n_threads, u64::from(idx))?;
            }
            samples.push(inputs.run(*task, *n_threads, u64::from(idx))?);
        }
    }
    Ok(GraphBench {
        workload: *workload,
        n_edges: graph.n_edges(),
        max_degree: graph.max_degree(),
        same_on_all_threads: same,
        tasks,
    })
}

/// The tasks in their order: what is compared stands close together.
fn wanted(n_threads: usize) -> Vec<(Task, usize)> {
    let mut tasks = vec![(Task::SFF, 1)];
    let in_parallel = [
        Algorithm::BlockedFirstFit,
        Algorithm::Vivace(Vivace::DEFAULT),
        Algorithm::JonesPlassmann { seed: 0 },
        Algorithm::LargestDegreeFirst { seed: 0 },
        Algorithm::Luby { seed: 0 },
    ];
    for algorithm in in_parallel {
        tasks.push((Task::Color(algorithm), 1));
        if n_threads > 1 {
            tasks.push((Task::Color(algorithm), n_threads));
        }
    }
    let serial = [Task::Reduce, Task::BalanceFirstFit, Task::BalanceReduced, Task::BalanceVivace];
    tasks.extend(serial.map(|task| (task, 1)));
    let after_changes = [
        Task::RecolorNearby,
        Task::FullNearby,
        Task::RecolorAnywhere,
        Task::FullAnywhere,
        Task::ApplyNearby,
        Task::ApplyAnywhere,
    ];
    tasks.extend(after_changes.map(|task| (task, n_threads)));
    tasks
}

fn changed(graph: &ConstraintGraph, reach: Reach, seed: u64) -> Result<Changed, FigureError> {
    let change = Change::of(graph, 0.01, reach, seed);
    let before = DynamicGraph::from(graph);
    let mut after = before.clone();
    after.apply(&change.removed, &change.inserted)?;
    let after_rows = after.to_graph();
    Ok(Changed { change, before, after, after_rows })
}

impl Inputs<'_> {
    fn run(&self, task: Task, n_threads: usize, idx: u64) -> Result<Sample, FigureError> {
        let pool = if n_threads == 1 { &self.pools.one } else { &self.pools.many };
        let graph = self.graph;
        match task {
            Task::Color(algorithm) => {
                let algorithm = algorithm.with_seed(self.seed + idx);
                let (outcome, ms) = timed(pool, || algorithm.color(graph));
                let sample = colored(task, graph, &outcome.coloring, ms)?;
                if !algorithm.is_seeded() {
                    return Ok(sample);
                }
                let visits = outcome.visits as f64 / graph.n_vertices().max(1) as f64;
                Ok(Sample { rounds: outcome.rounds, visits, ..sample })
            }
            Task::Reduce => {
                let start = self.blocked.clone();
                let (coloring, ms) = timed(pool, || reduce(graph, start));
                colored(task, graph, &coloring, ms)
            }
            Task::BalanceFirstFit => self.balance(task, pool, &self.first_fit),
            Task::BalanceReduced => self.balance(task, pool, &self.reduced),
            Task::BalanceVivace => self.balance(task, pool, &self.vivace),
            Task::RecolorNearby => self.recolor(task, pool, &self.nearby),
            Task::RecolorAnywhere => self.recolor(task, pool, &self.anywhere),
            Task::FullNearby => full(task, pool, &self.nearby.after_rows),
            Task::FullAnywhere => full(task, pool, &self.anywhere.after_rows),
            Task::ApplyNearby => apply(pool, &self.nearby),
            Task::ApplyAnywhere => apply(pool, &self.anywhere),
        }
    }

    fn balance(&self, task: Task, pool: &ThreadPool, start: &Coloring) -> Result<Sample, FigureError> {
        let start = start.clone();
        let (balanced, ms) = timed(pool, || balance(self.graph, start));
        colored(task, self.graph, &balanced.coloring, ms)
    }

    fn recolor(&self, task: Task, pool: &ThreadPool, changed: &Changed) -> Result<Sample, FigureError> {
        let mut coloring = self.blocked.clone();
        let (_, ms) = timed(pool, || recolor(&changed.after, &mut coloring, &changed.change.inserted));
        colored(task, &changed.after, &coloring, ms)
    }
}

fn full(task: Task, pool: &ThreadPool, graph: &ConstraintGraph) -> Result<Sample, FigureError> {
    let (outcome, ms) = timed(pool, || Algorithm::BlockedFirstFit.color(graph));
    colored(task, graph, &outcome.coloring, ms)
}

fn apply(pool: &ThreadPool, changed: &Changed) -> Result<Sample, FigureError> {
    let mut graph = changed.before.clone();
    let (applied, ms) = timed(pool, || graph.apply(&changed.change.removed, &changed.change.inserted));
    applied?;
    Ok(Sample { ms, colors: 0, rounds: 0, visits: 0.0, shares: None })
}

/// A sample of a coloring, which is checked.
fn colored(task: Task, graph: &impl Adjacency, coloring: &Coloring, ms: f64) -> Result<Sample, FigureError> {
    Certificate::check(graph, coloring.colors())
        .map_err(|violation| FigureError::Coloring { method: task.name().to_owned(), violation })?;
    Ok(Sample { ms, colors: coloring.n_colors(), rounds: 0, visits: 0.0, shares: Some(Shares::of(coloring)) })
}
