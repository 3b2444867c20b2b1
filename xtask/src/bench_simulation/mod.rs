//! The solvers of `vivace-solver`, measured in one run, as ratios to a plain Gauss-Seidel sweep (PLAIN in tables); and
//! the bars that the project holds itself to.
//!
//! Workload A is a hanging cloth of springs and hinges, B a bar of tetrahedra (`scenes.rs`). All that is compared took turns. With
//! the feature `rapier` the soft bodies of rapier3d run beside ours (`rapier.rs`).
//!
//! The speed of a machine drifts, so PLAIN runs before and after all that is timed, and each time is divided by the mean of the two:
//! `over_plain` is the median of these ratios, `over_plain_q1` and `over_plain_q3` are their quartiles, on any machine. `ms` is the
//! median time on this one.
//!
//! `times.csv`, a row for each task, per iteration: `workload`, `task`, `threads`, `runs`, `ms`, `ms_q1`, `ms_q3`, `ms_min`,
//! `over_plain`, `over_plain_q1`, `over_plain_q3`. `frames.csv`, what one frame leaves of its error: `stiffness`, `setting`,
//! `safeguard`, `kind`, `over_plain`, `ms` (of an iteration), `budget` (in PLAIN), `iterations`, `error`, `backoffs`.
//! `drape.csv`, workload C, a cloth that falls on a sphere and collides with itself, one thread: `setting`, `frames`, `over_plain`, `ms`,
//! `ms_p95`, `ms_most`, medians of the phases (`predict_ms`, `detect_ms`, `color_ms`, `solve_ms`, `guard_ms`, `finish_ms`), the most
//! `contacts` and `colors` of a frame, `held_back` (particles, in all), `depth_m` (the worst), `strain` (the edges' mean at the end).
//! `winners.csv`: `stiffness`, `budget`, `kind`, `setting`, `error`. `animation.csv`: `setting`, `rate`, `ms` (per frame at 60 Hz),
//! `over_plain`, `over_plain_q1`, `over_plain_q3`, `strain` (at the end). `stability.csv`: `setting`, `stiffness`, `iterations`, `speed`
//! (the largest). `bars.csv`: `bar`, `asked`, `reached` (the median), `q1`, `q3`, `met`, `ms` (where it is a time).

mod animation;
mod bars;
mod drape;
mod factor;
mod frames;
mod plain;
#[cfg(feature = "rapier")]
mod rapier;
mod scenes;
mod stability;
mod sweeps;
mod times;

use std::path::PathBuf;

use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::figures::FigureError;
use crate::report::{Figure, Progress, Report, RunInfo, Table};

use plain::Plain;
use times::{Clock, Times};

/// How large everything is, and how often it runs.
#[derive(Clone, Debug)]
pub struct Sizes {
    /// Vertices along the sides of the cloths: of A, of the large one, of the one beyond all caches (0: left out).
    pub cloths: [usize; 3],
    /// Cells of B.
    pub bar: [usize; 3],
    /// Runs of each task on A and B; on the large cloths a third of that.
    pub runs: u32,
    /// Frames before the one whose error is measured.
    pub frames_before: u32,
    /// Budgets for one frame \[PLAIN\].
    pub budgets: Vec<f64>,
    /// Length of the animations \[frames of 1/60 s\].
    pub animation: u32,
    /// Length of workload C \[frames of 1/60 s\].
    pub drape: u32,
    /// Frames of 1/30 s, iterations and stiffnesses \[N/m\] of the stability runs.
    pub stability: (u32, Vec<u32>, Vec<f32>),
}

impl Sizes {
    /// Everything.
    pub fn full() -> Self {
        Self {
            cloths: [100, 400, 1000],
            bar: [35, 16, 16],
            runs: 15,
            frames_before: 10,
            budgets: vec![44.0, bars::SHORT, 167.0, bars::LONG],
            animation: 180,
            drape: 120,
            stability: (90, vec![1, 2, 3, 4, 5, 7, 10, 20, 50, 100], vec![1.0, 10.0, 100.0, 1000.0]),
        }
    }

    /// The same scenes without the largest, fewer runs, fewer cases of stability.
    pub fn quick() -> Self {
        Self {
            cloths: [100, 400, 0],
            runs: 5,
            drape: 60,
            stability: (45, vec![1, 4, 20], vec![10.0, 100.0]),
            ..Self::full()
        }
    }
}

/// The start of a command that runs rapier3d's soft bodies too.
pub const WITH_RAPIER: &str = "cargo run --release -p xtask --features rapier --";

/// What a run is asked for.
#[derive(Clone, Debug)]
pub struct Options {
    /// How much of everything.
    pub sizes: Sizes,
    /// Threads of what runs in parallel.
    pub n_threads: usize,
    /// The folder for the tables.
    pub out: PathBuf,
    /// Folder of the source, for the commit.
    pub source: PathBuf,
    /// The command that repeats the run.
    pub command: String,
}

