//! The bars of the solvers on tiny scenes and one run each: the form is checked, times are not.

use std::path::Path;

use xtask::bench_simulation::{self, Options, Sizes};
use xtask::report::{Progress, Value};

#[test]
fn bars_and_tables_are_written() {
    let folder = tempfile::tempdir().unwrap();
    let options = Options {
        sizes: Sizes {
            cloths: [8, 12, 16],
            bar: [4, 2, 2],
            runs: 1,
            frames_before: 1,
            budgets: vec![89.0, 278.0],
            animation: 10,
            drape: 2,
            stability: (3, vec![1, 4], vec![10.0]),
        },
        n_threads: 2,
        out: folder.path().to_owned(),
        source: Path::new(env!("CARGO_MANIFEST_DIR")).join(".."),
        command: "cargo xtask bench-simulation".to_owned(),
    };
    let finished = bench_simulation::run(&options, &mut Progress::silent()).unwrap();
    assert!(finished.page.exists() && folder.path().join("report.json").exists());

    let head = include_str!("../src/bench_simulation/mod.rs");
    for name in ["times", "frames", "winners", "animation", "drape", "stability", "bars"] {
        let file = format!("simulation-{name}.csv");
        let csv = std::fs::read_to_string(folder.path().join(&file)).unwrap();
        for column in csv.lines().next().unwrap().split(',') {
            assert!(head.contains(&format!("`{column}`")), "{file}: column {column} is not documented");
        }
        assert!(csv.lines().count() > 1, "{file} is empty");
    }
    // Bars on one and on two threads, on all scenes.
    let asked = |row: &&Vec<Value>| row[1] != Value::from("");
    assert_eq!(finished.bars.rows.iter().filter(asked).count(), 7 + 2 + 2 + 4 + 1 + 12 + 5);
    let has_rapier = cfg!(feature = "rapier");
    for row in finished.bars.rows.iter().filter(asked) {
        let is_known = has_rapier || !row[0].shown().contains("rapier3d");
        assert_eq!(matches!(row[5], Value::Flag(_)), is_known, "{row:?}");
    }
    for table in [&finished.times, &finished.winners, &finished.animation] {
        let is_rival = |value: &Value| value.shown().contains("rapier3d");
        assert_eq!(table.rows.iter().flatten().any(is_rival), has_rapier, "{}", table.name);
    }
    let stability = finished.bars.rows.iter().filter(|row| row[0].shown().starts_with("stability"));
    for row in stability.filter(asked) {
        assert_eq!(row[5], Value::Flag(true), "{row:?}");
    }
}
