//! A whole report in a temporary folder.

use resvg::usvg::roxmltree;

use super::*;

const NASTY: &str = "a <b> & \"c\" 'd' \u{1} \u{3c9}";

fn nasty_figure() -> Figure {
    let series =
        Series::new(NASTY).samples(1.0, &[1.0, 2.0, f64::NAN]).point(2.0, 0.0).point(3.0, f64::INFINITY);
    let panel =
        Panel::new(NASTY, Axis::log(NASTY).unit("<s>"), Axis::log(NASTY)).series(series).guide_x(2.0, NASTY);
    let matrix = spy(50, (0..50).map(|k| (k, k)), &[20, 30], &[NASTY.to_owned()]).unwrap();
    Figure::new("fig9", NASTY, "cargo xtask reproduce-figures --figure 9 <&>", NASTY)
        .chart(Chart::new(NASTY, 2).panel(panel.clone()).panel(panel).note(NASTY))
        .grid(PictureGrid::new(NASTY, &[NASTY, "empty"]).row((NASTY, NASTY), vec![matrix]).note(NASTY))
        .chart(Chart::new("", 3))
        .table(Table::new(NASTY, &[NASTY, "n"]).row([NASTY.into(), 3u32.into()]).row([]))
        .data(Table::new("", &["name", "error"]).row([NASTY.into(), f64::INFINITY.into()]))
        .data(Table::new("More rows", &["n"]))
        .data(Table::new("more rows!", &["n"]))
        .claim(NASTY, NASTY, Verdict::Held)
        .claim("b", "c", Verdict::NotHeld)
        .claim("b", "c", Verdict::NotTestable)
        .option(NASTY, 3)
}

fn write(figures: Vec<Figure>) -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().unwrap();
    let info = RunInfo::new(NASTY, "cargo xtask reproduce-figures", 7, folder.path())
        .paragraph(NASTY)
        .option(NASTY, NASTY);
    let mut report = Report::create(&folder.path().join("new/folder"), info).unwrap();
    for figure in figures {
        report.add(figure).unwrap();
    }
    let path = report.finish().unwrap();
    let page = std::fs::read_to_string(path).unwrap();
    (folder, page)
}

#[test]
fn the_page_is_well_formed_and_needs_nothing_from_elsewhere() {
    for figures in [vec![], vec![nasty_figure()]] {
        let (_folder, page) = write(figures);
        let options = roxmltree::ParsingOptions { allow_dtd: true, ..Default::default() };
        let document = roxmltree::Document::parse_with_options(&page, options).unwrap();
        assert!(!page.contains("http"), "a reference to elsewhere");
        assert!(!page.contains("<script"));
        let mut ids: Vec<&str> = document.descendants().filter_map(|node| node.attribute("id")).collect();
        let n_ids = ids.len();
        ids.sort_unstable();
        ids.dedup();
        assert_eq!(ids.len(), n_ids, "ids are unique");
        for node in document.descendants() {
            if let Some(target) = node.attribute("href").and_then(|href| href.strip_prefix('#')) {
                assert!(ids.contains(&target), "#{target} leads nowhere");
            }
        }
    }
}

#[test]
fn every_linked_file_is_there_and_pictures_are_not_blank() {
    let (folder, page) = write(vec![nasty_figure()]);
    let folder = folder.path().join("new/folder");
    let options = roxmltree::ParsingOptions { allow_dtd: true, ..Default::default() };
    let document = roxmltree::Document::parse_with_options(&page, options).unwrap();
    let links: Vec<&str> = document
        .descendants()
        .filter(|node| node.has_tag_name("a"))
        .filter_map(|node| node.attribute("href"))
        .filter(|href| !href.starts_with('#'))
        .collect();
    for name in ["fig9.svg", "fig9.png", "fig9-2.png", "fig9.csv", "fig9.json", "fig9-more-rows-3.csv"] {
        assert!(links.contains(&name), "{name} in {links:?}");
    }
    for name in links {
        let bytes = std::fs::read(folder.join(name)).unwrap();
        if name.ends_with(".png") && name != "fig9-3.png" {
            let (width, height, colors) = raster::tests::inspect(&bytes);
            assert!(
                width > 200 && height > 200 && colors > 10,
                "{name}: {width} x {height}, {colors} colors"
            );
        }
        if name.ends_with(".svg") {
            roxmltree::Document::parse(&String::from_utf8(bytes).unwrap()).unwrap();
        }
    }
}

