//! The built program: exit codes, output, files.

#![expect(clippy::unwrap_used, reason = "helpers of tests")]

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::Value;
use tempfile::TempDir;
use vivace_coloring::{Algorithm, Certificate, ConstraintGraph};
use vivace_graph::matrix_market;

/// Vertices 0-1-2-3-0 around a square, 1-3 its diagonal.
const SQUARE_OBJ: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 4\nf 2 3 4\n";
const TET_VTK: &str = "# vtk DataFile Version 3.0\none\nASCII\nDATASET UNSTRUCTURED_GRID\n\
                       POINTS 4 double\n0 0 0\n1 0 0\n0 1 0\n0 0 1\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n";
const RING_MTX: &str = "%%MatrixMarket matrix coordinate real general\n5 5 6\n\
                        1 1 4\n1 2 1\n2 3 1\n3 4 1\n4 5 1\n5 1 1\n";

/// What the program said.
struct Said {
    code: i32,
    out: String,
    err: String,
}

impl Said {
    fn json(&self) -> Value {
        serde_json::from_str(&self.out).unwrap_or_else(|e| panic!("{e}: {}\n{}", self.out, self.err))
    }
}

/// A folder with files, and the program run in it.
struct Bench(TempDir);

impl Bench {
    fn new(files: &[(&str, &str)]) -> Self {
        let bench = Self(tempfile::tempdir().unwrap());
        for (name, text) in files {
            std::fs::write(bench.path(name), text).unwrap();
        }
        bench
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn command(&self, args: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_xtask"));
        command.args(args).current_dir(self.0.path()).stdin(Stdio::null());
        command
    }

    fn run(&self, args: &[&str]) -> Said {
        said(&mut self.command(args))
    }
}

fn said(command: &mut Command) -> Said {
    let output = command.output().unwrap();
    Said {
        code: output.status.code().unwrap(),
        out: String::from_utf8(output.stdout).unwrap(),
        err: String::from_utf8(output.stderr).unwrap(),
    }
}

fn colors(path: &Path) -> Vec<u32> {
    std::fs::read_to_string(path).unwrap().lines().map(|line| line.parse().unwrap()).collect()
}

/// A grid of `side` x `side` vertices with one diagonal to a square.
fn grid(side: u32) -> ConstraintGraph {
    let at = |x: u32, y: u32| y * side + x;
    let mut edges = Vec::new();
    for (x, y) in (0..side).flat_map(|y| (0..side).map(move |x| (x, y))) {
        let neighbors = [(x + 1, y), (x, y + 1), (x + 1, y + 1)];
        let inside = neighbors.into_iter().filter(|&(x, y)| x < side && y < side);
        edges.extend(inside.map(|(nx, ny)| [at(x, y), at(nx, ny)]));
    }
    ConstraintGraph::from_edges((side * side) as usize, &edges).unwrap()
}

#[test]
fn usage_errors_have_code_two_and_name_the_way_out() {
    let bench = Bench::new(&[("ring.mtx", RING_MTX), ("shape.txt", "cone 0 0 0 1 1 0 0 1\n")]);
    for (args, hint) in [
        (&[][..], "Usage: cargo xtask"),
        (&["colour"], "color"),
        (&["inspect"], "FILES"),
        (&["color"], "GRAPH"),
        (&["color", "ring.mtx", "--algorithm", "magic"], "blocked, first-fit"),
        (&["color", "ring.mtx", "--repeat", "0"], "1..=10000"),
        (&["color", "ring.mtx", "--repeat", "99999999999999999999"], "--repeat"),
        (&["color", "ring.mtx", "--threads", "-1"], "invalid value '-1' for '--threads <N>'"),
        (&["color", "ring.mtx", "--threads", "5000"], "0..=1024"),
        (&["color", "ring.mtx", "--out", "-"], "name a file"),
        (&["color", "ring.mtx", "--out", "ring.mtx"], "name another file"),
        (&["color", "ring.mtx", "--hinges"], ".obj"),
        (&["color", "shape.txt"], ".mtx"),
    ] {
        let said = bench.run(args);
        assert_eq!(said.code, 2, "{args:?}: {}", said.err);
        assert!(said.err.contains(hint) && said.out.is_empty(), "{args:?}: {}{}", said.out, said.err);
    }
    assert_eq!(std::fs::read_to_string(bench.path("ring.mtx")).unwrap(), RING_MTX);
}

#[test]
fn inspect_shows_what_is_in_good_files() {
    let shape = "cone 0 0 0 1 1 0 0 1\n";
    let bench = Bench::new(&[
        ("square.OBJ", SQUARE_OBJ),
        ("tet.vtk", TET_VTK),
        ("ring.mtx", RING_MTX),
        ("shape.txt", shape),
    ]);
    let files = ["inspect", "square.OBJ", "tet.vtk", "ring.mtx", "shape.txt"];
    let said = bench.run(&files);
    assert_eq!((said.code, said.err.as_str()), (0, ""));
    for part in [
        "square.OBJ: triangle mesh",
        "4 vertices, 2 triangles, 5 edges, 1 hinge",
        "open (4 boundary edges), manifold, oriented",
        "smallest 45.0 deg",
        "degree 2 to 3, mean 2.50",
        "degree 3 to 3, mean 3.00",
        "tet.vtk: tetrahedral mesh",
        "dihedral 54.7 to 90.0 deg",
        "ring.mtx: graph of a matrix",
        "5 vertices, 5 edges",
        "shape.txt: signed distance function",
        "one piece",
    ] {
        assert!(said.out.contains(part), "{part}: {}", said.out);
    }
    assert!(said.out.lines().all(|line| line.chars().count() <= 80), "{}", said.out);

    let json = bench.run(&[&files[..], &["--json"]].concat()).json();
    let [square, tet, ring, shape] = json.as_array().unwrap().as_slice() else { panic!("{json}") };
    assert_eq!(square["kind"], "triangle_mesh");
    assert_eq!(
        (&square["edges"], &square["hinges"], &square["closed"]),
        (&5.into(), &1.into(), &false.into())
    );
    assert_eq!(square["hinge_graph"]["edges"], 6);
    assert_eq!(square["volume"], Value::Null);
    assert!(square["no_volume_boundary"].as_str().unwrap().contains("edge 0-1"), "{square}");
    assert_eq!((&tet["kind"], &tet["graph"]["degeneracy"]), (&"tetrahedral_mesh".into(), &3.into()));
    assert_eq!((&ring["kind"], &ring["graph"]["max_degree"]), (&"graph".into(), &2.into()));
    assert_eq!((&shape["kind"], &shape["pieces"]), (&"signed_distance".into(), &1.into()));
    assert!(json.as_array().unwrap().iter().all(|file| file["loads"] == true && file["notes"].is_array()));

    std::fs::write(bench.path("thin.txt"), "cone 0 0 0 1e-6 1 0 0 1e-6\n").unwrap();
    let said = bench.run(&["inspect", "thin.txt"]);
    assert!(said.code == 0 && said.out.contains("nothing, so it is thin"), "{}{}", said.out, said.err);
}

#[test]
fn inspect_refuses_bad_files_and_shows_the_others() {
    let bench = Bench::new(&[
        ("nan.obj", "v 0 0 0\nv 1 0 0\nv nan 1 0\nf 1 2 3\n"),
        ("short.mtx", "%%MatrixMarket matrix coordinate pattern general\n3 3 4\n1 2\n2 3\n"),
        ("range.mtx", "%%MatrixMarket matrix coordinate pattern general\n3 3 1\n1 9\n"),
        ("cut.vtk", &TET_VTK[..TET_VTK.len() - 20]),
        ("word.txt", "cone 0 0 0 1 1 0 0 1\nsphere 1\n"),
        ("mesh.stl", "solid"),
        ("tet.vtk", TET_VTK),
    ]);
    let bad =
        ["nan.obj", "short.mtx", "range.mtx", "cut.vtk", "word.txt", "mesh.stl", "gone.obj", "gone.mtx"];
    let files = [&["inspect"], &bad[..], &["tet.vtk"]].concat();
    let said = bench.run(&files);
    assert_eq!(said.code, 1);
    assert!(said.err.contains("8 of 9 files refused"), "{}", said.err);
    for name in bad {
        assert!(said.out.contains(&format!("{name}: REFUSED\n")), "{name}: {}", said.out);
        assert_eq!(bench.run(&["inspect", name]).code, 1);
        assert_eq!(bench.run(&["color", name]).code, 1);
    }
    assert!(said.out.contains("tet.vtk: tetrahedral mesh"), "{}", said.out);

    let said = bench.run(&[&files[..], &["--json"]].concat());
    assert_eq!(said.code, 1);
    let json = said.json();
    let lines: Vec<Option<u64>> = json.as_array().unwrap().iter().map(|file| file["line"].as_u64()).collect();
    assert_eq!((lines[0], lines[2], lines[4], lines[5]), (Some(3), Some(3), Some(2), None));
    let errors: Vec<&str> =
        json.as_array().unwrap().iter().map(|file| file["error"].as_str().unwrap_or("none")).collect();
    assert!(errors[0].contains("nan") && errors[5].contains(".mtx") && errors[8] == "none", "{errors:?}");
    assert!(errors[7].contains("no such file"), "{errors:?}");
    assert!(json[8]["loads"] == true && json[0]["loads"] == false);
}

#[test]
fn color_answers_in_json_and_writes_colors() {
    let bench = Bench::new(&[("ring.mtx", RING_MTX), ("square.obj", SQUARE_OBJ), ("tet.vtk", TET_VTK)]);
    let graph = matrix_market::parse(RING_MTX.as_bytes()).unwrap();
    for algorithm in Algorithm::ALL {
        let said =
            bench.run(&["color", "ring.mtx", "--algorithm", algorithm.name(), "--out", "c", "--repeat", "2"]);
        assert_eq!((said.code, said.err.as_str()), (0, ""), "{algorithm}");
        let json = said.json();
        let keys: Vec<&String> = json.as_object().unwrap().keys().collect();
        let first = ["vertices", "edges", "max_degree", "colors", "rounds", "balance", "median_ms"];
        assert_eq!(keys[..7], first);
        assert_eq!(
            (&json["vertices"], &json["edges"], &json["max_degree"]),
            (&5.into(), &5.into(), &2.into())
        );
        assert_eq!((&json["algorithm"], &json["repeats"]), (&algorithm.name().into(), &2.into()));
        assert_eq!(json["certificate"], "proper and complete");
        let [min, median, max] = ["min_ms", "median_ms", "max_ms"].map(|key| json[key].as_f64().unwrap());
        assert!(0.0 < min && min <= median && median <= max, "{json}");
        let certificate = Certificate::check(&graph, &colors(&bench.path("c"))).unwrap();
        assert_eq!(json["colors"], certificate.n_colors);
    }
    assert_eq!(bench.run(&["color", "square.obj"]).json()["colors"], 3);
    assert_eq!(bench.run(&["color", "square.obj", "--hinges"]).json()["colors"], 4);
    assert_eq!(bench.run(&["color", "tet.vtk"]).json()["colors"], 4);
    assert_eq!(bench.run(&["color", "tet.vtk"]).json()["algorithm"], Algorithm::BlockedFirstFit.name());
}

#[test]
fn colors_depend_on_the_seed_and_not_on_the_threads() {
    let bench = Bench::new(&[]);
    let graph = grid(90);
    let mut text = Vec::new();
    matrix_market::write(&graph, &mut text).unwrap();
    std::fs::write(bench.path("grid.mtx"), text).unwrap();
    for algorithm in ["blocked", "vivace", "jones-plassmann"] {
        let colors_with = |threads: &str, seed: &str, passes: &[&str]| {
            let args = ["color", "grid.mtx", "--repeat", "1", "--out", "colors", "--algorithm", algorithm];
            let said = bench.run(&[&args[..], &["--threads", threads, "--seed", seed], passes].concat());
            assert_eq!(said.code, 0, "{}", said.err);
            assert_eq!(said.json()["threads"].to_string(), threads);
            let colors = colors(&bench.path("colors"));
            assert_eq!(said.json()["colors"], Certificate::check(&graph, &colors).unwrap().n_colors);
            (colors, said.json())
        };
        let (one, _) = colors_with("1", "7", &[]);
        assert_eq!(one, colors_with("2", "7", &[]).0, "{algorithm}");
        assert_eq!(one == colors_with("2", "8", &[]).0, algorithm == "blocked", "{algorithm}");
        let (_, passed) = colors_with("2", "7", &["--reduce", "--balance"]);
        assert_eq!(passed["passes"], serde_json::json!(["reduce", "balance"]));
        assert!(passed["colors"] == 3 && passed["balance"].as_f64().unwrap() < 1.05, "{passed}");
    }
}

#[test]
fn a_graph_of_nothing_and_one_without_edges_are_colored() {
    let bench = Bench::new(&[
        ("alone.mtx", "%%MatrixMarket matrix coordinate pattern general\n3 3 0\n"),
        ("nothing.mtx", "%%MatrixMarket matrix coordinate pattern general\n0 0 0\n"),
    ]);
    let json = bench.run(&["color", "alone.mtx", "--out", "c"]).json();
    assert_eq!((&json["colors"], colors(&bench.path("c"))), (&1.into(), vec![0, 0, 0]));
    let json = bench.run(&["color", "nothing.mtx", "--out", "c"]).json();
    assert_eq!((&json["colors"], colors(&bench.path("c"))), (&0.into(), vec![]));
    assert_eq!(bench.run(&["inspect", "nothing.mtx", "alone.mtx"]).code, 0);
}

#[test]
fn an_output_that_cannot_be_or_is_not_needed_leaves_nothing_behind() {
    let bench = Bench::new(&[("ring.mtx", RING_MTX), ("bad.mtx", "no"), ("kept", "as it was")]);
    std::fs::create_dir(bench.path("folder")).unwrap();
    for target in ["no/such/folder/c", "folder"] {
        let said = bench.run(&["color", "ring.mtx", "--out", target]);
        assert_eq!((said.code, said.out.as_str()), (1, ""));
        assert!(said.err.contains("cannot write") && said.err.contains("--out"), "{}", said.err);
    }
    assert_eq!(bench.run(&["color", "bad.mtx", "--out", "new"]).code, 1);
    assert!(!bench.path("new").exists());
    assert_eq!(bench.run(&["color", "bad.mtx", "--out", "kept"]).code, 1);
    assert_eq!(std::fs::read_to_string(bench.path("kept")).unwrap(), "as it was");
    assert_eq!(bench.run(&["color", "ring.mtx", "--out", "kept"]).code, 0);
    assert_eq!(colors(&bench.path("kept")).len(), 5);
}

#[path = "cli/simulate.rs"]
mod simulate;
