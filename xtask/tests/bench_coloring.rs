//! The bars on small graphs and one run each: what is counted is checked, times are not.

use std::path::Path;

use xtask::bench::{self, Options};
use xtask::report::{Progress, Value};

#[test]
fn bars_and_tables_are_written() {
    let folder = tempfile::tempdir().unwrap();
    let options = Options {
        most_vertices: 10_000,
        seconds: 0.0,
        runs: (1, 1),
        n_threads: 2,
        seed: 3,
        out: folder.path().to_owned(),
        source: Path::new(env!("CARGO_MANIFEST_DIR")).join(".."),
        command: "cargo xtask bench-coloring".to_owned(),
    };
    let finished = bench::run(&options, &mut Progress::silent()).unwrap();
    assert!(finished.page.exists() && folder.path().join("report.json").exists());

    let head = include_str!("../src/bench/mod.rs");
    for file in ["bench-runs.csv", "bench-bars.csv"] {
        let csv = std::fs::read_to_string(folder.path().join(file)).unwrap();
        for column in csv.lines().next().unwrap().split(',') {
            assert!(head.contains(&format!("`{column}`")), "{file}: column {column} is not documented");
        }
    }
    // What depends neither on the clock nor on a seed must be met by every machine.
    let counted = ["reduce: colors", "blocks: colors", "before", "other colorings", "class over mean"];
    let bars = finished.bars.rows.iter().filter(|row| {
        let Value::Text(bar) = &row[0] else { return false };
        counted.iter().any(|word| bar.contains(word))
    });
    let mut n_bars = 0;
    for row in bars {
        assert_eq!(row[3], Value::Flag(true), "{row:?}");
        n_bars += 1;
    }
    assert_eq!(n_bars, 12);
}
