//! The bars that the project holds itself to. Those that were set in milliseconds are multiples of PLAIN, which took 0.09 ms where they
//! were set.

use super::WITH_RAPIER;
use super::animation::Animation;
use super::drape::{self, Drape};
use super::frames::{self, Kind, Left};
use super::stability::{self, Fastest};
use super::sweeps::{Bandwidth, SUBSTEP, SWEEP};
use super::times::{OverPlain, Reading, Times};
use crate::report::{Table, Value};

/// Budgets that errors are asked for: 8 and 25 ms where PLAIN takes 0.09 ms \[PLAIN\].
pub(super) const SHORT: f64 = 89.0;
/// See [`SHORT`].
pub(super) const LONG: f64 = 278.0;

/// No particle of a cloth that hangs together is ever as fast \[m/s\].
const FAST: f64 = 100.0;

/// What the bars are judged by.
pub(super) struct Measured<'a> {
    pub(super) times: &'a Times,
    pub(super) n_threads: usize,
    pub(super) n_tets: usize,
    pub(super) bandwidth: &'a [Bandwidth],
    pub(super) frames: &'a [Left],
    pub(super) animations: &'a [Animation],
    pub(super) drapes: &'a [Drape],
    pub(super) stability: &'a [Fastest],
}

/// Whether to stay below or above; or nothing is asked, and it is shown.
#[derive(Clone, Copy)]
enum Asked {
    AtMost(f64),
    AtLeast(f64),
    Nothing,
}

/// A row for each bar, those that have none of their own to judge them left out.
pub(super) fn judge(measured: &Measured<'_>) -> Table {
    let mut judge =
        Judge { table: Table::new("Bars", &["bar", "asked", "reached", "q1", "q3", "met", "ms"]), measured };
    judge.sweeps();
    judge.others();
    judge.tets();
    judge.threads();
    judge.frames();
    judge.animations();
    judge.drapes();
    judge.stability();
    judge.table
}

struct Judge<'a> {
    table: Table,
    measured: &'a Measured<'a>,
}

