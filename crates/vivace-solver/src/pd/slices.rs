//! The rows of Y as a sweep reads them: eight vertices of a color at a time (sliced ELLPACK).
//!
//! In a slot of a slice each lane has one entry of its row. On a regular mesh the columns of a slot often follow one another as the
//! vertices do: a *run*, which is three loads. What is left is gathered.

use std::ops::Range;

use wide::f32x8;

use super::points::{LANES, Lanes3, Points};
use super::rows::Rows;

/// All rows, eight by eight.
#[derive(Debug, Clone, Default)]
pub(crate) struct Slices {
    /// First vertex, and how many of the lanes are vertices.
    pub(crate) slices: Vec<(usize, usize)>,
    /// The slices of each color.
    pub(crate) colors: Vec<Range<usize>>,
    /// Entries with a spring in them, and those without.
    pub(crate) springs: Springs,
    pub(crate) others: Slots,
}

/// Entries with a spring in them.
#[derive(Debug, Clone, Default)]
pub(crate) struct Springs {
    pub(crate) slots: Slots,
    /// k l \[N\].
    pub(crate) pulls: Vec<f32x8>,
    /// k \[N/m\].
    pub(crate) stiffness: Vec<f32x8>,
    /// Share / k \[m/N\].
    pub(crate) compliance: Vec<f32x8>,
}

/// Slots of slices. Where a lane has no entry its weight is 0.
#[derive(Debug, Clone, Default)]
pub(crate) struct Slots {
    /// Slots of slice s: `offsets[s]..offsets[s + 1]`, runs first, up to `run_ends[s]`.
    offsets: Vec<u32>,
    run_ends: Vec<u32>,
    /// Of a run: the column of lane 0. Else a place in `gathered`.
    columns: Vec<u32>,
    gathered: Vec<[u32; LANES]>,
    /// −Y_ij \[N/m\].
    pub(crate) weights: Vec<f32x8>,
    /// The part of flat hinges in it times the entry's share \[N/m\]. An entry towards a free particle stands in two rows and has
    /// half of the energy in each.
    pub(crate) linear: Vec<f32x8>,
}

/// Slots that a gather costs as much as, about: decides what is a run.
const GATHER_COST: usize = 3;

/// An entry of the row in `lane`: `entry` of [`Rows`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Entry {
    /// Column less lane, the same along a run.
    start: i64,
    lane: usize,
    entry: usize,
}

/// Where the lanes of a slot are in [`Rows`].
type Source = [Option<usize>; LANES];

impl Slices {
    /// Slices of `rows`. A class is a range of them.
    pub(crate) fn new(rows: &Rows, classes: &[Range<usize>]) -> Self {
        let mut all = Self::default();
        for class in classes {
            let first_slice = all.slices.len();
            for first in class.clone().step_by(LANES) {
                let n = (class.end - first).min(LANES);
                all.slices.push((first, n));
                let section = |is_spring: bool| {
                    let entries = move |lane: usize| {
                        let i = first + lane;
                        let middle = rows.spring_ends[i] as usize;
                        let (start, end) = (rows.offsets[i] as usize, rows.offsets[i + 1] as usize);
                        if is_spring { start..middle } else { middle..end }
                    };
                    let of_lane = move |(lane, number): (usize, i64)| {
                        let start = move |entry: usize| i64::from(rows.columns[entry]) - number;
                        entries(lane).map(move |entry| Entry { start: start(entry), lane, entry })
                    };
                    (0..n).zip(0..).flat_map(of_lane)
                };
                for source in all.springs.slots.push_slice(first, section(true), rows) {
                    all.springs.pulls.push(pick(&source, |entry| rows.pulls[entry]));
                    all.springs.stiffness.push(pick(&source, |entry| rows.stiffness[entry]));
                    let compliance = |entry: usize| rows.share(entry) / rows.stiffness[entry];
                    all.springs.compliance.push(pick(&source, compliance));
                }
                all.others.push_slice(first, section(false), rows);
            }
            all.colors.push(first_slice..all.slices.len());
        }
        all.springs.slots.close();
        all.others.close();
        all
    }

