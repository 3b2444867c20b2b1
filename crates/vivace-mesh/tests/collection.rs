//! Large meshes: scans where a folder `../shared/meshes` lies beside the project, and hubs and grids of our own anywhere.

use std::path::{Path, PathBuf};

use glam::Vec3;
use vivace_mesh::{TetReport, TriMesh, cloth, obj, vtk};

/// A file of the collection; none, and a word on it, where there is no collection.
fn file(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/meshes").join(name);
    if !path.exists() {
        println!("{} is not there: not tested", path.display());
    }
    path.exists().then_some(path)
}

#[test]
fn surfaces_are_whole() {
    // Vertices, triangles, smallest angle [deg], volume [m^3]: measured by other programs.
    for (name, n_vertices, n_triangles, min_angle, volume) in [
        ("bunny_5k", 2_502, 5_000, 14.9, 0.1994),
        ("bunny_35k", 17_502, 35_000, 19.0, 0.1999),
        ("armadillo_5k", 2_502, 5_000, 15.3, 0.0680),
        ("armadillo_50k", 25_002, 50_000, 8.1, 0.0686),
    ] {
        let Some(path) = file(&format!("surfaces/{name}.obj")) else { return };
        let loaded = obj::read(path).unwrap();
        let report = loaded.mesh.report();
        assert_eq!((report.n_vertices, report.n_triangles, loaded.notes), (n_vertices, n_triangles, vec![]));
        assert_eq!((report.n_components, report.euler_characteristic), (1, 2));
        assert!(report.is_closed() && report.is_manifold() && report.is_oriented());
        assert!((report.min_angle.unwrap() - min_angle).abs() < 0.051, "{name}: {:?}", report.min_angle);
        assert!((report.volume.unwrap() - volume).abs() < 0.000_051, "{name}: {:?}", report.volume);
        assert_eq!(loaded.mesh.check_volume_boundary(), Ok(()));
    }
}

/// Counts of vertices, tetrahedra, edges and boundary triangles; smallest and largest degree; its mean and deviation;
/// dihedral angles \[deg\]; smallest and mean quality.
type Row = (&'static str, [usize; 4], [u32; 2], [f64; 2], [f64; 2], [f64; 2]);

/// Measured by other programs.
const SOLIDS: [Row; 12] = [
    ("armadillo_5k", [1278, 5042, 7019, 1400], [3, 24], [10.98, 3.21], [11.9, 156.6], [0.214, 0.797]),
    ("armadillo_15k", [3287, 15032, 19618, 2600], [3, 23], [11.94, 2.87], [14.2, 159.2], [0.199, 0.824]),
    ("armadillo_55k", [10637, 54717, 67853, 5000], [3, 25], [12.76, 2.54], [15.6, 150.6], [0.280, 0.841]),
    (
        "armadillo_150k",
        [27939, 149_841, 182_779, 10000],
        [4, 23],
        [13.08, 2.39],
        [12.2, 151.3],
        [0.184, 0.848],
    ),
    ("bunny_5k", [1248, 5086, 7033, 1400], [5, 22], [11.27, 3.20], [14.0, 152.2], [0.280, 0.799]),
    ("bunny_15k", [3242, 15115, 19656, 2600], [5, 22], [12.13, 2.97], [17.8, 150.4], [0.260, 0.827]),
    ("bunny_55k", [10528, 54830, 67857, 5000], [5, 23], [12.89, 2.57], [16.4, 145.6], [0.283, 0.847]),
    ("bunny_150k", [27904, 150_653, 183_556, 10000], [5, 23], [13.16, 2.46], [15.0, 155.4], [0.250, 0.853]),
    (
        "armadillo_55k_graded",
        [14034, 53894, 77927, 20000],
        [3, 32],
        [11.11, 4.02],
        [1.4, 177.0],
        [0.022, 0.680],
    ),
    ("bunny_55k_graded", [13393, 55175, 77067, 17000], [5, 31], [11.51, 3.76], [1.2, 177.0], [0.025, 0.708]),
    (
        "armadillo_58k_irregular",
        [12919, 58239, 76636, 10958],
        [3, 26],
        [11.86, 3.53],
        [12.7, 157.4],
        [0.237, 0.820],
    ),
    (
        "bunny_26k_irregular",
        [6312, 26425, 36059, 6646],
        [4, 30],
        [11.43, 3.82],
        [12.9, 159.9],
        [0.234, 0.795],
    ),
];

fn near(found: [f64; 2], expected: [f64; 2], tolerance: f64) -> bool {
    found.iter().zip(expected).all(|(f, e)| (f - e).abs() < tolerance)
}

#[test]
fn solids_measure_what_others_measured() {
    for (name, counts, degrees, spread, angles, qualities) in SOLIDS {
        let Some(path) = file(&format!("tets/{name}.vtk")) else { return };
        let loaded = vtk::read(path).unwrap();
        let r: TetReport = loaded.mesh.report();
        assert!(loaded.notes.is_empty(), "{name}: {:?}", loaded.notes);
        assert_eq!([r.n_vertices, r.n_tets, r.n_edges, r.n_boundary_triangles], counts, "{name}");
        assert_eq!([r.degrees.min, r.degrees.max], degrees, "{name}");
        assert!(near([r.degrees.mean, r.degrees.deviation], spread, 0.0051), "{name}: {:?}", r.degrees);
        assert!(near(r.dihedral_angles.unwrap(), angles, 0.051), "{name}: {:?}", r.dihedral_angles);
        assert!(near(r.quality.unwrap(), qualities, 0.000_51), "{name}: {:?}", r.quality);
        assert!(
            r.has_manifold_boundary()
                && r.n_components == 1
                && r.n_isolated_vertices == 0
                && r.n_nonmanifold_faces == 0
        );
        let (surface, _) = loaded.mesh.boundary_mesh().unwrap();
        assert_eq!(surface.check_volume_boundary(), Ok(()), "{name}");
        assert!((surface.signed_volume() / r.volume - 1.0).abs() < 1e-9);
    }
}

#[test]
fn a_hub_of_a_hundred_thousand_is_no_trouble() {
    // Anything quadratic in the degree would need 10^10 steps.
    let n = 100_000_u32;
    let mut positions = vec![Vec3::ZERO];
    positions.extend((0..n).map(|k| Vec3::new((k as f32).cos(), 0.0, (k as f32).sin())));
    let wheel = (0..n).map(|k| [0, 1 + k, 1 + (k + 1) % n]).collect();
    let report = TriMesh::new(positions.clone(), wheel).unwrap().report();
    assert_eq!((report.degrees.max, report.n_hinges, report.n_nonmanifold_vertices), (n, n as usize, 0));
    // One edge with all triangles, and a tip where as many fans touch.
    let book = (2..=n).map(|k| [0, 1, k]).collect();
    let report = TriMesh::new(positions.clone(), book).unwrap().report();
    assert_eq!((report.n_nonmanifold_edges, report.n_nonmanifold_vertices), (1, 0));
    let fans = (0..n / 2).map(|k| [0, 1 + 2 * k, 2 + 2 * k]).collect();
    let report = TriMesh::new(positions, fans).unwrap().report();
    assert_eq!((report.n_nonmanifold_vertices, report.n_components), (1, 1));
}

#[test]
fn large_cloths_are_made_and_read_again() {
    let mesh = cloth::irregular(400, 300, 0.01, 0.45, 11).unwrap();
    let again = obj::parse(obj::to_text(&mesh).as_bytes()).unwrap();
    assert_eq!((again.mesh, again.notes), (mesh, vec![]));
}