impl Judge<'_> {
    /// What has no time of its own.
    fn push(&mut self, bar: &str, asked: Asked, reached: &Reading) {
        self.push_row(bar, asked, reached, None);
    }

    /// Over PLAIN, and in ms beside.
    fn push_time(&mut self, bar: &str, asked: Asked, reached: &OverPlain) {
        self.push_row(&format!("{bar}, over PLAIN"), asked, &reached.ratio, Some(&reached.ms));
    }

    fn push_row(&mut self, bar: &str, asked: Asked, reached: &Reading, ms: Option<&Reading>) {
        if reached.is_empty() {
            return;
        }
        let median = reached.median();
        let (shown, met) = match asked {
            Asked::AtMost(limit) => (format!("at most {limit}"), Some(median <= limit + 1e-9)),
            Asked::AtLeast(limit) => (format!("at least {limit}"), Some(median >= limit - 1e-9)),
            Asked::Nothing => (String::new(), None),
        };
        let quartile = |q: f64| Value::from((reached.len() > 1).then(|| reached.quantile(q)));
        self.table.push([
            bar.into(),
            shown.into(),
            median.into(),
            quartile(0.25),
            quartile(0.75),
            met.into(),
            ms.map(Reading::median).into(),
        ]);
    }

    fn sweeps(&mut self) {
        let times = self.measured.times;
        self.push("plain sweep of A (PLAIN) [ms]", Asked::Nothing, &times.plain().ms);
        let bars = [
            ("PD fused", Asked::AtMost(1.1)),
            ("PD blocks", Asked::AtMost(3.0)),
            ("PD split", Asked::Nothing),
            ("PD linear sweep", Asked::Nothing),
            ("XPBD, springs only", Asked::AtMost(1.0)),
            ("XPBD", Asked::Nothing),
            ("PD direct", Asked::Nothing),
        ];
        for (task, asked) in bars {
            self.push_time(&format!("A, {task}"), asked, &times.of("A", task, 1));
        }
        for n in [10, 50] {
            let plain = times.of("A", &format!("SOR of {n} iterations"), 1).ratio;
            let safe = times.of("A", &format!("SOR of {n} iterations, safeguard"), 1).ratio;
            let more = safe.with(&plain, |safe, plain| safe / plain - 1.0);
            self.push(&format!("A, what the safeguard adds to {n} iterations"), Asked::Nothing, &more);
        }
        let sweep = times.of("A", "PD linear sweep", 1).ratio;
        let share = times.of("A", "PD split", 1).ratio.with(&sweep, |all, sweep| (all - sweep) / all);
        self.push("A, share of the local step in PD split", Asked::Nothing, &share);
    }

    /// Beside what others do with the same.
    fn others(&mut self) {
        let times = self.measured.times;
        let of = |task| times.of("A", task, 1).ratio;
        let local = of("PD split").with(&of("PD linear sweep"), |all, sweep| all - sweep);
        let solve = of("PD direct").with(&local, |all, local| all - local);
        let over_faer = solve.with(&of("faer, solve"), |ours, faer| ours / faer);
        self.push(
            "A, PD direct without its local step, over faer's own solve in f32",
            Asked::AtMost(1.2),
            &over_faer,
        );
        if cfg!(feature = "rapier") {
            let over = |rival, task| of(rival).with(&of(task), |rival, ours| rival / ours);
            let bar = "A, rapier3d's substep of one sweep over PD fused";
            self.push(bar, Asked::AtLeast(10.0), &over(SUBSTEP, "PD fused"));
            let bar = "A, rapier3d's further sweep, directions frozen, over PD linear sweep";
            self.push(bar, Asked::Nothing, &over(SWEEP, "PD linear sweep"));
        } else {
            let bar = format!("A, rapier3d over PD fused: run {WITH_RAPIER} bench-simulation");
            self.table.push([
                bar.into(),
                "at least 10".into(),
                Value::Missing,
                Value::Missing,
                Value::Missing,
                Value::Missing,
                Value::Missing,
            ]);
        }
    }

    fn tets(&mut self) {
        let times = self.measured.times;
        for (task, asked) in [
            ("XPBD edges and volume", Asked::AtMost(9.0)),
            ("PD strain, split", Asked::Nothing),
            ("PD strain, fused", Asked::Nothing),
        ] {
            self.push_time(&format!("B, {task}"), asked, &times.of("B", task, 1));
        }
        let scale = 55_000.0 / self.measured.n_tets.max(1) as f64;
        let local = |kind: &str, how: &str, n_threads| {
            let sweep = times.of("B", &format!("PD {kind}, linear sweep"), n_threads);
            let split = times.of("B", &format!("PD {kind}, split{how}"), n_threads);
            split.with(&sweep, |all, sweep| (all - sweep) * scale)
        };
        // 3 ms.
        let most = Asked::AtMost(33.0);
        for (kind, how, asked) in
            [("strain", "", most), ("strain", ", stretched", most), ("volume", ", stretched", Asked::Nothing)]
        {
            let bar = format!("B, local step of 55K tetrahedra, {kind}{how}, gathered");
            self.push_time(&format!("{bar}, 1 thread"), asked, &local(kind, how, 1));
            if self.measured.n_threads > 1 {
                let n = self.measured.n_threads;
                self.push_time(&format!("{bar}, {n} threads"), Asked::Nothing, &local(kind, how, n));
            }
        }
    }

    fn threads(&mut self) {
        let Measured { times, n_threads, bandwidth, .. } = *self.measured;
        if n_threads > 1 {
            let bars = [
                ("A", "PD fused", Asked::AtLeast(1.7)),
                ("A", "PD blocks", Asked::Nothing),
                ("A", "XPBD, springs only", Asked::Nothing),
                ("B", "XPBD edges and volume", Asked::Nothing),
                ("B", "PD strain, split", Asked::Nothing),
                ("large cloth", "PD fused", Asked::AtLeast(1.9)),
                ("large cloth", "PD linear sweep", Asked::Nothing),
            ];
            for (workload, task, asked) in bars {
                let many = times.of(workload, task, n_threads).ratio;
                let gain = times.of(workload, task, 1).ratio.with(&many, |one, many| one / many);
                self.push(&format!("{workload}, {task}: times faster on {n_threads} threads"), asked, &gain);
            }
        }
        for of in bandwidth {
            let n = of.n_threads;
            self.push(&format!("copy, {n} threads [GB/s]"), Asked::Nothing, &Reading::one(of.copy));
            let share = of.sweep.map(|sweep| sweep / of.copy);
            let bar = format!("huge cloth, linear sweep: share of the copy's bandwidth, {n} threads");
            self.push(&bar, Asked::AtLeast(0.6), &share);
        }
    }

    fn frames(&mut self) {
        // What is fastest must be stable too.
        let worst = stability::worst(self.measured.stability, FAST);
        let is_stable = |left: &&Left| {
            left.kind != Kind::Relaxation
                || worst.iter().any(|worst| worst.setting == left.name() && worst.n_fast == 0)
        };
        let bars = [
            (Kind::Relaxation, SHORT, Asked::AtMost(0.93)),
            (Kind::Relaxation, LONG, Asked::AtMost(0.82)),
            (Kind::Direct, SHORT, Asked::AtMost(0.31)),
            (Kind::Direct, LONG, Asked::AtMost(0.21)),
            (Kind::Rival, SHORT, Asked::Nothing),
            (Kind::Rival, LONG, Asked::Nothing),
        ];
        let plain = self.measured.times.plain().ms.median();
        for (kind, budget, asked) in bars {
            let stable = self.measured.frames.iter().filter(is_stable);
            let best = frames::best(stable, 100.0, budget, kind);
            // A rival need not be there.
            if best.is_some() || kind != Kind::Rival {
                let name = best.map_or("none is stable".to_owned(), Left::name);
                let error = best.map_or(f64::INFINITY, |left| left.error);
                let bar = format!("error of a frame of A after {budget} PLAIN, {name}");
                let ms = Reading::one(budget * plain);
                self.push_row(&bar, asked, &Reading::one(error), Some(&ms));
            }
        }
    }

    fn animations(&mut self) {
        let good = self.measured.animations.iter().filter(|one| one.rate == 60 && one.strain < 0.016);
        let median = |one: &Animation| one.times.ratio.median();
        let cheapest = good.min_by(|a, b| median(a).total_cmp(&median(b)));
        let bar = "mean strain below 1.6% at 60 Hz";
        if let Some(one) = cheapest {
            let bar = format!("{bar}: {} ({:.2}%)", one.setting, 100.0 * one.strain);
            self.push_time(&bar, Asked::AtMost(17.0), &one.times);
        } else {
            self.push(&format!("{bar}: none"), Asked::AtMost(17.0), &Reading::one(f64::INFINITY));
        }
    }

    /// Workload C.
    fn drapes(&mut self) {
        let drapes = self.measured.drapes;
        let is_asked =
            |one: &drape::Drape| [drape::DEFAULT, drape::RECOMMENDED].contains(&one.setting.as_str());
        for one in drapes {
            // 15 ms.
            let asked = if is_asked(one) { Asked::AtMost(167.0) } else { Asked::Nothing };
            let bar = format!("C, a frame, {} ({:.2}% mean strain)", one.setting, 100.0 * one.strain);
            self.push_time(&bar, asked, &one.times);
        }
        for one in drapes.iter().filter(|one| is_asked(one)) {
            let of_most = Reading::one(one.times.ratio.quantile(0.95));
            let bar = format!("C, {}: 95 of 100 frames take less than, over PLAIN", one.setting);
            self.push(&bar, Asked::Nothing, &of_most);
            // 0.5 ms.
            let bar = format!("C, {}: contacts made constraints, coloring included", one.setting);
            self.push_time(&bar, Asked::AtMost(5.6), one.coloring());
        }
    }

    fn stability(&mut self) {
        for worst in stability::worst(self.measured.stability, FAST) {
            let asked = if worst.is_guarded { Asked::AtMost(FAST) } else { Asked::Nothing };
            let bar =
                format!("stability, {}: largest speed [m/s] ({} cases beyond)", worst.setting, worst.n_fast);
            self.push(&bar, asked, &Reading::one(worst.speed));
        }
    }
}
