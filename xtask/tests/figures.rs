//! The figures end to end, at sizes so small that only their form can be looked at, never a time.

#![expect(clippy::unwrap_used, reason = "a failed test may panic")]

use std::path::{Path, PathBuf};

use vivace_mesh::{ball, obj, vtk};
use xtask::figures::contacts;
use xtask::figures::families::Families;
use xtask::figures::simulation::{self, scenes};
use xtask::figures::{self, Options, Sizes};
use xtask::report::Progress;
use xtask::tradeoff::Effort;

fn tiny() -> Sizes {
    Sizes {
        flag: "--quick",
        fig2: 400,
        fig3: vec![300, 600],
        ablation: 300,
        seeds: 2,
        ablation_seeds: 2,
        seconds: 0.0,
        simulation: simulation::Sizes { vertices: 100, n_frames: 4, every: 2, most_sweeps: 8, still: 60 },
        contacts: contacts::Sizes { noodles: 2, heap: 6, armadillo: 100, n_frames: 3, still: 60 },
        trade: Effort { warm_frames: 1, longest_ms: 0.1, stable_frames: 2, fine_steps: 8 },
        is_reduced: true,
    }
}

fn options(out: &Path, figures: &[&str], meshes: Option<PathBuf>) -> Options {
    let figures = figures.iter().map(|name| (*name).to_owned()).collect();
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    Options {
        sizes: tiny(),
        figures,
        meshes,
        out: out.to_owned(),
        seed: 5,
        n_threads: 2,
        with_gpu: false,
        source,
    }
}

fn read(out: &Path, name: &str) -> String {
    std::fs::read_to_string(out.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Every column of a data file is explained at the head of the file that makes it.
fn columns_are_documented(csv: &str, source: &str) {
    let head: String = source.lines().take_while(|line| line.starts_with("//!")).collect();
    let columns = csv.lines().next().unwrap().split(',');
    for column in columns {
        assert!(head.contains(&format!("`{column}`")), "column {column} is not documented");
    }
}

#[test]
fn both_figures_are_made() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path();
    let page = figures::reproduce(&options(out, &["2", "3"], None), &mut Progress::silent()).unwrap();
    assert_eq!(page, out.join("report.html"));

    let html = read(out, "report.html");
    assert!(html.contains("Bunny stand-in (hare)") && html.contains("STAND-IN for the Armadillo"));
    for command in ["--quick --figure 2 --seed 5 --threads 2", "--quick --figure 3 --seed 5 --threads 2"] {
        assert!(html.contains(&format!("cargo xtask reproduce-figures {command}")), "{command}");
    }
    for file in ["fig2.svg", "fig2.png", "fig3.svg", "fig3.png", "fig3-2.png", "fig3-3.png", "fig3-4.png"] {
        assert!(out.join(file).metadata().unwrap().len() > 1000, "{file}");
    }
    let fig2 = include_str!("../src/figures/fig2.rs");
    let fig3 = include_str!("../src/figures/fig3.rs");
    columns_are_documented(&read(out, "fig2.csv"), fig2);
    columns_are_documented(&read(out, "fig3.csv"), &format!("{}{fig3}", head(fig2)));
    columns_are_documented(&read(out, "fig3-summary.csv"), fig3);
    columns_are_documented(&read(out, "fig3-graphs.csv"), fig3);
    columns_are_documented(&read(out, "fig3-ablation.csv"), include_str!("../src/figures/ablation.rs"));
    // Three families, four methods, thirty seeds; three families, two sizes, six methods, two seeds.
    assert_eq!(read(out, "fig2.csv").lines().count(), 1 + 3 * 4 * 30);
    assert_eq!(read(out, "fig3.csv").lines().count(), 1 + 3 * 2 * 6 * 2);

    let report: serde_json::Value = serde_json::from_str(&read(out, "report.json")).unwrap();
    let claims = report["figures"][1]["claims"].as_array().unwrap();
    assert!(claims.len() >= 15);
    let verdict_of = |text: &str| {
        let claim = claims.iter().find(|claim| claim["paper"].as_str().unwrap().contains(text)).unwrap();
        claim["verdict"].as_str().unwrap().to_owned()
    };
    // Whatever the machine: without a rule for conflicts Algorithm 2 does not end.
    assert_eq!(verdict_of("greatly reduce the number of coloring rounds"), "held");
    assert_eq!(verdict_of("speed, time on a GPU"), "not testable here");
    assert_eq!(verdict_of("speed, rounds and visits"), "held");
}

fn head(source: &str) -> String {
    source.lines().take_while(|line| line.starts_with("//!")).map(|line| format!("{line}\n")).collect()
}

#[test]
fn animations_are_compared() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path();
    figures::reproduce(&options(out, &["4", "5", "6", "7"], None), &mut Progress::silent()).unwrap();
    let n_methods = simulation::methods::methods().len();
    let source = include_str!("../src/figures/simulation/mod.rs").replace("figN", "fig4");
    // Blocks on tetrahedra are not compared at equal work, of which there are two amounts.
    for (id, n_limits, n_left_out) in [("fig4", 4, 0), ("fig5", 6, 2)] {
        for end in ["", "-runs", "-frame", "-line7"] {
            columns_are_documented(&read(out, &format!("{id}{end}.csv")), &source);
        }
        assert_eq!(
            read(out, &format!("{id}-runs.csv")).lines().count(),
            1 + n_limits * n_methods - n_left_out
        );
        for end in ["", "-2", "-3", "-4"] {
            assert!(out.join(format!("{id}{end}.png")).metadata().unwrap().len() > 1000);
        }
    }
    let source = include_str!("../src/figures/simulation/stills.rs");
    for id in ["fig6", "fig7"] {
        columns_are_documented(&read(out, &format!("{id}.csv")), source);
        assert!(out.join(format!("{id}-2.png")).metadata().unwrap().len() > 1000);
    }
    let html = read(out, "report.html");
    assert!(html.contains("STAND-IN for the Armadillo") && html.contains("In short."));
    let report: serde_json::Value = serde_json::from_str(&read(out, "report.json")).unwrap();
    assert!(report["figures"][1]["claims"].as_array().unwrap().len() >= 8);
}

