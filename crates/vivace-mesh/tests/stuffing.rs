//! Whole meshes out of signed distance functions: what must hold whatever the shape.

#![expect(clippy::unwrap_used, reason = "a panic is how a test fails")]

use std::collections::BTreeSet;
use std::f64::consts::PI;

use glam::DVec3;
use proptest::prelude::*;
use vivace_mesh::irregularity::Irregularity;
use vivace_mesh::sdf::{Blend, Bounds, Cuboid, HARE, SignedDistance, Sphere};
use vivace_mesh::stuffing::{Stuffing, StuffingReport};
use vivace_mesh::{MeshError, TetMesh, TetReport};

/// The bound of the paper for the thresholds used, less the rounding of positions to `f32`.
const SMALLEST_STUFFED_ANGLE: f64 = 10.7;
const LARGEST_STUFFED_ANGLE: f64 = 164.9;

const BALL: Sphere = Sphere { center: DVec3::ZERO, radius: 1.0 };

struct Function<F>(F);

impl<F: Fn(DVec3) -> f64> SignedDistance for Function<F> {
    fn value(&self, point: DVec3) -> f64 {
        (self.0)(point)
    }

    fn bounds(&self) -> Bounds {
        Bounds::around(DVec3::ZERO, DVec3::ONE)
    }
}

fn fill(shape: &dyn SignedDistance, cell_size: f64) -> (TetMesh, StuffingReport) {
    Stuffing::with_cell_size(cell_size).fill(shape).unwrap()
}

/// One manifold component within the angles; orientation is checked by `TetMesh::new`.
fn check(mesh: &TetMesh, smallest: f64, largest: f64) -> TetReport {
    let report = mesh.report();
    assert_eq!(report.n_components, 1);
    assert_eq!(report.n_isolated_vertices, 0);
    assert_eq!(report.n_nonmanifold_faces, 0);
    assert!(report.has_manifold_boundary(), "{report:?}");
    let [low, high] = report.dihedral_angles.unwrap();
    assert!(low >= smallest && high <= largest, "dihedral angles {low} .. {high}");
    report
}

fn check_stuffed(mesh: &TetMesh) -> TetReport {
    check(mesh, SMALLEST_STUFFED_ANGLE, LARGEST_STUFFED_ANGLE)
}

#[test]
fn ball_volume_converges_with_the_square_of_the_cell_size() {
    let errors = [0.2, 0.1, 0.05].map(|cell_size| {
        let report = check_stuffed(&fill(&BALL, cell_size).0);
        1.0 - report.volume / (4.0 / 3.0 * PI)
    });
    assert!(errors[0] < 0.02, "{errors:?}");
    for pair in errors.windows(2) {
        let ratio = pair[0] / pair[1];
        assert!((3.0..5.0).contains(&ratio), "{errors:?}");
    }
}

#[test]
fn a_box_that_the_lattice_meets_exactly_is_exact() {
    let cuboid = Cuboid { center: DVec3::new(1.0, 2.0, 3.0), half_extent: DVec3::new(0.5, 1.0, 0.75) };
    let report = check_stuffed(&fill(&cuboid, 0.25).0);
    assert!((report.volume - 3.0).abs() < 0.1, "{}", report.volume);
    assert!(report.bounds[0].distance(DVec3::new(0.5, 1.0, 2.25)) < 1e-6);
    assert!(report.bounds[1].distance(DVec3::new(1.5, 3.0, 3.75)) < 1e-6);
}

#[test]
fn inside_a_ball_all_degrees_are_fourteen() {
    let (mesh, _) = fill(&BALL, 0.1);
    let degrees = mesh.degrees();
    let (mut n_inside, mut n_even) = (0, 0);
    for (position, &degree) in mesh.positions().iter().zip(&degrees) {
        if position.length() < 0.75 {
            n_inside += 1;
            n_even += usize::from(degree == 14);
        }
    }
    assert!(n_inside > 3000);
    assert_eq!(n_inside, n_even);
}

