//! `cargo xtask simulate`.

use super::*;

const SCENE_RON: &str = "(
    name: \"napkin\",
    bodies: [(
        shape: Cloth(width: 6, height: 6, spacing: 0.1),
        material: Cloth(),
        pins: [Nearest((0, 0, 0))],
    )],
)
";

#[test]
fn simulate_writes_meshes_measures_and_pictures() {
    let bench = Bench::new(&[("napkin.ron", SCENE_RON), ("solver.ron", "(substeps: 2)")]);
    let all = ["--measure", "--every", "2", "--pictures", "--animation", "--solver", "solver.ron"];
    let said = bench.run(&[&["simulate", "napkin.ron", "--frames", "4", "--out", "out"], &all[..]].concat());
    assert_eq!(said.code, 0, "{}", said.err);
    assert!(
        said.out.contains("frames.csv") && said.err.contains("napkin: 4/4 frame 4"),
        "{}{}",
        said.out,
        said.err
    );
    let mut names: Vec<String> = std::fs::read_dir(bench.path("out"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    let frames = ["frame-00000", "frame-00002", "frame-00004"];
    let mut expected = vec!["animation.png".to_owned()];
    expected.extend(frames.iter().flat_map(|frame| [format!("{frame}.obj"), format!("{frame}.png")]));
    expected.push("frames.csv".to_owned());
    assert_eq!(names, expected);
    let mut table = csv::Reader::from_path(bench.path("out/frames.csv")).unwrap();
    assert_eq!(table.headers().unwrap().iter().collect::<Vec<_>>().join(","), CSV_COLUMNS);
    let rows: Vec<csv::StringRecord> = table.records().map(Result::unwrap).collect();
    assert_eq!((rows.len(), &rows[3][0], &rows[3][2], &rows[3][15]), (4, "4", "20", "iterations"));
    assert!((rows[3][1].parse::<f64>().unwrap() - 4.0 / 30.0).abs() < 1e-6);
    assert!(rows[3][5].parse::<f64>().unwrap() > 0.0);
    assert!(rows[3][11].parse::<f64>().unwrap() > 0.0);
    let mesh =
        |frame: usize| vivace_mesh::obj::read(bench.path(&format!("out/{}.obj", frames[frame]))).unwrap();
    assert!(mesh(2).mesh.positions()[35].y < mesh(0).mesh.positions()[35].y);
}

const CSV_COLUMNS: &str = "frame,time_s,iterations,colors,objective,residual_n,last_move_m,backoffs,solve_ms,total_ms,mean_strain,max_strain,particles,torn_corners,tear_ms,stop,detect_ms,color_ms,guard_ms,contacts,contact_colors,left_out,held_back,deepest_m";

#[test]
fn the_trade_of_any_scene_is_measured_and_a_bad_one_refused_by_line() {
    let json = r#"{"bodies": [{"shape": {"Ball": {"n": 1, "radius": 0.5}}, "material": {"Volume": {}}}]}"#;
    let bad = SCENE_RON.replace("spacing: 0.1", "spacing: wide");
    let held = SCENE_RON.replace("Nearest((0, 0, 0))", "Box(min: (0, 9, 0), max: (1, 9, 1))");
    let files = [("napkin.ron", SCENE_RON), ("ball.json", json), ("bad.ron", &bad), ("held.ron", &held)];
    let bench = Bench::new(&files);
    let said = bench.run(&["tradeoff", "napkin.ron", "--quick", "--warm-frames", "1", "--out", "out"]);
    assert_eq!(said.code, 0, "{}", said.err);
    let html = std::fs::read_to_string(bench.path("out/report.html")).unwrap();
    for words in ["tradeoff napkin.ron --quick", "What to take for napkin", "..Solver::default() }"] {
        assert!(html.contains(words), "{words}");
    }
    for (scene, words) in [
        ("bad.ron", &["bad.ron, line 4", "float", "write there"][..]),
        ("held.ron", &["held.ron: body 0 (Cloth): pins[0] selects no particle"]),
        ("gone.ron", &["gone.ron", "curtain"]),
        ("drape", &["drape", "take `collisions` out"]),
    ] {
        let said = bench.run(&["tradeoff", scene, "--out", "out"]);
        assert_eq!(said.code, 1, "{}", said.err);
        assert!(words.iter().all(|word| said.err.contains(word)), "{}", said.err);
    }
    let said = bench.run(&["tradeoff", "ball.json", "--vertices", "9", "--out", "out"]);
    assert!(said.code == 2 && said.err.contains("--vertices is for"), "{}", said.err);
}

#[test]
fn a_simulation_resumes_bit_for_bit() {
    let bench = Bench::new(&[("napkin.ron", SCENE_RON)]);
    let run = |out: &str, more: &[&str]| {
        let said = bench
            .run(&[&["simulate", "napkin.ron", "--quiet", "--format", "none", "--out", out], more].concat());
        assert_eq!((said.code, said.out.as_str(), said.err.as_str()), (0, "", ""));
    };
    run("whole", &["--frames", "6", "--snapshot", "whole.json"]);
    run("first", &["--frames", "2", "--snapshot", "half.json"]);
    run("second", &["--frames", "4", "--resume", "half.json", "--snapshot", "second.json"]);
    let read = |name: &str| std::fs::read_to_string(bench.path(name)).unwrap();
    assert_eq!(read("whole.json"), read("second.json"));
    assert_ne!(read("whole.json"), read("half.json"));
    assert!(read("second/frames.csv").lines().nth(1).unwrap().starts_with("3,"));
}

#[test]
fn volumes_are_written_as_tetrahedra() {
    let scene = "(bodies: [(shape: Beam(cells: (2, 1, 1), spacing: 0.1), material: Volume())])";
    let bench = Bench::new(&[("beam.ron", scene)]);
    let said = bench.run(&["simulate", "beam.ron", "--frames", "1", "--format", "vtk", "--out", "."]);
    assert_eq!(said.code, 0, "{}", said.err);
    assert_eq!(vivace_mesh::vtk::read(bench.path("frame-00001.vtk")).unwrap().mesh.tets().len(), 12);
}

#[test]
fn simulate_says_what_to_do_instead() {
    let bench = Bench::new(&[("napkin.ron", SCENE_RON), ("bad.ron", "(\n  bodis: [])"), ("snap.json", "{}")]);
    for (args, code, words) in [
        (&["bad.ron"][..], 1, "bad.ron, line 2, column 3"),
        (&["tableclth"], 1, "tablecloth, armadillo, beam, curtain"),
        (&["napkin.ron", "--solver", "{\"substeps\": 0}"], 1, "substeps"),
        (&["napkin.ron", "--solver", "{\"steps\": 0}"], 2, "--solver"),
        (&["napkin.ron", "--solver", "none.ron"], 2, "JSON like"),
        (&["napkin.ron", "--budget-ms=-1"], 2, "time budget"),
        (&["napkin.ron", "--budget-ms", "1", "--iterations", "1"], 2, "cannot be used with"),
        (&["napkin.ron", "--resume", "gone.json"], 1, "--snapshot"),
        (&["napkin.ron", "--resume", "snap.json"], 1, "is it a snapshot?"),
        (&["napkin.ron", "--out", "bad.ron"], 1, "cannot write bad.ron"),
    ] {
        let said = bench.run(&[&["simulate"], args].concat());
        assert_eq!((said.code, said.out.as_str()), (code, ""), "{args:?}: {}", said.err);
        assert!(said.err.contains(words), "{words}: {}", said.err);
        assert!(!bench.path("out").exists());
    }
}