    /// The slice of a vertex.
    pub(crate) fn of_vertex(&self, i: usize) -> usize {
        self.slices.partition_point(|&(first, _)| first <= i) - 1
    }
}

fn pick(source: &Source, value: impl Fn(usize) -> f32) -> f32x8 {
    f32x8::new(source.map(|entry| entry.map_or(0.0, &value)))
}

impl Slots {
    /// Adds the slots of a slice; returns where their lanes came from.
    #[expect(clippy::cast_possible_truncation, reason = "fewer slots than entries; columns are 32-bit")]
    fn push_slice(&mut self, first: usize, entries: impl Iterator<Item = Entry>, rows: &Rows) -> Vec<Source> {
        let mut entries: Vec<Entry> = entries.collect();
        entries.sort_unstable();
        // The longest runs first; what would begin before the points is none. Behind them there is room.
        let mut runs: Vec<&[Entry]> = entries.chunk_by(|a, b| a.start == b.start).collect();
        let is_run = |run: &[Entry]| run[0].start >= 0;
        runs.sort_by_key(|run| (!is_run(run), std::cmp::Reverse(run.len())));
        let n_possible = runs.iter().take_while(|run| is_run(run)).count();
        let n_gathers = |n_runs: usize| {
            let mut counts = [0; LANES];
            runs[n_runs..].iter().copied().flatten().for_each(|entry| counts[entry.lane] += 1);
            counts.into_iter().max().unwrap_or(0)
        };
        let n_runs = (0..=n_possible).min_by_key(|&n| n + GATHER_COST * n_gathers(n)).unwrap_or(0);

        self.offsets.push(self.columns.len() as u32);
        let mut sources = Vec::new();
        for run in &runs[..n_runs] {
            let mut source = Source::default();
            run.iter().for_each(|entry| source[entry.lane] = Some(entry.entry));
            self.columns.push(run[0].start.unsigned_abs() as u32);
            sources.push(source);
        }
        self.run_ends.push(self.columns.len() as u32);
        let mut left: Vec<Entry> = runs[n_runs..].iter().copied().flatten().copied().collect();
        left.sort_unstable_by_key(|entry| (entry.lane, entry.start));
        let mut of_lane = left.chunk_by(|a, b| a.lane == b.lane).map(|row| row.iter()).collect::<Vec<_>>();
        for _ in 0..n_gathers(n_runs) {
            let mut source = Source::default();
            // A lane without an entry points to its own vertex.
            let mut columns: [u32; LANES] = std::array::from_fn(|lane| (first + lane) as u32);
            for entry in of_lane.iter_mut().filter_map(Iterator::next) {
                source[entry.lane] = Some(entry.entry);
                columns[entry.lane] = rows.columns[entry.entry];
            }
            self.columns.push(self.gathered.len() as u32);
            self.gathered.push(columns);
            sources.push(source);
        }
        self.weights.extend(sources.iter().map(|source| pick(source, |entry| rows.weights[entry])));
        let linear = |entry: usize| rows.share(entry) * rows.linear[entry];
        self.linear.extend(sources.iter().map(|source| pick(source, linear)));
        sources
    }

    fn close(&mut self) {
        self.offsets.push(u32::try_from(self.columns.len()).unwrap_or(u32::MAX));
    }

    /// Shows to `f` each slot of `slice`, and the differences between its columns in `q` and `at`.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "sums stay in registers only if it is")]
    pub(crate) fn for_each(&self, slice: usize, q: &Points, at: Lanes3, mut f: impl FnMut(usize, Lanes3)) {
        let (start, end) = (self.offsets[slice] as usize, self.offsets[slice + 1] as usize);
        let middle = self.run_ends[slice] as usize;
        for slot in start..middle {
            f(slot, q.lanes(self.columns[slot] as usize) - at);
        }
        for slot in middle..end {
            f(slot, q.gather(&self.gathered[self.columns[slot] as usize]) - at);
        }
    }
}
