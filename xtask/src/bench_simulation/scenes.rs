//! The workloads.

use glam::Vec3;
use vivace_mesh::{beam, cloth as cloths};
use vivace_solver::{Model, ModelBuilder, State};

use crate::figures::FigureError;

/// Time step of workload A \[s\].
pub(super) const STEP: f32 = 1.0 / 30.0;
/// Side of a cloth \[m\].
const SIDE: f32 = 0.99;
/// Density of a cloth \[kg/m²\].
const CLOTH_DENSITY: f32 = 0.2;
/// Stiffness of a hinge \[J\].
const BENDING: f32 = 1e-5;
/// Density of the bar \[kg/m³\].
const BAR_DENSITY: f32 = 1000.0;
/// Stiffness of the bar \[Pa\], and of the springs along its edges \[N/m\].
const BAR_STIFFNESS: (f32, f32) = (1e5, 1000.0);

/// Workload A with `n` × `n` vertices and springs of `stiffness` \[N/m\]: two corners pinned.
pub(super) fn cloth(n: usize, stiffness: f32, is_bending: bool) -> Result<(Model, State), FigureError> {
    let mesh = cloths::regular(n, n, SIDE / (n as f32 - 1.0))?;
    let mut builder = ModelBuilder::new();
    builder.cloth(&mesh, CLOTH_DENSITY)?;
    builder.springs(0, &mesh.edges(), stiffness)?;
    if is_bending {
        builder.hinges(0, &mesh.hinges(), BENDING, false)?;
    }
    builder.pin(0)?;
    // A mesh's vertices have 32-bit numbers.
    builder.pin(u32::try_from(n - 1).unwrap_or(u32::MAX))?;
    Ok(builder.build()?)
}

/// What the tetrahedra of workload B are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Material {
    /// Springs along the edges, and tetrahedra that keep their volume.
    EdgesAndVolume,
    /// Tetrahedra that keep their shape.
    Strain,
    /// Tetrahedra that keep their volume.
    Volume,
}

/// Workload B of so many cells, one end pinned.
pub(super) fn bar(cells: [usize; 3], material: Material) -> Result<(Model, State), FigureError> {
    let mesh = beam::regular(cells, 0.01)?;
    let mut builder = ModelBuilder::new();
    builder.volume(&mesh, BAR_DENSITY)?;
    match material {
        Material::EdgesAndVolume => {
            builder.springs(0, &mesh.edges(), BAR_STIFFNESS.1)?;
            builder.tet_volume(0, mesh.tets(), BAR_STIFFNESS.0, [1.0, 1.0])?;
        }
        Material::Strain => builder.tet_strain(0, mesh.tets(), BAR_STIFFNESS.0)?,
        Material::Volume => builder.tet_volume(0, mesh.tets(), BAR_STIFFNESS.0, [1.0, 1.0])?,
    }
    for (particle, position) in (0..).zip(mesh.positions()) {
        if position.x < 1e-6 {
            builder.pin(particle)?;
        }
    }
    Ok(builder.build()?)
}

/// The bar a hundred times as long, and its particles moved by up to a cell: uneven tetrahedra, many of them inverted.
pub(super) fn stretched((model, state): &(Model, State)) -> (Model, State) {
    let mut state = state.clone();
    for (k, q) in state.positions.iter_mut().enumerate() {
        let k = k as f32;
        let shift = Vec3::new((12.9 * k).sin(), (78.2 * k).sin(), (37.7 * k).sin());
        *q = Vec3::new(100.0 * q.x, q.y, q.z) + shift * 0.01;
    }
    (model.clone(), state)
}

/// Mean of |l − l₀|/l₀ over the springs \[1\].
pub(super) fn mean_strain(model: &Model, positions: &[Vec3]) -> f64 {
    let springs = &model.constraints().springs;
    let strains = springs.particles.iter().zip(&springs.rest).map(|(pair, spring)| {
        let [a, b] = pair.map(|particle| positions[particle as usize].as_dvec3());
        (a.distance(b) / f64::from(spring.rest) - 1.0).abs()
    });
    strains.sum::<f64>() / springs.len().max(1) as f64
}
