//! The bars that the project holds itself to.

use super::WITH_RAPIER;
use super::animation::Animation;
use super::drape::{self, Drape};
use super::frames::{self, Kind, Left};
use super::stability::{self, Fastest};
use super::sweeps::{Bandwidth, SUBSTEP, SWEEP};
use super::times::{Reading, Times};
use crate::report::{Table, Value};

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
        Judge { table: Table::new("Bars", &["bar", "asked", "reached", "met", "by_median"]), measured };
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
    fn push(&mut self, bar: &str, asked: Asked, reached: Reading) {
        if reached.least.is_nan() {
            return;
        }
        let (shown, met) = match asked {
            Asked::AtMost(limit) => (format!("at most {limit}"), Some(reached.least <= limit + 1e-9)),
            Asked::AtLeast(limit) => (format!("at least {limit}"), Some(reached.least >= limit - 1e-9)),
            Asked::Nothing => (String::new(), None),
        };
        self.table.push([bar.into(), shown.into(), reached.least.into(), met.into(), reached.median.into()]);
    }

    fn sweeps(&mut self) {
        let times = self.measured.times;
        self.push("plain sweep of A (PLAIN) [ms]", Asked::Nothing, times.plain());
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
            self.push(&format!("A, {task}, over PLAIN"), asked, times.ratio("A", task, 1));
        }
        for n in [10, 50] {
            let plain = times.ms("A", &format!("SOR of {n} iterations"), 1);
            let safe = times.ms("A", &format!("SOR of {n} iterations, safeguard"), 1);
            let more = safe.with(plain, |safe, plain| safe / plain - 1.0);
            self.push(&format!("A, what the safeguard adds to {n} iterations"), Asked::Nothing, more);
        }
        let share = times
            .ms("A", "PD split", 1)
            .with(times.ms("A", "PD linear sweep", 1), |all, sweep| (all - sweep) / all);
        self.push("A, share of the local step in PD split", Asked::Nothing, share);
    }

    /// Beside what others do with the same.
    fn others(&mut self) {
        let times = self.measured.times;
        let ours = |task| times.ms("A", task, 1);
        let local = ours("PD split").with(ours("PD linear sweep"), |all, sweep| all - sweep);
        let solve = ours("PD direct").with(local, |all, local| all - local);
        let over_faer = solve.with(ours("faer, solve"), |ours, faer| ours / faer);
        self.push(
            "A, PD direct without its local step, over faer's own solve in f32",
            Asked::AtMost(1.2),
            over_faer,
        );
        if cfg!(feature = "rapier") {
            let over = |rival, task| times.ms("A", rival, 1).with(ours(task), |rival, ours| rival / ours);
            let bar = "A, rapier3d's substep of one sweep over PD fused";
            self.push(bar, Asked::AtLeast(10.0), over(SUBSTEP, "PD fused"));
            let bar = "A, rapier3d's further sweep, directions frozen, over PD linear sweep";
            self.push(bar, Asked::Nothing, over(SWEEP, "PD linear sweep"));
        } else {
            let bar = format!("A, rapier3d over PD fused: run {WITH_RAPIER} bench-simulation");
            self.table.push([
                bar.into(),
                "at least 10".into(),
                Value::Missing,
                Value::Missing,
                Value::Missing,
            ]);
        }
    }

    fn tets(&mut self) {
        let times = self.measured.times;
        let xpbd = times.ratio("B", "XPBD edges and volume", 1);
        self.push("B, XPBD edges and volume, over PLAIN", Asked::AtMost(9.0), xpbd);
        self.push("B, PD strain, split, over PLAIN", Asked::Nothing, times.ratio("B", "PD strain, split", 1));
        self.push("B, PD strain, fused, over PLAIN", Asked::Nothing, times.ratio("B", "PD strain, fused", 1));
        let scale = 55_000.0 / self.measured.n_tets.max(1) as f64;
        let local = |kind: &str, how: &str, n_threads| {
            let sweep = times.ms("B", &format!("PD {kind}, linear sweep"), n_threads);
            let split = times.ms("B", &format!("PD {kind}, split{how}"), n_threads);
            split.with(sweep, |all, sweep| (all - sweep) * scale)
        };
        for (kind, how, asked) in [
            ("strain", "", Asked::AtMost(3.0)),
            ("strain", ", stretched", Asked::AtMost(3.0)),
            ("volume", ", stretched", Asked::Nothing),
        ] {
            let bar = format!("B, local step of 55K tetrahedra, {kind}{how}, gathered");
            self.push(&format!("{bar}, 1 thread [ms]"), asked, local(kind, how, 1));
            if self.measured.n_threads > 1 {
                let n = self.measured.n_threads;
                self.push(&format!("{bar}, {n} threads [ms]"), Asked::Nothing, local(kind, how, n));
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
                let many = times.ms(workload, task, n_threads);
                let gain = times.ms(workload, task, 1).with(many, |one, many| one / many);
                self.push(&format!("{workload}, {task}: times faster on {n_threads} threads"), asked, gain);
            }
        }
        for of in bandwidth {
            let n = of.n_threads;
            let copy = Reading::one(of.copy);
            self.push(&format!("copy, {n} threads [GB/s]"), Asked::Nothing, copy);
            let share = of.sweep.with(copy, |sweep, copy| sweep / copy);
            let bar = format!("huge cloth, linear sweep: share of the copy's bandwidth, {n} threads");
            self.push(&bar, Asked::AtLeast(0.6), share);
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
            (Kind::Relaxation, 8.0, Asked::AtMost(0.93)),
            (Kind::Relaxation, 25.0, Asked::AtMost(0.82)),
            (Kind::Direct, 8.0, Asked::AtMost(0.31)),
            (Kind::Direct, 25.0, Asked::AtMost(0.21)),
            (Kind::Rival, 8.0, Asked::Nothing),
            (Kind::Rival, 25.0, Asked::Nothing),
        ];
        for (kind, ms, asked) in bars {
            let stable = self.measured.frames.iter().filter(is_stable);
            let best = frames::best(stable, 100.0, ms, kind);
            // A rival need not be there.
            if best.is_some() || kind != Kind::Rival {
                let name = best.map_or("none is stable".to_owned(), Left::name);
                let error = best.map_or(f64::INFINITY, |left| left.error);
                let bar = format!("error of a frame of A after {ms} ms, {name}");
                self.push(&bar, asked, Reading::one(error));
            }
        }
    }

    fn animations(&mut self) {
        let good = self.measured.animations.iter().filter(|one| one.rate == 60 && one.strain < 0.016);
        let cheapest = good.min_by(|a, b| a.over_plain.least.total_cmp(&b.over_plain.least));
        if let Some(one) = cheapest {
            let bar = format!(
                "mean strain below 1.6% at 60 Hz, over PLAIN: {} ({:.2}%)",
                one.setting,
                100.0 * one.strain
            );
            self.push(&bar, Asked::AtMost(17.0), one.over_plain);
        } else {
            let bar = "mean strain below 1.6% at 60 Hz, over PLAIN: none";
            self.push(bar, Asked::AtMost(17.0), Reading::one(f64::INFINITY));
        }
    }

    /// Workload C.
    fn drapes(&mut self) {
        let drapes = self.measured.drapes;
        for one in drapes {
            let asked = if one.setting == drape::RECOMMENDED { Asked::AtMost(15.0) } else { Asked::Nothing };
            let bar = format!("C, a frame, {} ({:.2}% mean strain) [ms]", one.setting, 100.0 * one.strain);
            self.push(&bar, asked, one.quantile(0.5));
        }
        for one in drapes.iter().filter(|one| one.setting == drape::RECOMMENDED) {
            self.push("C, 95 of 100 frames take less than [ms]", Asked::Nothing, one.quantile(0.95));
            self.push(
                "C, contacts made constraints, recoloring included [ms]",
                Asked::AtMost(0.5),
                one.coloring(),
            );
        }
    }

    fn stability(&mut self) {
        for worst in stability::worst(self.measured.stability, FAST) {
            let asked = if worst.is_guarded { Asked::AtMost(FAST) } else { Asked::Nothing };
            let bar =
                format!("stability, {}: largest speed [m/s] ({} cases beyond)", worst.setting, worst.n_fast);
            self.push(&bar, asked, Reading::one(worst.speed));
        }
    }
}
