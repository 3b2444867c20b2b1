//! Malformed, extreme and unusual files: each is loaded as described or refused with the reason, and nothing panics.
//!
//! The files are made here. Where a folder `../shared/meshes/bad` lies beside the project, its files must meet the same
//! verdicts.

#![expect(clippy::unwrap_used, reason = "a panic is how a test fails")]

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::Path;

use vivace_mesh::{Loaded, Mesh, MeshError, load, obj, vtk};

enum Verdict {
    /// An error that says this.
    Refuse(&'static str),
    /// Vertices, triangles or tetrahedra, and what the notes say, each in its turn.
    Take(usize, usize, &'static [&'static str]),
}

use Verdict::{Refuse, Take};

const CUBE_POINTS: &str = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n";
const CUBE_TETS: &str = "4 0 1 3 4\n4 1 2 3 6\n4 1 5 6 4\n4 3 6 7 4\n4 1 6 3 4\n";
const FOUR_POINTS: &str = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";

fn cube_vertices() -> String {
    CUBE_POINTS.lines().fold(String::new(), |text, line| text + "v " + line + "\n")
}

fn grid(points: &str, n_points: usize, cells: &str, size: usize, types: &[u8]) -> String {
    let types: Vec<String> = types.iter().map(u8::to_string).collect();
    let n_cells = types.len();
    format!(
        "# vtk DataFile Version 3.0\ntest mesh\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS {n_points} double\n{points}\
         CELLS {n_cells} {size}\n{cells}CELL_TYPES {n_cells}\n{}\n",
        types.join("\n")
    )
}

fn cube(cells: &str) -> String {
    grid(CUBE_POINTS, 8, cells, 25, &[10; 5])
}

fn head(text: &str, marker: &str) -> String {
    text.split_inclusive(marker).next().unwrap_or_default().to_owned()
}

/// n vertices on the unit circle, after `first`.
fn circle(first: &str, n: u32) -> String {
    let mut text = format!("# test mesh\n{first}");
    for k in 0..n {
        let angle = TAU * f64::from(k) / f64::from(n);
        writeln!(text, "v {} 0.0 {}", angle.cos(), angle.sin()).unwrap();
    }
    text
}

fn sheet(n: u32, more: &str, last_face_cut: bool) -> String {
    let mut text = "# test mesh\n".to_owned();
    for k in 0..n * n {
        writeln!(text, "v {} 0 {}", k % n, k / n).unwrap();
    }
    text += more;
    for k in (0..n * (n - 1)).filter(|k| (k + 1) % n != 0) {
        writeln!(text, "f {} {} {}\nf {} {} {}", k + 1, k + n + 1, k + 2, k + 2, k + n + 1, k + n + 2)
            .unwrap();
    }
    if last_face_cut {
        text.truncate(text.trim_end().rfind(' ').unwrap());
    }
    text
}

fn soup() -> String {
    let faces = [
        "1 4 3", "1 3 2", "5 6 7", "5 7 8", "1 2 6", "1 6 5", "2 3 7", "2 7 6", "3 4 8", "3 8 7", "4 1 5",
        "4 5 8",
    ];
    let points: Vec<&str> = CUBE_POINTS.lines().collect();
    let mut text = "# test mesh\n".to_owned();
    for corner in faces.iter().flat_map(|f| f.split(' ')) {
        writeln!(text, "v {}", points[corner.parse::<usize>().unwrap() - 1]).unwrap();
    }
    for k in 0..12 {
        writeln!(text, "f {} {} {}", 3 * k + 1, 3 * k + 2, 3 * k + 3).unwrap();
    }
    text
}

fn huge_polygon() -> String {
    let corners: Vec<String> = (1..=1000).map(|v| v.to_string()).collect();
    circle("", 1000) + "f " + &corners.join(" ") + "\n"
}

fn wheel() -> String {
    let mut text = circle("v 0 0 0\n", 2000);
    for k in 0..2000 {
        writeln!(text, "f 1 {} {}", 2 + (k + 1) % 2000, 2 + k).unwrap();
    }
    text
}

