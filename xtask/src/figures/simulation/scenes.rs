//! The scenes of figures 4 to 7.

use glam::Vec3;
use vivace_mesh::cloth;
use vivace_model::{Forces, Model, ModelBuilder, State};

use crate::figures::FigureError;
use crate::figures::families::Families;

/// A model where it begins, and what acts on it.
#[derive(Debug, Clone)]
pub struct Scene {
    /// Short name.
    pub id: &'static str,
    /// The model.
    pub model: Model,
    /// Where it begins.
    pub state: State,
    /// What acts on it.
    pub forces: Forces,
    /// What it is, for captions.
    pub caption: String,
}

/// Time step of all of the paper's comparisons \[s\].
pub const H: f32 = 1.0 / 30.0;

/// Figure 4: a cloth of about `n_vertices`, a square meter, held at two corners.
///
/// # Errors
/// A size without a mesh.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a rounded square root")]
pub fn tablecloth(n_vertices: usize) -> Result<Scene, FigureError> {
    let width = ((n_vertices as f64).sqrt().round() as usize).max(3);
    let mesh = cloth::regular(width, width, 0.99 / (width as f32 - 1.0))?;
    let mut builder = ModelBuilder::new();
    builder.cloth(&mesh, 0.2)?;
    let (edges, hinges) = (mesh.edges(), mesh.hinges());
    builder.springs(0, &edges, 100.0)?;
    builder.hinges(0, &hinges, 1e-5, false)?;
    builder.pin(0)?;
    builder.pin(u32::try_from(width - 1).unwrap_or(u32::MAX))?;
    let (model, state) = builder.build()?;
    let caption = format!(
        "Tablecloth: {} vertices, {} triangles, {} springs (100 N/m), {} hinges (10\u{207b}\u{2075} J); 0.2 kg/m\u{b2}; it begins flat and level and is held at two corners. The paper gives neither stiffness nor mass; these are ours.",
        model.n_particles(),
        mesh.triangles().len(),
        edges.len(),
        hinges.len()
    );
    Ok(Scene { id: "tablecloth", model, state, forces: Forces::default(), caption })
}

/// Figure 5: the armadillo or its stand-in of about `n_vertices`, its feet held, pushed over.
///
/// # Errors
/// What the generators refuse.
pub fn armadillo(families: &Families, n_vertices: usize) -> Result<Scene, FigureError> {
    let (mesh, origin) = families.armadillo_mesh(n_vertices)?;
    let height = |p: &Vec3| p.y;
    let (low, high) = ends(mesh.positions().iter().map(height));
    let size = (high - low).max(f32::MIN_POSITIVE);
    let mut builder = ModelBuilder::new();
    builder.volume(&mesh, 1000.0)?;
    builder.tet_strain(0, mesh.tets(), 1e5)?;
    builder.tet_volume(0, mesh.tets(), 1e5, [0.95, 1.05])?;
    for (particle, p) in (0..).zip(mesh.positions()) {
        if p.y < low + 0.06 * size {
            builder.pin(particle)?;
        }
    }
    let (model, mut state) = builder.build()?;
    for (particle, velocity) in (0..).zip(&mut state.velocities) {
        if !model.is_pinned(particle) {
            let share = (state.positions[particle as usize].y - low) / size;
            *velocity = Vec3::new(0.0, 0.0, 2.0 * size * share);
        }
    }
    let caption = format!(
        "Armadillo: {} vertices, {} tetrahedra, each keeping its shape (10\u{2075} Pa) and its volume to 5% (10\u{2075} Pa); 1000 kg/m\u{b3}, height {size:.2} m; its feet are held, and it begins at rest shape, pushed over at 2 heights a second. {origin} The paper gives neither stiffness nor mass; these are ours.",
        model.n_particles(),
        mesh.tets().len(),
    );
    Ok(Scene { id: "armadillo", model, state, forces: Forces::default(), caption })
}

/// The least and the greatest.
pub fn ends(values: impl Iterator<Item = f32>) -> (f32, f32) {
    values.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
}
