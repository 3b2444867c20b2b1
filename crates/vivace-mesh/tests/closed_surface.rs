//! The inside of triangle surfaces, against formulas and on scanned models where they are at hand.

#![expect(clippy::unwrap_used, reason = "a panic is how a test fails")]

use std::f64::consts::{PI, TAU};
use std::path::PathBuf;

use glam::{DVec3, Vec3};
use vivace_mesh::sdf::{ClosedSurface, SignedDistance};
use vivace_mesh::stuffing::Stuffing;
use vivace_mesh::{Mesh, TriMesh, load};

/// A torus around z, its tube cut into `n` by `n` quadrilaterals; vertex positions are often equal in x, y or z, so that rays
/// through vertices and edges are common.
fn torus(n: u32, major: f64, minor: f64) -> TriMesh {
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for i in 0..n {
        for j in 0..n {
            let (around, across) = (TAU * f64::from(i) / f64::from(n), TAU * f64::from(j) / f64::from(n));
            let reach = major + minor * across.cos();
            positions
                .push(DVec3::new(reach * around.cos(), reach * around.sin(), minor * across.sin()).as_vec3());
            let at = |i: u32, j: u32| (i % n) * n + j % n;
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    TriMesh::new(positions, triangles).unwrap()
}

/// An octahedron with its faces cut in four `n_levels` times, on the unit sphere.
fn sphere(n_levels: u32) -> TriMesh {
    let tips = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
    let mut faces = Vec::new();
    for [x, y, z] in [[0, 2, 4], [3, 0, 4], [1, 3, 4], [2, 1, 4], [2, 0, 5], [0, 3, 5], [3, 1, 5], [1, 2, 5]]
    {
        faces.push([tips[x], tips[y], tips[z]]);
    }
    for _ in 0..n_levels {
        faces = faces
            .into_iter()
            .flat_map(|[a, b, c]| {
                let [d, e, f] = [(a + b).normalize(), (b + c).normalize(), (c + a).normalize()];
                [[a, d, f], [d, b, e], [f, e, c], [d, e, f]]
            })
            .collect();
    }
    let mut positions: Vec<Vec3> = Vec::new();
    let triangles = faces
        .iter()
        .map(|face| {
            face.map(|p| {
                let known = positions.iter().position(|&other| other.distance(p) < 1e-4);
                let index = known.unwrap_or_else(|| {
                    positions.push(p);
                    positions.len() - 1
                });
                u32::try_from(index).unwrap()
            })
        })
        .collect();
    TriMesh::new(positions, triangles).unwrap()
}

/// On a grid of points, many of them on rays through vertices: sign and distance against a formula, up to the facets' error.
fn compare(surface: &TriMesh, exact: impl Fn(DVec3) -> f64, facet_error: f64) {
    let solid = ClosedSurface::new(surface).unwrap();
    let (mut n_inside, mut n_outside) = (0, 0);
    for i in -12..=12 {
        for j in -12..=12 {
            for k in -12..=12 {
                let point = DVec3::new(f64::from(i), f64::from(j), f64::from(k)) / 8.0;
                let (found, expected) = (solid.value(point), exact(point));
                assert!((found - expected).abs() < facet_error, "{found} instead of {expected} at {point}");
                if expected.abs() > facet_error {
                    assert_eq!(found < 0.0, expected < 0.0, "at {point}");
                    n_inside += usize::from(found < 0.0);
                    n_outside += usize::from(found > 0.0);
                }
            }
        }
    }
    assert!(n_inside > 500 && n_outside > 500, "{n_inside} {n_outside}");
}

#[test]
fn sphere_and_torus_agree_with_their_formulas() {
    compare(&sphere(4), |p| p.length() - 1.0, 0.01);
    let ring = |p: DVec3| (p.truncate().length() - 1.0).hypot(p.z) - 0.4;
    compare(&torus(48, 1.0, 0.4), ring, 0.01);
}

#[test]
fn a_stuffed_torus_has_its_volume() {
    let solid = ClosedSurface::new(&torus(64, 1.0, 0.4)).unwrap();
    let (mesh, _) = Stuffing::with_cell_size(0.08).fill(&solid).unwrap();
    let report = mesh.report();
    assert!(report.has_manifold_boundary() && report.n_components == 1);
    let volume = 2.0 * PI * PI * 0.4 * 0.4;
    assert!((report.volume / volume - 1.0).abs() < 0.02, "{} instead of {volume}", report.volume);
}

#[test]
fn a_cavity_stays_empty() {
    let outer = sphere(3);
    let n = u32::try_from(outer.positions().len()).unwrap();
    let inner = outer.positions().iter().map(|p| 0.5 * *p);
    let positions = outer.positions().iter().copied().chain(inner).collect();
    let inner = outer.triangles().iter().map(|&[a, b, c]| [a + n, c + n, b + n]);
    let triangles = outer.triangles().iter().copied().chain(inner).collect();
    let shell = ClosedSurface::new(&TriMesh::new(positions, triangles).unwrap()).unwrap();
    assert!(shell.value(DVec3::ZERO) > 0.4);
    assert!(shell.value(DVec3::X * 0.75) < -0.2);
    assert!(shell.value(DVec3::X * 1.5) > 0.4);
}

/// Scanned models come from the folder named by `VIVACE_MESHES`, or from `meshes` in a folder `shared` beside the project.
fn scanned(name: &str) -> Option<TriMesh> {
    let beside = || PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/meshes"));
    let folder = std::env::var_os("VIVACE_MESHES").map_or_else(beside, PathBuf::from);
    let path = folder.join("surfaces").join(name);
    if !path.exists() {
        println!("skipped: no {}", path.display());
        return None;
    }
    match load(&path).unwrap().mesh {
        Mesh::Tri(surface) => Some(surface),
        _ => panic!("{name} is a surface"),
    }
}

#[test]
fn scanned_models_keep_their_volume() {
    for (name, volume) in [("bunny_35k.obj", 0.1999), ("armadillo_50k.obj", 0.0686)] {
        let Some(surface) = scanned(name) else { continue };
        let solid = ClosedSurface::new(&surface).unwrap();
        let (mesh, report) = Stuffing::with_about_tets(60_000).fill(&solid).unwrap();
        let found = mesh.report();
        assert!(found.has_manifold_boundary() && found.n_components == 1, "{name}");
        assert!((found.volume / volume - 1.0).abs() < 0.02, "{name}: {} instead of {volume}", found.volume);
        // Tips thinner than a cell may come off; wrong signs would show as many more crumbs.
        let crumbs: usize = report.dropped.iter().sum();
        assert!(crumbs < mesh.tets().len() / 1000, "{name}: {:?}", report.dropped);
    }
}