/// Features of a cell and less: cuts and signs of all kinds, parts that touch in vertices and edges.
#[test]
fn noise_gives_sound_meshes_within_the_bounds_of_the_paper() {
    let mut n_repairs = 0;
    for seed in 0..12 {
        let mut state = 0.37 + f64::from(seed);
        let mut random = || {
            state = (state * 997.0 + 0.123).fract();
            state
        };
        let waves: Vec<(DVec3, f64)> = (0..6)
            .map(|_| (60.0 * (DVec3::new(random(), random(), random()) - 0.5), 7.0 * random()))
            .collect();
        let noise = Function(|p: DVec3| {
            let sum: f64 = waves.iter().map(|(k, phase)| (k.dot(p) + phase).sin()).sum();
            (sum + 0.3).max(p.length() - 1.0)
        });
        let (mesh, report) = fill(&noise, 0.1);
        check_stuffed(&mesh);
        n_repairs += report.repairs.n_edges + report.repairs.n_vertices;
    }
    assert!(n_repairs > 0, "no repair was needed, so none was tested");
}

/// Warping alone leaves an angle of 10.53 degrees here.
#[test]
fn angles_that_warping_leaves_too_small_are_lifted() {
    let text = "blend 0.05557719868790981
        cone  -0.495769479998084 0 -0.5612162254072939 0.36601313092403465 \
               0.5716526515047949 -0.20482583021521103 0.6524032778070825 0.40500409457849
        ellip 0.6524032778070825 0.5716526515047949 0 0.36601313092403465 0.40500409457849 0.36601313092403465
        cone  0.5716526515047949 -0.20482583021521103 0.6524032778070825 0.40500409457849 \
              -0.5195705520794088 0.548371668814 -0.004765222781968132 0.1670015333405301
        ellip -0.004765222781968132 -0.5195705520794088 -0.20482583021521103 \
               0.40500409457849 0.1670015333405301 0.40500409457849";
    let shape: Blend = text.parse().unwrap();
    let (mesh, report) = fill(&shape, 0.14);
    assert!(report.n_lifted > 0);
    check(&mesh, 11.9, LARGEST_STUFFED_ANGLE);
}

#[test]
fn the_largest_of_two_balls_is_kept() {
    let two = Function(|p: DVec3| (p.distance(DVec3::X * -0.5) - 0.4).min(p.distance(DVec3::X * 0.5) - 0.3));
    let (mesh, report) = fill(&two, 0.08);
    check_stuffed(&mesh);
    assert!(mesh.positions().iter().all(|p| p.x < 0.0));
    assert_eq!(report.dropped.len(), 1);
    assert!(report.dropped[0] > 1000 && report.dropped[0] < mesh.tets().len());
}

#[test]
fn a_plate_thinner_than_a_cell_is_filled_where_the_lattice_meets_it() {
    let plate = Cuboid { center: DVec3::ZERO, half_extent: DVec3::new(1.0, 0.02, 1.0) };
    match Stuffing::with_cell_size(0.1).fill(&plate) {
        Ok((mesh, _)) => drop(check_stuffed(&mesh)),
        Err(error) => assert!(matches!(error, MeshError::EmptyShape { .. }), "{error}"),
    }
    check_stuffed(&fill(&plate, 0.03).0);
}

#[test]
fn wanted_numbers_are_met() {
    let hare: Blend = HARE.parse().unwrap();
    let near = |found: usize, wanted: usize| (found as f64 / wanted as f64 - 1.0).abs() < 0.03;
    let (mesh, report) = Stuffing::with_about_tets(20_000).fill(&hare).unwrap();
    assert!(near(mesh.tets().len(), 20_000), "{report:?}");
    check_stuffed(&mesh);
    let (mesh, report) = Stuffing::with_about_vertices(3_000).fill(&hare).unwrap();
    assert!(near(mesh.positions().len(), 3_000), "{report:?}");
    let irregular = Stuffing::with_about_tets(15_000).with_irregularity(Irregularity::default());
    let (mesh, report) = irregular.fill(&hare).unwrap();
    assert!(near(mesh.tets().len(), 15_000), "{report:?}");
    assert!(report.irregularity.is_some());
    check(&mesh, 10.0, 165.0);
}

