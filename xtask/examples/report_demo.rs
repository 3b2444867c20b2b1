//! Writes a report from made-up numbers, to look at charts, matrix pictures and the page.

use std::path::Path;

use xtask::report::{
    Axis, Chart, Figure, Look, Mark, Panel, PictureGrid, Progress, Report, ReportError, RunInfo, Series,
    Table, Value, Verdict, spy,
};

/// A hash as a number in [0, 1).
fn noise(a: u64, b: u64) -> f64 {
    let mut z = (a.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ b).wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

const ALGORITHMS: [&str; 4] = ["Luby", "Jones\u{2013}Plassmann", "Largest degree first", "Vivace"];

fn times_and_colors() -> Chart {
    let mut chart = Chart::new("Coloring time and number of colors against graph size", 2);
    for (family, name) in
        ["Triangulated cloth", "Tetrahedral bunny", "Tetrahedral armadillo"].iter().enumerate()
    {
        let vertices = || Axis::log("Vertices").compact();
        let mut time = Panel::new(name, vertices(), Axis::log("Time").unit("ms"));
        let mut colors = Panel::new(name, vertices(), Axis::linear("Number of colors").whole().min(0.0));
        for (idx, algorithm) in ALGORITHMS.iter().enumerate() {
            let (mut t, mut c) = (Series::new(algorithm), Series::new(algorithm));
            for size in 0..7u32 {
                let n = 1000.0 * 10f64.powf(0.5 * f64::from(size));
                let key = (family * 1000 + idx * 100) as u64 + u64::from(size);
                let cost = [3.0, 2.2, 14.0, 1.0][idx] * (0.02 + n * 2e-5);
                let times: Vec<f64> = (0..30).map(|k| cost * (0.75 + 0.6 * noise(key, k))).collect();
                let base = [13.0, 9.5, 7.0, 8.5][idx] * (1.0 + 0.8 * family as f64) + 0.3 * f64::from(size);
                let counts: Vec<f64> = (0..30).map(|k| (base + 3.0 * noise(key + 7, k)).round()).collect();
                t = t.samples(n, &times);
                c = c.samples(n, &counts);
            }
            time = time.series(t);
            colors = colors.series(c);
        }
        chart = chart.panel(time).panel(colors);
    }
    chart
}

fn error_over_time() -> Chart {
    let mut chart = Chart::new("Relative error over the animation, for two time budgets", 2);
    for budget in [4.0, 8.0] {
        let mut panel = Panel::new(
            &format!("Budget {budget} ms"),
            Axis::linear("Time").unit("s"),
            Axis::log("Relative error").max(100.0),
        );
        for (idx, name) in ["Jacobi", "Chebyshev", "Vivace (\u{3c9} = 1.7)"].iter().enumerate() {
            let value = |frame: u64| {
                let t = frame as f64 / 30.0;
                let wave = (1.0 + 0.5 * (2.0 * t).sin()) * (0.8 + 0.4 * noise(frame, idx as u64));
                match idx {
                    0 => 0.4 / budget * wave,
                    1 if t > 5.0 => f64::NAN,
                    1 => 1e-3 * wave * (2.2 * t).exp(),
                    _ => 4e-6 / budget * wave,
                }
            };
            panel =
                panel.series(Series::line(name, (0..300).map(|frame| (frame as f64 / 30.0, value(frame)))));
        }
        chart = chart.panel(panel.guide_y(1e-2, "visible"));
    }
    chart
}

fn odd_cases() -> Chart {
    let x = || Axis::linear("x <&> \"y\"");
    Chart::new("Odd cases: <&> \"quotes\" & 'more', \u{394} = 35, n\u{2080} \u{2208} {1, \u{2026}}", 3)
        .area(250.0, 160.0)
        .panel(Panel::new("empty <series>", x(), Axis::log("y")).series(Series::new("a & b")))
        .panel(Panel::new("one point", x(), Axis::log("y")).series(Series::line("<one>", [(3.0, 2.5)])))
        .panel(
            Panel::new("error bars", x(), Axis::linear("Error").unit("m/s\u{b2}"))
                .series(
                    Series::new("bars")
                        .mark(Mark::LineWithBars)
                        .range(1.0, 2.0, 3.0, 5.0)
                        .range(2.0, 1.0, 2.0, 2.5),
                )
                .series(Series::new("dots").mark(Mark::Dots).range(1.2, 3.0, 4.0, 4.5).point(1.8, 3.2)),
        )
        .panel(Panel::new("zeros and NaN", Axis::log("x"), Axis::log("y")).series(Series::line(
            "z",
            [(0.0, 1.0), (1.0, 0.0), (2.0, 1e-5), (30.0, f64::NAN), (400.0, 4e-2)],
        )))
        .panel(
            Panel::new("error against time", Axis::log("Time per frame").unit("ms"), Axis::log("Error"))
                .guide_x(5.0, "budget 5 ms")
                .series(
                    Series::line(
                        "points",
                        (0..40).map(|k| (10f64.powf(2.0 * noise(k, 1)), 10f64.powf(-4.0 * noise(k, 2)))),
                    )
                    .mark(Mark::Dots)
                    .look(Look { color: 6, marker: 1, dash: 0 }),
                )
                .series(Series::line("Pareto front", [(1.0, 0.3), (3.0, 1e-2), (10.0, 1e-3), (80.0, 1e-4)])),
        )
        .panel(
            Panel::new("eight looks", Axis::linear("x").whole(), Axis::linear("Large").compact())
                .series(Series::line("l0", [(0.0, 1e6), (9.0, 2e6)]))
                .series(Series::line("l1", [(0.0, 0.9e6), (9.0, 1.9e6)]))
                .series(Series::line("l2", [(0.0, 0.8e6), (9.0, 1.8e6)]))
                .series(Series::line("l3", [(0.0, 0.7e6), (9.0, 1.7e6)]))
                .series(Series::line("l4", [(0.0, 0.6e6), (9.0, 1.6e6)])),
        )
}

/// Nonzeros of a grid of `side` by `side` vertices with both diagonals, vertex `v` renamed to `order[v]`.
fn grid_nonzeros(side: usize, order: &[usize]) -> impl Iterator<Item = (usize, usize)> {
    let steps = [(0, 0), (0, 1), (1, 0), (1, 1), (1, usize::MAX)];
    (0..side * side)
        .flat_map(move |v| {
            steps.into_iter().filter_map(move |(dy, dx)| {
                let (y, x) = (v / side + dy, (v % side).wrapping_add(dx));
                (y < side && x < side).then(|| (order[v], order[y * side + x]))
            })
        })
        .flat_map(|(a, b)| [(a, b), (b, a)])
}

/// A made-up coloring: the four colors of the grid by parity, some vertices of which spill into further, smaller classes.
///
/// Where `shuffled`, vertices of one color come in no order, as in a mesh without one.
fn blocks(side: usize, n_colors: usize, shuffled: bool) -> (Vec<usize>, Vec<usize>) {
    let n = side * side;
    let class = |v: usize| {
        let parity = 2 * (v / side % 2) + v % side % 2;
        let draw = noise(v as u64, n_colors as u64) * 2.0;
        let spill =
            (0..n_colors).find(|&k| draw < (k + 1) as f64 / (n_colors - 3) as f64).unwrap_or(n_colors);
        if n_colors > 4 && spill < n_colors - 4 { 4 + spill } else { parity }
    };
    let mut sizes = vec![0; n_colors];
    for v in 0..n {
        sizes[class(v)] += 1;
    }
    let mut next: Vec<usize> =
        sizes.iter().scan(0, |sum, size| Some(std::mem::replace(sum, *sum + size))).collect();
    let mut visits: Vec<usize> = (0..n).collect();
    if shuffled {
        visits.sort_by(|&a, &b| noise(a as u64, 5).total_cmp(&noise(b as u64, 5)));
    }
    let mut order = vec![0; n];
    for v in visits {
        order[v] = next[class(v)];
        next[class(v)] += 1;
    }
    (order, sizes)
}

fn matrices() -> Result<PictureGrid, ReportError> {
    let columns = ["Unordered", "Luby", "Jones\u{2013}Plassmann", "LDF", "Vivace"];
    let mut grid = PictureGrid::new("Adjacency matrices before and after coloring", &columns)
        .cell_width(190.0)
        .note("Gray: nonzeros under a pixel, on a logarithmic scale set for each matrix. Orange lines separate colors; the blue blocks on the diagonal are independent sets, which hold the diagonal alone.");
    for (name, side, counts) in [
        ("Cloth", 100, [13, 9, 7, 8]),
        ("Bunny", 300, [26, 18, 15, 16]),
        ("Armadillo", 1000, [60, 27, 20, 24]),
    ] {
        let n = side * side;
        let identity: Vec<usize> = (0..n).collect();
        let first = format!("{} vertices", Value::from(n).shown());
        let mut cells =
            vec![spy(n, grid_nonzeros(side, &identity), &[], &[first, "maximum degree 8".to_owned()])?];
        for n_colors in counts {
            let (order, sizes) = blocks(side, n_colors, side != 100);
            let lines = [format!("{n_colors} colors"), format!("{:.2} ms \u{b1} 0.02", 1e-4 * n as f64)];
            cells.push(spy(n, grid_nonzeros(side, &order), &sizes, &lines)?);
        }
        grid = grid.row((name, &format!("{side} \u{d7} {side} grid")), cells);
    }
    Ok(grid)
}

fn main() -> Result<(), ReportError> {
    let out = std::env::args().nth(1).unwrap_or_else(|| "out/report_demo".to_owned());
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let info =
        RunInfo::new("Figures from made-up numbers", "cargo run -p xtask --example report_demo", 42, &root)
            .paragraph("This page shows what a report looks like; none of its numbers was measured.")
            .option("Sizes", "quick");
    let mut report = Report::create(Path::new(&out), info)?;
    let mut progress = Progress::new();
    let command = |n: u32| format!("cargo xtask reproduce-figures --quick --seed 42 --figure {n}");

    progress.figure("fig2", 1);
    progress.step("matrices");
    let mut fig2 = Figure::new(
        "fig2",
        "Figure 2: adjacency matrices",
        &command(2),
        "Adjacency matrices of three constraint graphs. Leftmost: the order of the mesh. Others: vertices sorted by color.",
    )
    .grid(matrices()?);
    fig2.seconds = Some(progress.done());
    report.add(fig2)?;

    progress.figure("fig3", 1);
    progress.step("charts");
    let mut rows = Table::new("", &["family", "algorithm", "vertices", "time_ms", "colors"]);
    let mut medians = Table::new("Medians at 1M vertices", &["Algorithm", "Time [ms]", "Colors", "Valid"]);
    for (idx, name) in ALGORITHMS.iter().enumerate() {
        rows.push([
            "cloth".into(),
            (*name).into(),
            1000u32.into(),
            (0.1 * (idx + 1) as f64).into(),
            (7 + idx).into(),
        ]);
        medians.push([(*name).into(), (21.37 * (idx + 1) as f64).into(), (7 + idx).into(), true.into()]);
    }
    let mut fig3 = Figure::new(
        "fig3",
        "Figure 3: coloring time and number of colors",
        &command(3),
        "Coloring algorithms compared by time to complete and number of colors. Stand-ins of the same size replace the bunny and the armadillo.",
    )
    .chart(times_and_colors())
    .table(medians)
    .data(rows)
    .claim("LDF uses the smallest number of colors.", "Fewest in 18 of 18 graphs.", Verdict::Held)
    .claim("Vivace is faster than all others.", "Slower than serial first fit by 5 to 50 times on this CPU.", Verdict::NotHeld)
    .claim("LDF is 10\u{2013}20 times slower.", "No GPU on this machine.", Verdict::NotTestable)
    .option("runs", 30);
    fig3.seconds = Some(progress.done());
    report.add(fig3)?;

    let caption = "Relative error; the accelerated solver diverges.";
    report.add(
        Figure::new("fig4", "Figure 4: relative error over time", &command(4), caption)
            .chart(error_over_time()),
    )?;
    report
        .add(Figure::new("odd", "Odd cases", "", "Empty, single and unusable values.").chart(odd_cases()))?;
    progress.note(&format!("see {}", report.finish()?.display()));
    Ok(())
}