/// Name, text, verdict.
fn cases() -> Vec<(&'static str, String, Verdict)> {
    let triangle = "# test mesh\nv 0.0 0.0 0.0\nv 1.0 0.0 0.0\nv 0.0 1.0 0.0\n";
    let quads = "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
    let relative =
        "f -8 -5 -6 -7\nf -4 -3 -2 -1\nf -8 -7 -3 -4\nf -7 -6 -2 -3\nf -6 -5 -1 -2\nf -5 -8 -4 -1\n";
    let slots = "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\nf 1/1/1 4/2/1 3/3/1 2/4/1\nf 5//1 6//1 7//1 8//1\n\
                 f 1/1 2/2 6/3 5/4\nf 2/1/1 3/2/1 7/3/1 6/4/1\nf 3//1 4//1 8//1 7//1\nf 4/1 1/2 5/3 8/4\n";
    let crlf = "# cube\n".to_owned()
        + &cube_vertices().replace("v ", "v\t")
        + "f 1 4\t3  \nf 1 3\t2\nf 5 6 7\nf 5 7 8\nf 1 2 6\nf 1 6 5\nf 2 3 7\nf 2 7 6\nf 3 4 8\nf 3 8 7\nf 4 1 5\nf 4 5 8";
    let five_one = "# vtk DataFile Version 5.1\ncube\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 float\n"
        .to_owned()
        + &CUBE_POINTS.replace('\n', " ")
        + "\nCELLS 6 20\nOFFSETS vtktypeint64\n0 4 8 12 16 20\nCONNECTIVITY vtktypeint64\n\
           0 1 3 4\n1 2 3 6\n1 5 6 4\n3 6 7 4\n1 6 3 4\nCELL_TYPES 5\n10\n10\n10\n10\n10\n";
    let split = &["6 polygons split"][..];
    vec![
        ("comma_decimal.obj", "v 0,0 0,0 0,0\nv 1,5 0,0 0,0\n".into(), Refuse("line 1: \"0,0\" is no number")),
        ("crlf.obj", crlf.replace('\n', "\r\n"), Take(8, 12, &[])),
        (
            "duplicate_faces.obj",
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\nf 1 3 2\nf 4 2 1\n".into(),
            Take(4, 6, &["5 edges of more than two triangles"]),
        ),
        ("empty.obj", String::new(), Refuse("there are no vertices")),
        (
            "huge_coordinates.obj",
            "# test mesh\nv 0.0 0.0 0.0\nv 1e+30 0.0 0.0\nv 0.0 1e+30 0.0\nf 1 2 3\n".into(),
            Refuse("line 3: the coordinate \"1e+30\" is beyond 1e12 m"),
        ),
        ("huge_polygon.obj", huge_polygon(), Take(1000, 998, &["1 polygon split"])),
        ("index_out_of_range.obj", triangle.to_owned() + "f 1 2 9\n", Refuse("line 5: the face names vertex 9, but there are 3")),
        (
            "isolated_vertices.obj",
            sheet(5, "v 5 5 5\nv 6 6 6\nv 7 7 7\n", false),
            Take(28, 32, &["3 vertices without an edge"]),
        ),
        (
            "nan_coordinate.obj",
            "# test mesh\nv 0.0 0.0 0.0\nv nan 0 0\nv 0.0 1.0 0.0\nf 1 2 3\n".into(),
            Refuse("line 3: the coordinate \"nan\" is not finite"),
        ),
        ("negative_indices.obj", cube_vertices() + relative, Take(8, 12, split)),
        (
            "nonmanifold_fan.obj",
            circle("v 0 0 0\nv 0 1 0\n", 5) + "f 1 2 3\nf 1 2 4\nf 1 2 5\nf 1 2 6\nf 1 2 7\n",
            Take(7, 5, &["1 edge of more than two triangles"]),
        ),
        ("quads_with_slots.obj", cube_vertices() + slots, Take(8, 12, split)),
        ("single_triangle.obj", triangle.to_owned() + "f 1 3 2\n", Take(3, 1, &[])),
        ("triangle_soup.obj", soup(), Take(36, 12, &["11 parts unconnected with the first (vertices are not welded)"])),
        ("truncated.obj", sheet(5, "", true), Refuse("line 58: a face needs three corners, not 2")),
        ("wheel_2000.obj", wheel(), Take(2001, 2000, &[])),
        (
            "zero_area_triangles.obj",
            "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nf 1 2 4\nf 1 2 3\nf 2 2 4\n".into(),
            Take(4, 3, &["2 triangles without area", "1 edge along which two triangles run in the same direction"]),
        ),
        ("quads.obj", cube_vertices() + quads, Take(8, 12, split)),
        ("binary_label.vtk", cube(CUBE_TETS).replace("ASCII", "BINARY"), Refuse("line 3: the format is \"BINARY\"; save as ASCII")),
        (
            "flat_tet.vtk",
            grid(&(FOUR_POINTS.to_owned() + "1 1 0\n"), 5, "4 0 1 2 3\n4 0 1 2 4\n", 10, &[10, 10]),
            Refuse("tetrahedron 1 is flat"),
        ),
        (
            "huge_point_count.vtk",
            grid(FOUR_POINTS, 4_000_000_000, "4 0 1 2 3\n", 5, &[10]),
            Refuse("line 10: 4000000000 points are announced, but \"CELLS\" follows after 4"),
        ),
        (
            "index_out_of_range.vtk",
            cube(&CUBE_TETS.replace("6 3 4", "6 3 8")),
            Refuse("line 19: cell 4 names point 8, but there are 8"),
        ),
        (
            "inverted_tets.vtk",
            cube(&CUBE_TETS.replace("1 2 3 6", "1 3 2 6").replace("3 6 7 4", "3 7 6 4")),
            Take(8, 5, &["2 inverted tetrahedra reordered (first: tetrahedron 1)"]),
        ),
        (
            "mixed_cells.vtk",
            grid(CUBE_POINTS, 8, "4 0 1 3 4\n4 1 6 3 4\n8 0 1 2 3 4 5 6 7\n3 0 1 2\n3 0 2 3\n", 27, &[10, 10, 12, 5, 5]),
            Take(8, 2, &["3 cells of other types than tetrahedra skipped", "3 points in no tetrahedron"]),
        ),
        (
            "polydata.vtk",
            "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n0 0 0 1 0 0 0 1 0\nPOLYGONS 1 4\n3 0 1 2\n".into(),
            Refuse("line 4: \"DATASET POLYDATA\" holds no tetrahedra"),
        ),
        (
            "repeated_index.vtk",
            grid(FOUR_POINTS, 4, "4 0 1 1 2\n4 0 1 2 3\n", 10, &[10, 10]),
            Refuse("tetrahedron 0 names vertex 1 twice"),
        ),
        (
            "short_points.vtk",
            cube(CUBE_TETS).replace("POINTS 8", "POINTS 10"),
            Refuse("line 14: 10 points are announced, but \"CELLS\" follows after 8"),
        ),
        ("single_tet.vtk", grid(FOUR_POINTS, 4, "4 0 1 2 3\n", 5, &[10]), Take(4, 1, &[])),
        (
            "three_tets_one_face.vtk",
            grid(&(FOUR_POINTS.to_owned() + "0 0 -1\n1 1 1\n"), 6, "4 0 1 2 3\n4 0 2 1 4\n4 0 1 2 5\n", 15, &[10; 3]),
            Take(6, 3, &["1 triangle of more than two tetrahedra"]),
        ),
        (
            "truncated.vtk",
            head(&cube(CUBE_TETS), "3 6 7 4\n") + "4",
            Refuse("line 19: 5 cells are announced, but the file ends after 4"),
        ),
        ("version_5_1.vtk", five_one, Take(8, 5, &[])),
        (
            "wrong_cell_size.vtk",
            cube(CUBE_TETS).replace("CELLS 5 25", "CELLS 5 20"),
            Refuse("line 14: CELLS announces 5 cells in 20 numbers, but the first 5 need 25"),
        ),
    ]
}

