//! The bars that the project holds itself to: limit, what was reached, and on which graph.

use vivace_coloring::{Algorithm, Vivace};

use super::measure::{GraphBench, Sample, Task};
use crate::report::{Table, Value};

/// The best serial first fit of others, in milliseconds on the machine they were measured on.
const BEST_SERIAL: [(&str, f64); 3] = [("cloth-10k", 0.031), ("tets-100k", 2.0), ("cloth-1m", 3.3)];
/// Where the bars on the round-based colorings are set.
const TETS: &str = "tets-100k";

const BLOCKED: Task = Task::Color(Algorithm::BlockedFirstFit);
const VIVACE: Task = Task::Color(Algorithm::Vivace(Vivace::DEFAULT));
const JONES_PLASSMANN: Task = Task::Color(Algorithm::JonesPlassmann { seed: 0 });
const LDF: Task = Task::Color(Algorithm::LargestDegreeFirst { seed: 0 });
const LUBY: Task = Task::Color(Algorithm::Luby { seed: 0 });

/// Whether to stay below or above.
#[derive(Clone, Copy)]
enum Limit {
    AtMost(f64),
    AtLeast(f64),
}

impl Limit {
    fn is_met(self, value: f64) -> bool {
        match self {
            Self::AtMost(limit) => value <= limit + 1e-9,
            Self::AtLeast(limit) => value >= limit - 1e-9,
        }
    }
}

struct Judge<'a> {
    benches: &'a [GraphBench],
    n_threads: usize,
    table: Table,
}

/// A row for each bar; those without a graph in this run are left out.
pub(super) fn judge(benches: &[GraphBench], n_threads: usize) -> Table {
    let table = Table::new("Bars", &["bar", "limit", "reached", "met", "where"]);
    let mut judge = Judge { benches, n_threads, table };
    judge.first_fit();
    judge.passes();
    judge.rounds();
    judge.recoloring();
    judge.table
}

fn is_large(bench: &GraphBench) -> bool {
    bench.workload.n_vertices >= 100_000
}

fn is_shuffled(bench: &GraphBench) -> bool {
    bench.workload.name.contains("shuffled")
}

fn is_hubs(bench: &GraphBench) -> bool {
    bench.workload.name.contains("hubs")
}

/// Whether an even share is so large that a vertex more or less does not show.
fn has_large_classes(bench: &GraphBench, task: Task) -> bool {
    bench.workload.n_vertices as f64 > 100.0 * bench.colors(task, 1)
}