/// Where the report is and what it says.
pub struct Finished {
    /// The page.
    pub page: PathBuf,
    /// Time of each task.
    pub times: Table,
    /// Which setting leaves least of a frame's error.
    pub winners: Table,
    /// Strain and time of animations.
    pub animation: Table,
    /// Workload C: time of a frame by phase.
    pub drapes: Table,
    /// Bars, and whether they are met.
    pub bars: Table,
}

/// One thread, and as many as are compared with it.
struct Pools {
    one: ThreadPool,
    many: ThreadPool,
    n_threads: usize,
}

impl Pools {
    fn new(n_threads: usize) -> Result<Self, FigureError> {
        let pool = |n_threads: usize| {
            let pool = ThreadPoolBuilder::new().num_threads(n_threads).build();
            pool.map_err(|error| FigureError::Threads { n_threads, reason: error.to_string() })
        };
        Ok(Self { one: pool(1)?, many: pool(n_threads)?, n_threads })
    }

    /// Each pool once, with its number of threads.
    fn all(&self) -> impl Iterator<Item = (&ThreadPool, usize)> {
        let many = (self.n_threads > 1).then_some((&self.many, self.n_threads));
        std::iter::once((&self.one, 1)).chain(many)
    }
}

/// Measures everything.
///
/// # Errors
/// A solver that fails where it must not; what cannot be written.
pub fn run(options: &Options, progress: &mut Progress) -> Result<Finished, FigureError> {
    let sizes = &options.sizes;
    let pools = Pools::new(options.n_threads)?;
    progress.figure("simulation", 8);
    let mut times = Times::default();
    let mut clock = Clock::new(Plain::new(&scenes::cloth(sizes.cloths[0], 100.0, true)?.0, scenes::STEP)?);
    progress.step("sweeps of A");
    sweeps::cloth(sizes, &pools, &mut clock, &mut times)?;
    progress.step("sweeps of B");
    sweeps::bar(sizes, &pools, &mut clock, &mut times)?;
    progress.step("sweeps of large cloths");
    let bandwidth = sweeps::large(sizes, &pools, &mut clock, &mut times)?;
    progress.step("errors of one frame");
    let frames = frames::measure(sizes, &pools, &mut clock)?;
    progress.step("animations");
    let animations = animation::measure(sizes, &pools, &mut clock)?;
    progress.step("workload C");
    let drapes = drape::measure(sizes, &pools, &mut clock)?;
    progress.step("stability");
    let stability = stability::measure(sizes, &pools)?;
    progress.step("bars");
    times.push_plain(&clock);

    let bars = bars::judge(&bars::Measured {
        times: &times,
        n_threads: options.n_threads,
        n_tets: 6 * sizes.bar.iter().product::<usize>(),
        bandwidth: &bandwidth,
        frames: &frames,
        animations: &animations,
        drapes: &drapes,
        stability: &stability,
    });
    let times = times.table();
    let winners = frames::winners(&frames, &sizes.budgets);
    let animation = animation::table(&animations);
    let drapes = drape::table(&drapes);
    let info = RunInfo::new("Vivace: solvers measured", &options.command, 0, &options.source)
        .option("Threads", options.n_threads)
        .paragraph("Times per iteration, and as ratios to a plain scalar Gauss-Seidel sweep (PLAIN) over the matrix of workload A, which runs before and after all that is timed. Bars are judged by the median of the ratios; their quartiles, and the median time in ms, stand beside.");
    let mut figure = Figure::new(
        "simulation",
        "Solvers on the CPU",
        &options.command,
        "A: cloth of springs (100 N/m) and hinges, two corners pinned, steps of 1/30 s. B: bar of tetrahedra. One frame's error: relative to what the prediction has, against the answer in double precision, after as many iterations as fit the budget (a multiple of PLAIN) on one thread.",
    )
    .table(bars.clone())
    .table(times.clone())
    .table(winners.clone())
    .table(animation.clone())
    .table(drapes.clone())
    .table(stability::summary(&stability));
    let data = [
        ("times", &times),
        ("frames", &frames::table(&frames)),
        ("winners", &winners),
        ("animation", &animation),
        ("drape", &drapes),
        ("stability", &stability::table(&stability)),
        ("bars", &bars),
    ];
    for (name, table) in data {
        figure = figure.data(Table { name: name.to_owned(), ..table.clone() });
    }
    figure.seconds = Some(progress.done());
    let mut report = Report::create(&options.out, info)?;
    report.add(figure)?;
    Ok(Finished { page: report.finish()?, times, winners, animation, drapes, bars })
}