fn check(name: &str, result: Result<Loaded<Mesh>, MeshError>, verdict: &Verdict) {
    match (result, verdict) {
        (Err(error), Refuse(reason)) => {
            assert!(error.to_string().contains(reason), "{name}: {error}\ninstead of\n{reason}");
        }
        (Ok(loaded), Take(n_vertices, n_elements, notes)) => {
            let (found, numbers) = match &loaded.mesh {
                Mesh::Tri(m) => ((m.positions().len(), m.triangles().len()), format!("{:?}", m.report())),
                Mesh::Tet(m) => ((m.positions().len(), m.tets().len()), format!("{:?}", m.report())),
                _ => panic!("{name}: another kind of mesh"),
            };
            assert_eq!(found, (*n_vertices, *n_elements), "{name}");
            assert!(!numbers.contains("NaN") && !numbers.contains("inf"), "{name}: {numbers}");
            assert_eq!(loaded.notes.len(), notes.len(), "{name}: {:?}", loaded.notes);
            for (found, expected) in loaded.notes.iter().zip(*notes) {
                assert!(found.contains(expected), "{name}: {found}");
            }
        }
        (Ok(_), Refuse(reason)) => panic!("{name} was taken, instead of: {reason}"),
        (Err(error), Take(..)) => panic!("{name}: {error}"),
    }
}