#[test]
fn the_trade_and_the_extremes_are_in_the_report() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path();
    figures::reproduce(&options(out, &["trade", "extremes"], None), &mut Progress::silent()).unwrap();
    columns_are_documented(&read(out, "trade.csv"), include_str!("../src/tradeoff/mod.rs"));
    columns_are_documented(&read(out, "extremes.csv"), include_str!("../src/extremes/mod.rs"));
    let mut trade = csv::Reader::from_path(out.join("trade.csv")).unwrap();
    let rows: Vec<csv::StringRecord> = trade.records().map(Result::unwrap).collect();
    for scene in ["tablecloth", "armadillo"] {
        let of: Vec<_> = rows.iter().filter(|row| &row[0] == scene).collect();
        assert!(of.iter().any(|row| &row[9] == "true") && of.iter().any(|row| &row[10] == "true"), "{scene}");
        // Small steps have no error against the one step, and an error against the motion.
        assert!(of.iter().all(|row| row[6].is_empty() == (&row[3] != "1") && !row[7].is_empty()), "{scene}");
    }
    let html = read(out, "report.html");
    for words in ["trade --seed 5", "extremes --seed 5", "Cases by verdict", "What to take for armadillo"] {
        assert!(html.contains(words), "{words}");
    }
}

#[test]
fn one_seed_gives_the_same_colorings_again() {
    let colors = || {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path();
        figures::reproduce(&options(out, &["2"], None), &mut Progress::silent()).unwrap();
        assert!(!out.join("fig3.csv").exists());
        let data: serde_json::Value = serde_json::from_str(&read(out, "fig2.json")).unwrap();
        let mut rows = data["rows"].as_array().unwrap().clone();
        for row in &mut rows {
            assert!(row.as_object_mut().unwrap().remove("time_ms").is_some());
        }
        rows
    };
    let (one, other) = (colors(), colors());
    assert_eq!(one.len(), other.len());
    for (a, b) in one.iter().zip(&other) {
        assert_eq!(a, b);
    }
}

#[test]
fn meshes_of_the_user_are_taken() {
    let folder = tempfile::tempdir().unwrap();
    let (meshes, out) = (folder.path().join("meshes"), folder.path().join("out"));
    std::fs::create_dir_all(meshes.join("deep/er")).unwrap();
    let solid = ball::layered(8, 1.0).unwrap();
    let (surface, _) = solid.boundary_mesh().unwrap();
    obj::write(meshes.join("My_Bunny.obj"), &surface).unwrap();
    vtk::write(meshes.join("deep/er/small-armadillo.VTK"), &solid).unwrap();
    std::fs::write(meshes.join("armadillo_broken.vtk"), "no mesh").unwrap();

    let options = options(&out, &["3"], Some(meshes.clone()));
    figures::reproduce(&options, &mut Progress::silent()).unwrap();
    let graphs = read(&out, "fig3-graphs.csv");
    assert!(graphs.contains("My_Bunny.obj (stuffed)"), "{graphs}");
    let n = solid.positions().len();
    assert!(
        graphs.contains(&format!("small-armadillo.VTK,{n},"))
            || graphs.contains("boundary of small-armadillo.VTK (stuffed)"),
        "{graphs}"
    );
    let mut notes = Vec::new();
    let families = Families::from_folder(&meshes, 5, &mut notes).unwrap();
    let scene = scenes::armadillo(&families, 600).unwrap();
    let heights = || scene.state.positions.iter().map(|p| p.y);
    let height = heights().fold(f32::MIN, f32::max) - heights().fold(f32::MAX, f32::min);
    assert!((height - 1.0).abs() < 0.1 && scene.caption.contains("vertices held"), "{}", scene.caption);

    let html = read(&out, "report.html");
    assert!(html.contains("Bunny (tetrahedra)") && !html.contains("STAND-IN"));
    assert!(html.contains("--meshes"));
}

