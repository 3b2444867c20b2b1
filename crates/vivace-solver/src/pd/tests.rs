//! How many entries Y has: rows hold what constraints join, and nothing else.

use vivace_mesh::{beam, cloth};
use vivace_model::{Model, ModelBuilder};

use super::ProjectiveDynamics;
use crate::{LocalStep, Relaxation, VertexSolve};

/// Entries of Y off its diagonal.
fn n_entries(model: &Model) -> usize {
    let made =
        ProjectiveDynamics::new(model, LocalStep::Fused, VertexSolve::Diagonal, Relaxation::default(), &[]);
    made.unwrap().rows.columns.len()
}

/// Neighbors of all free particles.
fn n_neighbors(model: &Model) -> usize {
    let graph = model.graph().unwrap();
    let free = (0..).take(model.n_particles()).filter(|&particle| !model.is_pinned(particle));
    free.map(|particle| graph.neighbors(particle).len()).sum()
}

/// A cloth of 10 by 10, two corners pinned, with what `add` adds.
fn held_cloth(add: impl FnOnce(&mut ModelBuilder, &vivace_mesh::TriMesh)) -> Model {
    let mesh = cloth::regular(10, 10, 0.1).unwrap();
    let mut builder = ModelBuilder::new();
    builder.cloth(&mesh, 0.2).unwrap();
    add(&mut builder, &mesh);
    builder.pin(0).unwrap();
    builder.pin(9).unwrap();
    builder.build().unwrap().0
}

#[test]
fn springs_alone() {
    let mut n_springs = 0;
    let model = held_cloth(|builder, mesh| {
        n_springs = mesh.edges().len();
        builder.springs(0, &mesh.edges(), 100.0).unwrap();
    });
    // Rows of the two pinned particles, of degree 3 and 2, are not there.
    assert_eq!(n_entries(&model), 2 * n_springs - 3 - 2);
}

#[test]
fn hinges_widen_rows() {
    let springs = |builder: &mut ModelBuilder, mesh: &vivace_mesh::TriMesh| {
        builder.springs(0, &mesh.edges(), 100.0).unwrap();
    };
    let narrow = held_cloth(springs);
    let wide = held_cloth(|builder, mesh| {
        springs(builder, mesh);
        builder.hinges(0, &mesh.hinges(), 1e-4, false).unwrap();
    });
    assert!(n_entries(&wide) > n_entries(&narrow));
    assert_eq!(n_entries(&wide), n_neighbors(&wide));
}

#[test]
fn each_kind_joins_its_own_particles() {
    let strain = held_cloth(|builder, mesh| {
        builder.triangle_strain(0, mesh.triangles(), 100.0, 0.01).unwrap();
    });
    let attachments = held_cloth(|builder, mesh| {
        builder.attach(50, mesh.positions()[50], 100.0).unwrap();
    });
    let solid = beam::regular([4, 1, 1], 0.1).unwrap();
    let mut builder = ModelBuilder::new();
    builder.volume(&solid, 100.0).unwrap();
    assert_eq!(n_entries(&builder.clone().build().unwrap().0), 0);
    builder.tet_volume(0, solid.tets(), 1e4, [0.99, 1.01]).unwrap();
    let volume = builder.clone().build().unwrap().0;
    builder.tet_strain(0, solid.tets(), 1e4).unwrap();
    let both = builder.build().unwrap().0;
    for model in [&strain, &attachments, &volume, &both] {
        assert_eq!(n_entries(model), n_neighbors(model));
    }
    assert_eq!(n_entries(&attachments), 0);
    assert!(n_entries(&volume) > 0);
    assert_eq!(n_entries(&volume), n_entries(&both));
}
