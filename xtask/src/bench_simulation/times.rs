//! Times of tasks, and their ratios to PLAIN.

use super::plain::Plain;
use crate::report::{Table, Value, quantile};

/// What was read in each run, in turn.
#[derive(Clone, Debug, Default)]
pub(super) struct Reading(Vec<f64>);

impl Reading {
    /// What has no spread.
    pub(super) fn one(value: f64) -> Self {
        Self(vec![value])
    }

    pub(super) fn push(&mut self, value: f64) {
        self.0.push(value);
    }

    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub(super) fn len(&self) -> usize {
        self.0.len()
    }

    /// The value below which the share `q` of the runs lies; NaN if there are none.
    pub(super) fn quantile(&self, q: f64) -> f64 {
        let mut sorted = self.0.clone();
        sorted.sort_unstable_by(f64::total_cmp);
        quantile(&sorted, q)
    }

    pub(super) fn median(&self) -> f64 {
        self.quantile(0.5)
    }

    /// `f` of each run.
    pub(super) fn map(&self, f: impl Fn(f64) -> f64) -> Self {
        Self(self.0.iter().map(|&value| f(value)).collect())
    }

    /// `f` of each run and the other's of the same turn.
    pub(super) fn with(&self, other: &Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self(self.0.iter().zip(&other.0).map(|(&a, &b)| f(a, b)).collect())
    }
}

/// Times \[ms\], each with its ratio to PLAIN.
#[derive(Clone, Debug, Default)]
pub(super) struct OverPlain {
    pub(super) ms: Reading,
    pub(super) ratio: Reading,
}

impl OverPlain {
    /// Adds `ms`, taken while PLAIN took `plain` \[ms\].
    pub(super) fn push(&mut self, ms: f64, plain: f64) {
        self.ms.push(ms);
        self.ratio.push(ms / plain);
    }

    /// `f`, which a factor common to both passes through, of each run and the other's of the same turn.
    pub(super) fn with(&self, other: &Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self { ms: self.ms.with(&other.ms, &f), ratio: self.ratio.with(&other.ratio, &f) }
    }
}

/// PLAIN, sampled between all that it is compared with: the speed of a machine drifts.
pub(super) struct Clock {
    plain: Plain,
    last: f64,
    /// All samples \[ms\].
    pub(super) samples: Reading,
}

impl Clock {
    pub(super) fn new(mut plain: Plain) -> Self {
        let last = plain.time();
        Self { plain, last, samples: Reading::one(last) }
    }

    /// What `f` returns, and the mean of PLAIN before and after it \[ms\].
    pub(super) fn around<T>(&mut self, f: impl FnOnce() -> T) -> (T, f64) {
        let before = self.last;
        let result = f();
        self.last = self.plain.time();
        self.samples.push(self.last);
        (result, 0.5 * (before + self.last))
    }
}

/// All runs of a task.
#[derive(Clone, Debug)]
struct Timed {
    workload: &'static str,
    task: String,
    n_threads: usize,
    /// Per iteration.
    times: OverPlain,
}

/// All tasks.
#[derive(Clone, Debug, Default)]
pub(super) struct Times {
    all: Vec<Timed>,
}

impl Times {
    /// The workload that PLAIN sweeps over, and its name.
    const PLAIN: (&'static str, &'static str) = ("A", "plain sweep");

    /// Adds a run, taken while PLAIN took `plain` \[ms\].
    pub(super) fn push(&mut self, workload: &'static str, task: &str, n_threads: usize, ms: f64, plain: f64) {
        let is_it = |t: &&mut Timed| t.workload == workload && t.task == task && t.n_threads == n_threads;
        if let Some(timed) = self.all.iter_mut().find(is_it) {
            timed.times.push(ms, plain);
        } else {
            let mut times = OverPlain::default();
            times.push(ms, plain);
            self.all.push(Timed { workload, task: task.to_owned(), n_threads, times });
        }
    }

    /// Adds samples of PLAIN itself.
    pub(super) fn push_plain(&mut self, clock: &Clock) {
        clock.samples.0.iter().for_each(|&ms| self.push(Self::PLAIN.0, Self::PLAIN.1, 1, ms, ms));
    }

    /// The runs of a task; none if it was not run.
    pub(super) fn of(&self, workload: &str, task: &str, n_threads: usize) -> OverPlain {
        let is_it = |t: &&Timed| t.workload == workload && t.task == task && t.n_threads == n_threads;
        self.all.iter().find(is_it).map_or_else(OverPlain::default, |timed| timed.times.clone())
    }

    /// Time of PLAIN.
    pub(super) fn plain(&self) -> OverPlain {
        self.of(Self::PLAIN.0, Self::PLAIN.1, 1)
    }

    /// A row for each task.
    pub(super) fn table(&self) -> Table {
        let columns = [
            "workload",
            "task",
            "threads",
            "runs",
            "ms",
            "ms_q1",
            "ms_q3",
            "ms_min",
            "over_plain",
            "over_plain_q1",
            "over_plain_q3",
        ];
        let mut table = Table::new("Time per iteration", &columns);
        for Timed { workload, task, n_threads, times } in &self.all {
            let row: [Value; 11] = [
                (*workload).into(),
                task.as_str().into(),
                (*n_threads).into(),
                times.ms.len().into(),
                times.ms.median().into(),
                times.ms.quantile(0.25).into(),
                times.ms.quantile(0.75).into(),
                times.ms.quantile(0.0).into(),
                times.ratio.median().into(),
                times.ratio.quantile(0.25).into(),
                times.ratio.quantile(0.75).into(),
            ];
            table.push(row);
        }
        table
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench_simulation::scenes;

    /// A machine that slows down to a third while it runs: ratios do not notice.
    #[test]
    fn ratios_are_of_what_ran_together() {
        let mut times = Times::default();
        for slow in [1.0, 1.5, 3.0] {
            times.push("A", "x", 1, 4.0 * slow, 2.0 * slow);
            times.push("A", "y", 1, 1.0 * slow, 2.0 * slow);
        }
        let (x, y) = (times.of("A", "x", 1), times.of("A", "y", 1));
        assert_eq!([0.25, 0.5, 0.75].map(|q| x.ratio.quantile(q)), [2.0; 3]);
        assert_eq!([0.0, 0.5, 1.0].map(|q| x.ms.quantile(q)), [4.0, 6.0, 12.0]);
        let less = x.with(&y, |x, y| x - y);
        assert_eq!(([0.0, 1.0].map(|q| less.ratio.quantile(q)), less.ms.median()), ([1.5; 2], 4.5));
        assert!(times.of("A", "x", 2).ratio.median().is_nan());
        assert_eq!(times.table().rows.len(), 2);
    }

    #[test]
    fn plain_is_sampled_before_and_after() {
        let (model, _) = scenes::cloth(6, 100.0, true).unwrap();
        let mut clock = Clock::new(Plain::new(&model, scenes::STEP).unwrap());
        let first = clock.last;
        let (seven, plain) = clock.around(|| 7);
        assert_eq!((seven, plain), (7, 0.5 * (first + clock.last)));
        assert_eq!(clock.samples.len(), 2);
    }
}