#[test]
fn what_cannot_be_made_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let fail = |figures: &[&str], meshes| {
        let options = options(&folder.path().join("out"), figures, meshes);
        figures::reproduce(&options, &mut Progress::silent()).unwrap_err().to_string()
    };
    assert!(fail(&["11"], None).contains("there are 1, 2, 3, 4, 5, 6, 7, 8, 9, trade, extremes"));
    assert!(fail(&["2"], Some(folder.path().join("none"))).contains("--meshes"));
    assert!(fail(&["2"], Some(folder.path().to_owned())).contains("bunny"));
}

/// The GPU's curves stand beside the CPU's, with the adapter's name: as many runs, other times, the same colors.
#[test]
fn the_gpu_adds_curves_of_its_own() {
    let adapter = vivace_gpu::Gpu::new().unwrap().adapter().name.clone();
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path();
    let options = Options { with_gpu: true, ..options(out, &["2", "3"], None) };
    figures::reproduce(&options, &mut Progress::silent()).unwrap();
    let html = read(out, "report.html");
    assert!(
        html.contains(&adapter) && html.contains("Vivace (GPU)") && html.contains("--figure 2 --backend gpu")
    );
    for (file, n_graphs) in [("fig2.csv", 3), ("fig3.csv", 3 * 2)] {
        // The name may hold commas.
        let csv = read(out, file).replace(&format!("\"{adapter}\""), "gpu").replace(&adapter, "gpu");
        let mut rows = csv.lines().map(|line| line.split(',').collect::<Vec<_>>());
        let header = rows.next().unwrap();
        let column = |name: &str| header.iter().position(|&column| column == name).unwrap();
        let [device, threads] = ["device", "threads"].map(column);
        let (on_cpu, on_gpu): (Vec<_>, Vec<_>) = rows.partition(|row| row[device] == "cpu");
        assert!(on_gpu.iter().all(|row| row[device] == "gpu" && row[threads].is_empty()), "{file}");
        let n_seeds = if file == "fig2.csv" { 30 } else { 2 };
        assert_eq!(on_gpu.len(), n_graphs * 4 * n_seeds, "{file}");
        let same =
            ["family", "vertices", "method", "seed", "colors", "rounds", "visits_per_vertex", "stragglers"]
                .map(column);
        for row in &on_gpu {
            let is_twin = |other: &&Vec<&str>| same.iter().all(|&at| other[at] == row[at]);
            assert_eq!(on_cpu.iter().filter(is_twin).count(), 1, "{file}: {row:?}");
        }
    }
}

/// Figures 4 and 5 show what a GPU reaches beside the CPU; where a CPU plays it, at equal work alone and without a time.
#[test]
fn the_gpu_animates_as_the_cpu_does() {
    let gpu = vivace_gpu::Gpu::new().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path();
    let options = Options { with_gpu: true, ..options(out, &["4", "5"], None) };
    figures::reproduce(&options, &mut Progress::silent()).unwrap();
    let html = read(out, "report.html");
    assert!(html.contains(&gpu.adapter().name) && html.contains("SOR 1.9 (GPU)"));
    assert_eq!(html.contains("A CPU plays the GPU"), gpu.is_software());
    for (id, n_times) in [("fig4", 2), ("fig5", 4)] {
        for (file, n_rows) in [
            (format!("{id}-runs.csv"), if gpu.is_software() { 2 } else { 2 + n_times } * 4),
            (format!("{id}-frame.csv"), 4 * 4),
        ] {
            let mut csv = csv::Reader::from_path(out.join(&file)).unwrap();
            let header = csv.headers().unwrap().clone();
            let column = |name: &str| header.iter().position(|column| column == name).unwrap();
            let rows: Vec<csv::StringRecord> = csv.records().map(Result::unwrap).collect();
            let (on_cpu, on_gpu): (Vec<_>, Vec<_>) =
                rows.iter().partition(|row| &row[column("device")] == "cpu");
            assert_eq!(on_gpu.len(), n_rows, "{file}");
            let is_runs = file.ends_with("runs.csv");
            let (error, work, time) = if is_runs {
                (column("median_error"), column("limit"), column("mean_ms"))
            } else {
                (column("error"), column("sweeps"), column("time_ms"))
            };
            for row in on_gpu {
                let method = row[column("method")].trim_end_matches(" (GPU)");
                let twin = on_cpu
                    .iter()
                    .find(|other| &other[column("method")] == method && other[work] == row[work]);
                let [here, there] = [row, twin.unwrap()].map(|row| row[error].parse::<f64>().unwrap());
                let is_equal_work = !row[work].contains("ms");
                let is_close = (here - there).abs() <= 0.01 * there;
                assert!(is_close || !is_equal_work, "{file}, {method}: {here}, {there} on the CPU");
                assert_eq!(row[time].is_empty(), gpu.is_software(), "{file}");
            }
        }
    }
}
