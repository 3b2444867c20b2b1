//! What a builder refuses, says and leaves as it was, and the models it makes.

#![expect(clippy::unwrap_used, reason = "what fails here fails a test")]

use glam::Vec3;
use vivace_kernels::constraint::Constraint;
use vivace_mesh::{TriMesh, beam, cloth};
use vivace_model::{
    Constraints, KindVisitor, Model, ModelBuilder, ModelError, State, Store, check_time_step,
};

const CORNERS: [Vec3; 4] = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];

/// Two bodies: a particle in the xy plane, and the corners of a tetrahedron, from particle 1 on.
fn two_bodies() -> ModelBuilder {
    let mut builder = ModelBuilder::new();
    builder.particles(&[Vec3::new(1.0, 1.0, 0.0)], &[1.0]).unwrap();
    assert_eq!(builder.particles(&CORNERS, &[1.0; 4]).unwrap(), 1);
    builder
}

/// What `call` is refused with; it must leave the builder as it was.
fn refused<T: std::fmt::Debug>(call: impl FnOnce(&mut ModelBuilder) -> Result<T, ModelError>) -> ModelError {
    let mut builder = two_bodies();
    let before = format!("{builder:?}");
    let error = call(&mut builder).unwrap_err();
    assert_eq!(format!("{builder:?}"), before, "{error}");
    error
}

#[test]
fn a_refused_call_changes_nothing() {
    const TETS: [[u32; 4]; 2] = [[0, 1, 2, 3], [0, 1, 2, 9]];
    const TRIANGLES: [[u32; 3]; 2] = [[0, 1, 2], [0, 1, 1]];
    let far = [Vec3::ZERO, Vec3::splat(1e20)];
    let sheet = cloth::regular(2, 2, 100.0).unwrap();
    refused(|b| b.springs(1, &[[0, 1], [1, 2], [2, 2]], 1.0));
    refused(|b| b.hinges(1, &TETS, 1.0, false));
    refused(|b| b.triangle_strain(1, &TRIANGLES, 1.0, 0.1));
    refused(|b| b.tet_strain(1, &TETS, 1.0));
    refused(|b| b.tet_volume(1, &TETS, 1.0, [1.0; 2]));
    refused(|b| b.tet_volume(1, &[[0, 1, 2, 3]], 1.0, [1.0, 0.5]));
    refused(|b| b.attach(1, Vec3::splat(1e30), 1.0));
    refused(|b| b.attach(5, Vec3::ZERO, 1.0));
    refused(|b| b.pin(5));
    refused(|b| b.particles(&far, &[1.0; 2]));
    refused(|b| b.particles(&far[..1], &[1.0; 2]));
    refused(|b| b.cloth(&sheet, f32::MAX));
    refused(|b| b.cloth(&sheet, -1.0));
}

#[test]
fn an_error_names_its_element_and_particles_as_the_model_numbers_them() {
    let text = |error: ModelError| error.to_string();
    let index = text(refused(|b| b.springs(1, &[[0, 1], [2, 5]], 1.0)));
    assert!(index.starts_with("spring 1 names particle 6, but there are only 5"), "{index}");
    let beyond_32_bits = text(refused(|b| b.springs(u32::MAX, &[[0, 1]], 1.0)));
    assert!(beyond_32_bits.contains("names particle 4294967295"), "{beyond_32_bits}");
    let repeated = refused(|b| b.springs(1, &[[3, 3]], 1.0));
    let flat = refused(|b| b.tet_strain(0, &[[0, 1, 2, 3]], 1.0));
    let degenerate =
        |kind, particles: &[u32]| ModelError::Degenerate { kind, element: 0, particles: particles.to_vec() };
    assert_eq!(repeated, degenerate("spring", &[4, 4]));
    assert_eq!(flat, degenerate("tetrahedron", &[0, 1, 2, 3]));
    let place = text(refused(|b| b.particles(&[Vec3::ZERO, Vec3::NAN], &[1.0; 2])));
    assert!(place.contains("at particle 6") && !place.contains("state"), "{place}");
    let target = text(refused(|b| b.attach(0, Vec3::NAN, 1.0)));
    assert!(target.contains("attachment 0"), "{target}");
}

#[test]
fn masses_from_densities_are_finite() {
    let sheet = cloth::regular(3, 3, 100.0).unwrap();
    let heavy = refused(|b| b.cloth(&sheet, 3e38));
    assert!(matches!(heavy, ModelError::Density { particle: 5, .. }), "{heavy}");
    let solid = beam::regular([1, 1, 1], 100.0).unwrap();
    assert!(matches!(refused(|b| b.volume(&solid, 3e38)), ModelError::Density { .. }));
    let speck = cloth::regular(2, 2, 1e-10).unwrap();
    assert!(matches!(refused(|b| b.cloth(&speck, 1e-30)), ModelError::Density { particle: 5, .. }));
    // A vertex of no triangle has no mass: it may be pinned, or is refused when all is built.
    let spare = TriMesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z], vec![[0, 1, 2]]).unwrap();
    let mut builder = ModelBuilder::new();
    builder.cloth(&spare, 1.0).unwrap();
    let error = builder.clone().build().unwrap_err();
    assert!(matches!(error, ModelError::Mass { particle: 3, .. }), "{error}");
    builder.pin(3).unwrap();
    assert!(builder.build().unwrap().0.is_pinned(3));
}