#[test]
fn hostile_functions_are_refused_by_name() {
    let error = |shape: &dyn SignedDistance, cell_size: f64| {
        Stuffing::with_cell_size(cell_size).fill(shape).unwrap_err()
    };
    assert!(matches!(error(&Function(|_| 1.0), 0.1), MeshError::EmptyShape { .. }));
    assert!(matches!(error(&Function(|_| f64::NAN), 0.1), MeshError::NonFiniteDistance { .. }));
    let hole = Function(|p: DVec3| if p.x > 0.5 { f64::NEG_INFINITY } else { p.length() - 0.9 });
    assert!(matches!(error(&hole, 0.1), MeshError::NonFiniteDistance { point: [x, ..], .. } if x > 0.5));
    for cell_size in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(error(&BALL, cell_size), MeshError::Size { .. }));
    }
    assert!(matches!(error(&BALL, 1e-4), MeshError::CellTooFine { .. }));
    assert!(matches!(error(&BALL, 1e-300), MeshError::CellBelowPrecision { .. }));
    let far = Sphere { center: DVec3::X * 1e6, radius: 1.0 };
    assert!(matches!(error(&far, 0.1), MeshError::CellBelowPrecision { .. }));
    for radius in [f64::NAN, f64::INFINITY, -1.0] {
        assert!(matches!(error(&Sphere { radius, ..BALL }, 0.1), MeshError::BadBounds { .. }), "{radius}");
    }
    assert!(matches!(Stuffing::with_about_tets(0).fill(&BALL), Err(MeshError::Size { .. })));
    let point = Sphere { radius: 0.0, ..BALL };
    assert!(matches!(Stuffing::with_about_tets(100).fill(&point), Err(MeshError::EmptyShape { .. })));
    let endless = Stuffing::with_about_tets(usize::MAX).fill(&BALL);
    assert!(matches!(endless, Err(MeshError::TooLarge { .. })));
}

#[test]
fn one_seed_one_mesh() {
    let (regular, _) = fill(&BALL, 0.15);
    assert_eq!(fill(&BALL, 0.15).0, regular);
    let with = |seed: u64| Irregularity { seed, ..Irregularity::default() }.apply(&regular).unwrap().0;
    assert_eq!(with(1), with(1));
    assert_ne!(with(1), with(2));
    let none = Irregularity { strength: 0.0, ..Irregularity::default() };
    assert_eq!(none.apply(&regular).unwrap().0, regular);
}

#[test]
fn irregular_meshes_keep_their_boundary_and_their_limits() {
    let (regular, _) = fill(&BALL, 0.12);
    let before = regular.report();
    let (irregular, report) = Irregularity::default().apply(&regular).unwrap();
    let after = check(&irregular, 10.0, 165.0);
    assert!(report.n_moves > 1000 && report.n_face_flips > 1000 && report.n_edge_flips > 100, "{report:?}");
    assert!(after.degrees.max >= 26 && after.degrees.deviation > before.degrees.deviation + 0.5);
    assert!((after.volume - before.volume).abs() < 1e-6 * before.volume);
    let boundary = |mesh: &TetMesh| -> BTreeSet<Vec<[u32; 3]>> {
        let triangles = mesh.boundary();
        let bits = |v: u32| mesh.positions()[v as usize].to_array().map(f32::to_bits);
        triangles
            .iter()
            .map(|triangle| {
                let mut corners = triangle.map(bits).to_vec();
                corners.sort_unstable();
                corners
            })
            .collect()
    };
    assert_eq!(boundary(&irregular), boundary(&regular));
    let strict = Irregularity { min_dihedral: 20.0, max_dihedral: 140.0, ..Irregularity::default() };
    let strict = strict.apply(&regular).unwrap().0.report();
    assert!(strict.dihedral_angles.unwrap()[0] >= before.dihedral_angles.unwrap()[0].min(20.0));
}

#[test]
fn settings_out_of_range_are_refused() {
    let (mesh, _) = fill(&BALL, 0.5);
    let default = Irregularity::default();
    for bad in [
        Irregularity { strength: 1.5, ..default },
        Irregularity { strength: f64::NAN, ..default },
        Irregularity { min_dihedral: 61.0, ..default },
        Irregularity { max_dihedral: 80.0, ..default },
    ] {
        assert!(matches!(bad.apply(&mesh), Err(MeshError::Size { .. })));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn blobs_of_all_kinds_give_sound_meshes(
        numbers in prop::collection::vec((-1.0..1.0_f64, -1.0..1.0_f64, -1.0..1.0_f64, 0.05..0.6_f64), 2..9),
        blend in 0.0..0.3_f64,
        seed: u64,
    ) {
        let mut text = format!("blend {blend}\n");
        for pair in numbers.windows(2) {
            let [(x, y, z, r), (u, v, w, s)] = *pair else { continue };
            text += &format!("cone {x} {y} {z} {r} {u} {v} {w} {s}\nellip {w} {u} {y} {r} {s} {r}\n");
        }
        let shape: Blend = text.parse().unwrap();
        let (mesh, _) = fill(&shape, 0.14);
        check_stuffed(&mesh);
        let (mesh, _) = Irregularity { seed, ..Irregularity::default() }.apply(&mesh).unwrap();
        check(&mesh, 10.0, 165.0);
    }
}
