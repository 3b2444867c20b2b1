//! Times of tasks, and their ratios to PLAIN.

use crate::report::{Table, Value, quantile};

/// All runs of a task.
#[derive(Clone, Debug)]
pub struct Timed {
    /// On what.
    pub workload: &'static str,
    /// What.
    pub task: String,
    /// On how many threads.
    pub n_threads: usize,
    /// Time per iteration \[ms\], sorted.
    ms: Vec<f64>,
}

impl Timed {
    /// The time below which the share `q` of the runs lies \[ms\].
    pub fn quantile(&self, q: f64) -> f64 {
        quantile(&self.ms, q)
    }

    /// The shortest \[ms\].
    pub fn least(&self) -> f64 {
        self.quantile(0.0)
    }

    /// The median \[ms\].
    pub fn median(&self) -> f64 {
        self.quantile(0.5)
    }
}

/// All tasks.
#[derive(Clone, Debug, Default)]
pub struct Times {
    all: Vec<Timed>,
}

/// Two readings of one thing: from the best runs and from the medians.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reading {
    pub(super) least: f64,
    pub(super) median: f64,
}

impl Reading {
    /// What has no spread.
    pub(super) fn one(value: f64) -> Self {
        Self { least: value, median: value }
    }

    /// The same of both.
    pub(super) fn map(self, f: impl Fn(f64) -> f64) -> Self {
        Self { least: f(self.least), median: f(self.median) }
    }

    /// Of two readings, each with its like.
    pub(super) fn with(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self { least: f(self.least, other.least), median: f(self.median, other.median) }
    }
}

impl Times {
    /// The workload that PLAIN sweeps over.
    pub const PLAIN: (&'static str, &'static str) = ("A", "plain sweep");

    /// Adds a run.
    pub fn push(&mut self, workload: &'static str, task: &str, n_threads: usize, ms: f64) {
        let is_it = |t: &&mut Timed| t.workload == workload && t.task == task && t.n_threads == n_threads;
        if let Some(timed) = self.all.iter_mut().find(is_it) {
            let at = timed.ms.partition_point(|&other| other < ms);
            timed.ms.insert(at, ms);
        } else {
            self.all.push(Timed { workload, task: task.to_owned(), n_threads, ms: vec![ms] });
        }
    }

    /// The runs of a task.
    pub fn of(&self, workload: &str, task: &str, n_threads: usize) -> Option<&Timed> {
        self.all.iter().find(|t| t.workload == workload && t.task == task && t.n_threads == n_threads)
    }

    /// Milliseconds of a task; NaN if it was not run.
    pub(super) fn ms(&self, workload: &str, task: &str, n_threads: usize) -> Reading {
        let timed = self.of(workload, task, n_threads);
        timed.map_or(Reading::one(f64::NAN), |t| Reading { least: t.least(), median: t.median() })
    }

    /// Time of a task over PLAIN; NaN if it was not run.
    pub(super) fn ratio(&self, workload: &str, task: &str, n_threads: usize) -> Reading {
        self.ms(workload, task, n_threads).with(self.plain(), |task, plain| task / plain)
    }

    /// Time of PLAIN \[ms\].
    pub(super) fn plain(&self) -> Reading {
        self.ms(Self::PLAIN.0, Self::PLAIN.1, 1)
    }

    /// A row for each task.
    pub fn table(&self) -> Table {
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
            "over_plain_min",
        ];
        let mut table = Table::new("Time per iteration", &columns);
        for timed in &self.all {
            let ratio = self.ratio(timed.workload, &timed.task, timed.n_threads);
            let row: [Value; 10] = [
                timed.workload.into(),
                timed.task.as_str().into(),
                timed.n_threads.into(),
                timed.ms.len().into(),
                timed.median().into(),
                timed.quantile(0.25).into(),
                timed.quantile(0.75).into(),
                timed.least().into(),
                ratio.median.into(),
                ratio.least.into(),
            ];
            table.push(row);
        }
        table
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ratios_are_of_like_with_like() {
        let mut times = Times::default();
        for (task, ms) in [("x", [4.0, 2.0, 9.0]), (Times::PLAIN.1, [1.0, 3.0, 2.0])] {
            ms.iter().for_each(|&ms| times.push("A", task, 1, ms));
        }
        let ratio = times.ratio("A", "x", 1);
        assert_eq!((ratio.least, ratio.median), (2.0, 2.0));
        assert!(times.ratio("A", "x", 2).least.is_nan());
        assert_eq!(times.table().rows.len(), 2);
    }
}
