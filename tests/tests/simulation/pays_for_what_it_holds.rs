//! A kind of constraint that is not there costs nothing: no store, no pass. Entries of Y are counted beside them, in the solver's `pd`.

use vivace_kernels::constraint::Constraint;
use vivace_model::{KindVisitor, Model, ModelBuilder, Store};
use vivace_solver::{Framework, Solver, System};
use vivace_tests::scenes::{Kind, cloth, free_cloth, gauss_seidel, plain};

fn system(model: &Model, framework: Framework) -> System {
    System::new(model.clone(), Solver { framework, ..plain(gauss_seidel(1.0)) }).unwrap()
}

#[test]
fn springs_alone() {
    let (model, _) = cloth(10, 100.0, None);
    assert_eq!(system(&model, Framework::default()).n_passes(), 0);
    assert_eq!(system(&model, Framework::PositionBased).n_passes(), 1);
}

#[test]
fn flat_hinges_need_no_pass() {
    let hinges = cloth(10, 100.0, Some(1e-4)).0;
    assert_eq!(system(&hinges, Framework::default()).n_passes(), 0);
    assert_eq!(system(&hinges, Framework::PositionBased).n_passes(), 2);
}

/// How many kinds a model stores, and how many constraints.
struct Stores(usize, usize);

impl KindVisitor for Stores {
    fn visit<C: Constraint<N, R>, const N: usize, const R: usize>(&mut self, store: &Store<C, N>) {
        self.0 += 1;
        self.1 += store.len();
    }
}

#[test]
fn each_kind_is_one_store_and_at_most_one_pass() {
    for bodies in Kind::alone_and_together() {
        let (model, _) = bodies.build();
        let mut stores = Stores(0, 0);
        model.constraints().visit(&mut stores);
        // Hinges are one kind to the model; springs, flat hinges and attachments are built into Y.
        let n_kinds = bodies.kinds.iter().filter(|&&kind| kind != Kind::FlatHinge).count().max(1);
        assert_eq!((stores.0, stores.1), (n_kinds, model.constraints().len()), "{:?}", bodies.kinds);
        let is_built_in = |kind: &&Kind| matches!(kind, Kind::Spring | Kind::FlatHinge | Kind::Attachment);
        let n_local = bodies.kinds.iter().filter(|kind| !is_built_in(kind)).count();
        assert_eq!(system(&model, Framework::default()).n_passes(), n_local, "{:?}", bodies.kinds);
        assert_eq!(system(&model, Framework::PositionBased).n_passes(), n_kinds, "{:?}", bodies.kinds);
    }
}

#[test]
fn particles_alone_need_no_pass() {
    let mut builder = ModelBuilder::new();
    builder.volume(&vivace_mesh::beam::regular([2, 1, 1], 0.1).unwrap(), 100.0).unwrap();
    let model = builder.build().unwrap().0;
    for framework in [Framework::default(), Framework::PositionBased] {
        assert_eq!(system(&model, framework).n_passes(), 0);
    }
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