impl Judge<'_> {
    /// The worst of `value` over the graphs that `holds` takes.
    fn worst(
        &mut self,
        bar: &str,
        limit: Limit,
        holds: impl Fn(&GraphBench) -> bool,
        value: impl Fn(&GraphBench) -> f64,
    ) {
        let values = self.benches.iter().filter(|bench| holds(bench)).map(|b| (value(b), b.workload.name));
        let values = values.filter(|(value, _)| !value.is_nan());
        let worst = match limit {
            Limit::AtMost(_) => values.max_by(|a, b| a.0.total_cmp(&b.0)),
            Limit::AtLeast(_) => values.min_by(|a, b| a.0.total_cmp(&b.0)),
        };
        if let Some((value, name)) = worst {
            self.push(bar, limit, value, name);
        }
    }

    fn push(&mut self, bar: &str, limit: Limit, value: f64, place: &str) {
        let shown = match limit {
            Limit::AtMost(limit) => format!("at most {limit}"),
            Limit::AtLeast(limit) => format!("at least {limit}"),
        };
        let met = limit.is_met(value);
        self.table.push([bar.into(), shown.into(), value.into(), met.into(), Value::from(place)]);
    }

    fn first_fit(&mut self) {
        let n = self.n_threads;
        for (name, best) in BEST_SERIAL {
            let is_it = |bench: &GraphBench| bench.workload.name == name;
            let bar = format!(
                "SFF, best run, over the best serial first fit of others, {best} ms on their machine"
            );
            self.worst(&bar, Limit::AtMost(1.3), is_it, |bench| {
                bench.of(Task::SFF, 1).map_or(f64::NAN, |sff| sff.quantile(0.0, |s| s.ms)) / best
            });
        }
        let logs: Vec<f64> = self
            .benches
            .iter()
            .filter(|bench| is_large(bench) && !is_shuffled(bench))
            .map(|bench| bench.ratio(BLOCKED, n).ln())
            .collect();
        if !logs.is_empty() {
            let mean = (logs.iter().sum::<f64>() / logs.len() as f64).exp();
            let bar = format!("first fit in blocks on {n} threads over SFF, geometric mean");
            let place = format!("{} unshuffled graphs of 100K and 1M", logs.len());
            self.push(&bar, Limit::AtMost(0.6), mean, &place);
        }
        let bar = format!("first fit in blocks on {n} threads over SFF");
        self.worst(&bar, Limit::AtMost(1.0), |_| true, |bench| bench.ratio(BLOCKED, n));
        self.worst(
            "first fit in blocks: colors more than SFF",
            Limit::AtMost(1.0),
            |_| true,
            |bench| bench.colors(BLOCKED, 1) - bench.colors(Task::SFF, 1),
        );
        self.worst(
            "first fit in blocks: other colorings on other numbers of threads (1, 2, 7)",
            Limit::AtMost(0.0),
            |_| true,
            |bench| if bench.same_on_all_threads { 0.0 } else { 1.0 },
        );
    }

    fn passes(&mut self) {
        self.worst(
            "reduce: colors more than the best of others",
            Limit::AtMost(0.0),
            |_| true,
            |bench| bench.colors(Task::Reduce, 1) - f64::from(bench.workload.few_colors),
        );
        self.worst("reduce over SFF", Limit::AtMost(6.0), is_tets, |bench| bench.ratio(Task::Reduce, 1));
        let starts = [
            (Task::BalanceFirstFit, Task::SFF),
            (Task::BalanceReduced, Task::Reduce),
            (Task::BalanceVivace, VIVACE),
        ];
        for (task, start) in starts {
            let name = task.name();
            let share = |of: fn(&Sample) -> f64| {
                move |bench: &GraphBench| bench.of(task, 1).map_or(f64::NAN, |t| t.median(of))
            };
            let is_wide = |bench: &GraphBench| has_large_classes(bench, task);
            let largest = share(|s| s.shares.map_or(f64::NAN, |shares| shares.largest));
            let smallest = share(|s| s.shares.map_or(f64::NAN, |shares| shares.smallest));
            self.worst(&format!("{name}: largest class over mean"), Limit::AtMost(1.01), is_wide, largest);
            self.worst(&format!("{name}: smallest class over mean"), Limit::AtLeast(0.95), is_wide, smallest);
            // The coloring that was balanced is one of many seeds: the most colors of any bound it.
            let most = move |bench: &GraphBench| {
                let colors = |s: &Sample| f64::from(s.colors);
                bench.of(start, 1).map_or(f64::NAN, |t| t.quantile(1.0, colors))
            };
            self.worst(
                &format!("{name}: colors more than before"),
                Limit::AtMost(0.0),
                |_| true,
                |bench| bench.colors(task, 1) - most(bench),
            );
            self.worst(&format!("{name} over SFF"), Limit::AtMost(1.0), |_| true, |b| b.ratio(task, 1));
        }
    }

    fn rounds(&mut self) {
        let n = self.n_threads;
        let of = |of: fn(&Sample) -> f64| {
            move |bench: &GraphBench| bench.of(VIVACE, n).map_or(f64::NAN, |t| t.median(of))
        };
        self.worst("Vivace: rounds", Limit::AtMost(8.0), is_large, of(|s| f64::from(s.rounds)));
        self.worst("Vivace: visits per vertex", Limit::AtMost(2.0), is_large, of(|s| s.visits));
        self.worst("Vivace on hubs: colors", Limit::AtMost(10.0), is_hubs, of(|s| f64::from(s.colors)));
        self.worst(
            "Vivace: colors more than Jones\u{2013}Plassmann",
            Limit::AtMost(1.0),
            |_| true,
            |bench| bench.colors(VIVACE, n) - bench.colors(JONES_PLASSMANN, n),
        );
        let limits = [
            ("Vivace", VIVACE, 6.0),
            ("Jones\u{2013}Plassmann", JONES_PLASSMANN, 5.0),
            ("LDF", LDF, 6.0),
            ("Luby", LUBY, 8.0),
        ];
        for (name, task, limit) in limits {
            let bar = format!("{name} on {n} threads over SFF, tetrahedra");
            self.worst(&bar, Limit::AtMost(limit), is_tets, |bench| bench.ratio(task, n));
        }
        for (name, task, _) in limits {
            let bar = format!("{name} on {n} threads over SFF, any graph");
            self.worst(&bar, Limit::AtMost(20.0), |_| true, |bench| bench.ratio(task, n));
        }
        if n == 2 {
            let faster = |bench: &GraphBench| bench.ms(VIVACE, 1) / bench.ms(VIVACE, 2);
            self.worst(
                "Vivace: times faster on 2 threads than on 1, tetrahedra",
                Limit::AtLeast(1.8),
                is_tets,
                faster,
            );
        }
    }

    fn recoloring(&mut self) {
        let n = self.n_threads;
        for (task, full) in
            [(Task::RecolorNearby, Task::FullNearby), (Task::RecolorAnywhere, Task::FullAnywhere)]
        {
            let name = task.name();
            let bar = format!("{name} over first fit in blocks on {n} threads");
            self.worst(&bar, Limit::AtMost(0.1), is_large, |bench| bench.ms(task, n) / bench.ms(full, n));
            self.worst(&format!("{name} over SFF"), Limit::AtMost(0.1), is_large, |b| b.ratio(task, n));
        }
    }
}

fn is_tets(bench: &GraphBench) -> bool {
    bench.workload.name == TETS
}
