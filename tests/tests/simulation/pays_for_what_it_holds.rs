//! A kind of constraint that is not there costs nothing.

use vivace_model::{Model, ModelBuilder};
use vivace_solver::pd::ProjectiveDynamics;
use vivace_solver::{Framework, LocalStep, Relaxation, Solver, System, VertexSolve};
use vivace_tests::scenes::{cloth, free_cloth, gauss_seidel, plain};

fn system(model: &Model, framework: Framework) -> System {
    System::new(model.clone(), Solver { framework, ..plain(gauss_seidel(1.0)) }).unwrap()
}

fn n_entries(model: &Model) -> usize {
    ProjectiveDynamics::new(model, LocalStep::Fused, VertexSolve::Diagonal, Relaxation::default())
        .unwrap()
        .n_entries()
}

#[test]
fn springs_alone() {
    let (model, _) = cloth(10, 100.0, None);
    let n_springs = model.constraints().springs.len();
    // Rows of the two pinned particles, of degree 3 and 2, are not there.
    assert_eq!(n_entries(&model), 2 * n_springs - 3 - 2);
    assert_eq!(system(&model, Framework::default()).n_passes(), 0);
    assert_eq!(system(&model, Framework::PositionBased).n_passes(), 1);
}

#[test]
fn flat_hinges_widen_rows_and_need_no_pass() {
    let (springs, hinges) = (cloth(10, 100.0, None).0, cloth(10, 100.0, Some(1e-4)).0);
    assert!(n_entries(&hinges) > n_entries(&springs));
    assert_eq!(n_entries(&hinges), {
        let graph = hinges.graph().unwrap();
        (0..100).filter(|&p| !hinges.is_pinned(p)).map(|p| graph.neighbors(p).len()).sum::<usize>()
    });
    assert_eq!(system(&hinges, Framework::default()).n_passes(), 0);
    assert_eq!(system(&hinges, Framework::PositionBased).n_passes(), 2);
}

#[test]
fn each_kind_is_one_pass() {
    let mesh = vivace_mesh::beam::regular([2, 1, 1], 0.1).unwrap();
    let with = |add: &dyn Fn(&mut ModelBuilder)| {
        let mut builder = ModelBuilder::new();
        builder.volume(&mesh, 100.0).unwrap();
        add(&mut builder);
        let model = builder.build().unwrap().0;
        [Framework::default(), Framework::PositionBased].map(|framework| system(&model, framework).n_passes())
    };
    assert_eq!(with(&|_| ()), [0, 0]);
    assert_eq!(with(&|b| b.tet_strain(0, mesh.tets(), 1e4).unwrap()), [1, 1]);
    assert_eq!(with(&|b| assert_eq!(b.attach(0, glam::Vec3::ZERO, 10.0), Ok(0))), [0, 1]);
    let both = with(&|b| {
        b.tet_strain(0, mesh.tets(), 1e4).unwrap();
        b.tet_volume(0, mesh.tets(), 1e4, [0.9, 1.1]).unwrap();
    });
    assert_eq!(both, [2, 2]);
}

/// Flat on a curved rest: the pass has the curved ones only.
#[test]
fn curved_hinges_need_a_pass() {
    let mesh = vivace_mesh::cloth::regular(4, 4, 0.1).unwrap();
    let mut builder = free_cloth(4, 100.0, None);
    builder.hinges(0, &mesh.hinges(), 1e-3, true).unwrap();
    // At rest they are flat.
    let flat = builder.build().unwrap().0;
    assert_eq!(system(&flat, Framework::default()).n_passes(), 0);
    let bent: Vec<_> = mesh.positions().iter().map(|q| glam::Vec3::new(q.x, q.x * q.x, q.z)).collect();
    let mut builder = ModelBuilder::new();
    builder.particles(&bent, &[0.01; 16]).unwrap();
    builder.hinges(0, &mesh.hinges(), 1e-3, true).unwrap();
    let curved = builder.build().unwrap().0;
    assert_eq!(system(&curved, Framework::default()).n_passes(), 1);
}
