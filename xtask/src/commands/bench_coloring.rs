//! `cargo xtask bench-coloring`: the bars of the colorings, measured in one run.

use std::fmt::Write as _;
use std::path::PathBuf;

use super::reproduce_figures::workspace;
use super::{CommandError, output};
use crate::bench::{self, Options};
use crate::report::{Progress, Table, Value};

/// Measure all colorings as ratios to serial first fit, and print the bars
///
/// Up to a million vertices it takes several minutes. Prints which bars are met and
/// writes the tables (CSV, JSON, one page) with machine, commit and command. The
/// exit code does not depend on the bars: times belong to a machine.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Graphs of up to 100K vertices, fewer runs
    #[arg(long)]
    quick: bool,
    /// Threads of what runs in parallel
    #[arg(long, default_value_t = 2, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    threads: u32,
    /// Seed of colorings and changes
    #[arg(long, default_value_t = 2016, value_name = "S")]
    seed: u64,
    /// Folder of the tables [default: out/bench-coloring in the workspace]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Measures, prints and writes.
pub fn run(args: Args) -> Result<(), CommandError> {
    let quick = if args.quick { " --quick" } else { "" };
    let options = Options {
        most_vertices: if args.quick { 200_000 } else { usize::MAX },
        seconds: if args.quick { 2.0 } else { 10.0 },
        runs: (5, if args.quick { 15 } else { 40 }),
        n_threads: usize::try_from(args.threads).unwrap_or(1),
        seed: args.seed,
        out: args.out.unwrap_or_else(|| workspace().join("out/bench-coloring")),
        source: workspace(),
        command: format!("cargo xtask bench-coloring{quick} --threads {} --seed {}", args.threads, args.seed),
    };
    let mut progress = Progress::new();
    let finished =
        bench::run(&options, &mut progress).map_err(|error| CommandError::Failed(error.to_string()))?;
    drop(progress);
    let mut text = blocks(&finished.ratios);
    text.push_str(&aligned(&finished.bars));
    let _ = writeln!(text, "\n{}", finished.page.display());
    output::print(&text)
}

/// A wide table, a few graphs at a time.
fn blocks(table: &Table) -> String {
    const TITLES: usize = 2;
    const GRAPHS: usize = 4;
    let mut text = format!("{}\n\n", table.name);
    let n_graphs = table.columns.len().saturating_sub(TITLES);
    for start in (0..n_graphs).step_by(GRAPHS) {
        let columns: Vec<usize> =
            (0..TITLES).chain((start..n_graphs.min(start + GRAPHS)).map(|k| TITLES + k)).collect();
        let pick = |row: &Vec<Value>| columns.iter().map(|&c| row[c].clone()).collect();
        let part = Table {
            name: String::new(),
            columns: columns.iter().map(|&c| table.columns[c].clone()).collect(),
            rows: table.rows.iter().map(pick).collect(),
        };
        text.push_str(&aligned(&part));
        text.push('\n');
    }
    text
}

pub(super) fn aligned(table: &Table) -> String {
    let shown: Vec<Vec<String>> = std::iter::once(table.columns.clone())
        .chain(table.rows.iter().map(|row| row.iter().map(Value::shown).collect()))
        .collect();
    let width = |column: usize| shown.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..table.columns.len()).map(width).collect();
    let mut text = String::new();
    for row in &shown {
        let cells = row.iter().zip(&widths).map(|(cell, &width)| format!("{cell:<width$}"));
        let _ = writeln!(text, "{}", cells.collect::<Vec<_>>().join("  ").trim_end());
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wide_tables_are_cut_into_blocks() {
        let table = Table::new("t", &["Task", "Threads", "a", "b", "c", "d", "e"]).row([
            "x".into(),
            1u32.into(),
            1.5.into(),
            "2".into(),
            "3".into(),
            "4".into(),
            "5".into(),
        ]);
        let text = blocks(&table);
        assert_eq!(text.matches("Task  Threads").count(), 2, "{text}");
        assert!(
            text.contains("x     1        1.500  2  3  4\n") && text.contains("x     1        5\n"),
            "{text}"
        );
    }
}