fn parse(name: &str, text: &str) -> Result<Loaded<Mesh>, MeshError> {
    if name.ends_with(".obj") {
        obj::parse(text.as_bytes()).map(|l| l.map(Mesh::Tri))
    } else {
        vtk::parse(text.as_bytes()).map(|l| l.map(Mesh::Tet))
    }
}

#[test]
fn texts_meet_their_verdicts() {
    for (name, text, verdict) in cases() {
        check(name, parse(name, &text), &verdict);
    }
}

#[test]
fn files_meet_their_verdicts_and_errors_name_the_file() {
    let folder = tempfile::tempdir().unwrap();
    for (name, text, verdict) in cases() {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        let result = load(&path);
        if let Err(error) = &result {
            assert!(error.to_string().starts_with(&*path.to_string_lossy()), "{error}");
        }
        check(name, result, &verdict);
    }
}

#[test]
fn the_collection_meets_the_same_verdicts() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/meshes/bad");
    let Ok(entries) = std::fs::read_dir(&folder) else {
        println!("no collection at {}: nothing to compare with", folder.display());
        return;
    };
    let cases = cases();
    for path in
        entries.map(|entry| entry.unwrap().path()).filter(|path| path.extension().is_some_and(|e| e != "md"))
    {
        let name = path.file_name().unwrap().to_str().unwrap();
        let (_, _, verdict) =
            cases.iter().find(|case| case.0 == name).unwrap_or_else(|| panic!("no verdict for {name}"));
        check(name, load(&path), verdict);
    }
}

#[test]
fn surfaces_that_bound_no_volume_are_told_from_those_that_do() {
    for (name, fault) in [
        ("negative_indices.obj", None),
        ("quads_with_slots.obj", None),
        ("crlf.obj", None),
        ("duplicate_faces.obj", Some("edge 0-1 has 4 triangles (0, 1, 4, 5)")),
        ("nonmanifold_fan.obj", Some("edge 0-1 has 5 triangles (0, 1, 2, 3, 4)")),
        ("triangle_soup.obj", Some("on one side and none on the other")),
        ("wheel_2000.obj", Some("on one side and none on the other")),
        ("zero_area_triangles.obj", Some("triangle 2 names a vertex twice")),
    ] {
        let (_, text, _) = cases().into_iter().find(|case| case.0 == name).unwrap();
        let mesh = obj::parse(text.as_bytes()).unwrap().mesh;
        match (mesh.check_volume_boundary(), fault) {
            (Ok(()), None) => assert!((mesh.signed_volume() - 1.0).abs() < 1e-12, "{name}"),
            (Err(error), Some(fault)) => assert!(error.to_string().contains(fault), "{name}: {error}"),
            (result, _) => panic!("{name}: {result:?}"),
        }
    }
}

#[test]
fn a_wheel_has_its_hub() {
    let report = obj::parse(wheel().as_bytes()).unwrap().mesh.report();
    assert_eq!((report.degrees.min, report.degrees.max), (3, 2000));
    assert_eq!((report.n_edges, report.n_hinges, report.n_boundary_edges), (4000, 2000, 2000));
}