#[test]
fn states_builders_and_targets_have_one_bound() {
    for (far, is_ok) in [(1e12, true), (1.001e12, false), (f32::INFINITY, false), (f32::NAN, false)] {
        let far = Vec3::new(0.0, far, 0.0);
        let mut builder = ModelBuilder::new();
        assert_eq!(builder.particles(&[far], &[1.0]).is_ok(), is_ok, "{far}");
        let mut builder = two_bodies();
        assert_eq!(builder.attach(0, far, 1.0).is_ok(), is_ok, "{far}");
        builder.attach(1, Vec3::ZERO, 1.0).unwrap();
        let (mut model, mut state) = builder.build().unwrap();
        assert_eq!(model.set_attachment_target(0, far).is_ok(), is_ok, "{far}");
        state.positions[2] = far;
        assert_eq!(state.check(&model).is_ok(), is_ok, "{far}");
        assert_eq!(State::is_in_range(far), is_ok, "{far}");
    }
}

#[test]
fn the_farthest_springs_have_finite_rest_lengths() {
    let mut builder = ModelBuilder::new();
    builder.particles(&[Vec3::splat(-1e12), Vec3::splat(1e12)], &[1.0; 2]).unwrap();
    builder.springs(0, &[[0, 1]], 1.0).unwrap();
    assert!(builder.build().unwrap().0.constraints().springs.rest[0].rest.is_finite());
}

#[test]
fn an_attachment_that_is_not_there_is_named() {
    let mut builder = two_bodies();
    builder.attach(0, Vec3::ZERO, 1.0).unwrap();
    builder.attach(3, Vec3::ZERO, 1.0).unwrap();
    let (mut model, _) = builder.build().unwrap();
    let error = model.set_attachment_target(2, Vec3::ZERO).unwrap_err().to_string();
    assert_eq!(error, "there is no attachment 2: the model has 2, numbered from 0");
}

#[test]
fn bodies_keep_their_particles_and_attachments() {
    let mut builder = two_bodies();
    builder.attach(4, Vec3::ZERO, 1.0).unwrap();
    let mut other = two_bodies();
    other.attach(0, Vec3::ZERO, 1.0).unwrap();
    other.attach(4, Vec3::ZERO, 1.0).unwrap();
    other.attach(1, Vec3::ZERO, 1.0).unwrap();
    builder.append(other).unwrap();
    let (model, _) = builder.build().unwrap();
    assert_eq!(model.bodies(), [0..1, 1..5, 5..6, 6..10]);
    let attachments = |body| model.attachments_of(body).collect::<Vec<_>>();
    assert_eq!((0..5).map(attachments).collect::<Vec<_>>(), [vec![], vec![0], vec![1], vec![2, 3], vec![]]);
}

#[test]
fn time_steps_have_one_bound() {
    for (h, is_ok) in [(1e-30, true), (1000.0, true), (1000.1, false), (0.0, false), (-1.0, false)] {
        assert_eq!(check_time_step(h).is_ok(), is_ok, "{h}");
    }
    assert!(check_time_step(f32::NAN).is_err());
}

/// A constraint of each kind, no two of which share a particle.
fn every_kind() -> Model {
    let mut builder = ModelBuilder::new();
    let mut corners = |add: &mut dyn FnMut(&mut ModelBuilder, u32)| {
        let first = builder.particles(&CORNERS, &[1.0; 4]).unwrap();
        add(&mut builder, first);
    };
    corners(&mut |b, first| b.springs(first, &[[0, 1]], 1.0).unwrap());
    corners(&mut |b, first| assert_eq!(b.hinges(first, &[[0, 1, 2, 3]], 1.0, true).unwrap(), 0));
    corners(&mut |b, first| b.triangle_strain(first, &[[0, 1, 2]], 1.0, 0.1).unwrap());
    corners(&mut |b, first| b.tet_strain(first, &[[0, 1, 2, 3]], 1.0).unwrap());
    corners(&mut |b, first| b.tet_volume(first, &[[0, 1, 2, 3]], 1.0, [1.0; 2]).unwrap());
    corners(&mut |b, first| assert_eq!(b.attach(first, Vec3::ZERO, 1.0).unwrap(), 0));
    builder.build().unwrap().0
}

/// The particles of all constraints.
#[derive(Default)]
struct Members(Vec<Vec<u32>>);

impl KindVisitor for Members {
    fn visit<C: Constraint<N, R>, const N: usize, const R: usize>(&mut self, store: &Store<C, N>) {
        self.0.extend(store.particles.iter().map(|particles| particles.to_vec()));
    }
}

#[test]
fn every_kind_is_in_the_graphs() {
    let model = every_kind();
    // A new kind does not compile here before `every_kind` holds it.
    let Constraints { springs, bending, triangle_strain, tet_strain, tet_volume, attachments } =
        model.constraints();
    let n_of_kinds = [
        springs.len(),
        bending.len(),
        triangle_strain.len(),
        tet_strain.len(),
        tet_volume.len(),
        attachments.len(),
    ];
    assert!(n_of_kinds.iter().all(|&n| n == 1), "{n_of_kinds:?}");
    let mut members = Members::default();
    model.constraints().visit(&mut members);
    assert_eq!(members.0.len(), n_of_kinds.len());
    let graph = model.graph().unwrap();
    let incidence = model.constraints().graph_builder(model.n_particles()).incidence().unwrap();
    for (constraint, particles) in (0..).zip(&members.0) {
        for &particle in particles {
            // Ascending, as they were added.
            let others: Vec<u32> = particles.iter().copied().filter(|&other| other != particle).collect();
            assert_eq!(graph.csr().row(particle), others, "constraint {constraint}");
            assert_eq!(incidence.constraints(particle), [constraint]);
        }
    }
}