#[test]
fn data_files_say_how_to_make_them_again() {
    let (folder, _page) = write(vec![nasty_figure()]);
    let folder = folder.path().join("new/folder");
    let read = |name: &str| std::fs::read(folder.join(name)).unwrap();
    let json: serde_json::Value = serde_json::from_slice(&read("fig9.json")).unwrap();
    assert_eq!(json["figure"], "fig9");
    assert_eq!(json["seed"], 7);
    assert_eq!(json["commit"], "unknown");
    assert!(json["command"].as_str().unwrap().contains("--figure 9"));
    assert!(json["machine"]["threads"].as_u64().unwrap() > 0);
    assert_eq!(json["rows"][0]["error"], "inf");
    let mut csv = csv::Reader::from_reader(std::io::Cursor::new(read("fig9.csv")));
    assert_eq!(csv.headers().unwrap(), vec!["name", "error"]);
    assert_eq!(csv.records().next().unwrap().unwrap(), vec![NASTY, "inf"]);
    let report: serde_json::Value = serde_json::from_slice(&read("report.json")).unwrap();
    assert_eq!(report["figures"][0]["claims"][1]["verdict"], "not held");
}

#[test]
fn a_folder_that_cannot_be_made_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    std::fs::write(&file, "").unwrap();
    let info = RunInfo::new("t", "c", 1, folder.path());
    let error = Report::create(&file.join("sub"), info).err().unwrap().to_string();
    assert!(error.contains("file"), "{error}");
}

#[test]
fn charts_without_much_data_are_still_drawn() {
    let nothing = Series::new("nothing");
    let one = Series::line("one", [(3.0, 2.0)]);
    let unusable =
        Series::line("unusable", [(1.0, f64::NAN), (f64::INFINITY, 1.0), (0.0, 0.0), (-1.0, -1.0)]);
    let equal = Series::new("equal").samples(1.0, &[5.0; 4]).samples(2.0, &[5.0; 4]);
    for series in [nothing, one, unusable, equal] {
        for mark in [Mark::Line, Mark::LineWithBars, Mark::Dots] {
            for (x, y) in [(Axis::linear("x"), Axis::linear("y")), (Axis::log("x"), Axis::log("y"))] {
                let panel = Panel::new("", x, y).series(series.clone().mark(mark));
                let svg = Chart::new("", 1).panel(panel).svg("chart").to_file();
                assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
                let png = raster::png_from_svg("chart", &svg).unwrap();
                assert!(raster::tests::inspect(&png).2 > 10, "{} is blank", series.name);
            }
        }
    }
}

#[test]
fn a_value_of_zero_on_a_log_axis_is_named_in_the_picture() {
    let series = Series::line("curve", [(1.0, 0.0), (2.0, 1.0)]);
    let chart = Chart::new("", 1).panel(Panel::new("", Axis::log("x"), Axis::log("y")).series(series));
    assert!(chart.svg("c").to_file().contains("no place on a logarithmic axis"));
}

#[test]
fn a_curve_breaks_off_where_a_value_is_missing() {
    let curves = |y: f64| {
        let series = Series::line("c", [(1.0, 1.0), (2.0, 2.0), (3.0, y), (4.0, 1.0), (5.0, 2.0)]);
        let chart =
            Chart::new("", 1).panel(Panel::new("", Axis::linear("x"), Axis::linear("y")).series(series));
        chart.svg("c").to_file().matches("stroke-linejoin=\"round\"").count()
    };
    assert_eq!(curves(f64::NAN), curves(1.0) + 1);
}
