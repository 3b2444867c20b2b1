//! The scenes of figures 4 to 7: the ready-made ones of `vivace-scene`.

use std::path::Path;

use glam::Vec3;
use vivace_model::{Forces, Model, State};
use vivace_scene::{SceneError, Select, Shape, Source};

use crate::figures::families::Families;
use crate::report::Value;

/// A scene, built.
#[derive(Debug, Clone)]
pub struct Scene {
    /// Its name.
    pub name: String,
    /// The model.
    pub model: Model,
    /// Where it begins.
    pub state: State,
    /// What acts on it.
    pub forces: Forces,
    /// Time step \[s\].
    pub h: f32,
    /// What it is, for captions.
    pub caption: String,
}

impl Scene {
    /// Builds a scene; files are looked for in `folder`.
    ///
    /// # Errors
    /// What the scene refuses.
    pub fn build(scene: &vivace_scene::Scene, folder: &Path) -> Result<Self, SceneError> {
        let (model, state) = scene.build(folder)?;
        let name = if scene.name.is_empty() { "scene" } else { &scene.name };
        let caption = format!(
            "{name}: {}; h = {} ms.",
            contents(scene, &model),
            Value::Real(1e3 * f64::from(scene.time_step)).shown()
        );
        Ok(Self { name: name.to_owned(), model, state, forces: scene.forces, h: scene.time_step, caption })
    }

    /// Whether it holds tetrahedra, whose projections cost most.
    pub fn has_tetrahedra(&self) -> bool {
        let constraints = self.model.constraints();
        !constraints.tet_strain.is_empty() || !constraints.tet_volume.is_empty()
    }

    fn with_note(mut self, note: &str) -> Self {
        self.caption =
            format!("{} {note} The paper gives neither stiffness nor mass; these are ours.", self.caption);
        self
    }
}

/// What a scene holds, and of what its bodies are.
pub fn contents(scene: &vivace_scene::Scene, model: &Model) -> String {
    let c = model.constraints();
    let n_held = (0..).take(model.n_particles()).filter(|&particle| model.is_pinned(particle)).count();
    let counts = [
        (c.springs.len(), "springs"),
        (c.bending.len(), "hinges"),
        (c.triangle_strain.len(), "triangles with a strain limit"),
        (c.tet_strain.len(), "tetrahedra that keep their shape"),
        (c.tet_volume.len(), "that keep their volume"),
        (c.attachments.len(), "attachments"),
        (n_held, "vertices held"),
    ];
    let mut parts = vec![format!("{} vertices", model.n_particles())];
    parts.extend(counts.iter().filter(|(n, _)| *n > 0).map(|(n, what)| format!("{n} {what}")));
    let mut materials: Vec<String> = scene.bodies.iter().map(|body| body.material.to_string()).collect();
    materials.dedup();
    format!("{} ({})", parts.join(", "), materials.join("; "))
}

/// Vertices along a side of a square cloth of about `n_vertices`.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a rounded square root")]
pub fn side(n_vertices: usize) -> usize {
    ((n_vertices as f64).sqrt().round() as usize).max(3)
}

/// Figures 4 and 6: a cloth of about `n_vertices`, a square meter, held at two corners.
///
/// # Errors
/// A size without a mesh.
pub fn tablecloth(n_vertices: usize) -> Result<Scene, SceneError> {
    let scene = Scene::build(&vivace_scene::tablecloth(side(n_vertices)), Path::new("."))?;
    Ok(scene.with_note("It begins flat and level, held at two corners."))
}

/// Figures 5 and 7: the armadillo or its stand-in of about `n_vertices`, hanging by one hand.
///
/// # Errors
/// What the generators refuse; a mesh of the user's that cannot be filled.
pub fn armadillo(families: &Families, n_vertices: usize) -> Result<Scene, SceneError> {
    let mut scene = vivace_scene::armadillo(n_vertices);
    for body in &mut scene.bodies {
        if let Shape::Sdf { irregular, .. } = &mut body.shape {
            *irregular = Some(families.seed());
        }
        let Some((path, bounds)) = families.own_armadillo() else { continue };
        body.shape = Shape::Sdf {
            source: Source::Path(path.to_owned()),
            vertices: n_vertices,
            irregular: Some(families.seed()),
        };
        // Scanned models come in any unit: a meter high. A raised hand is what reaches farthest to the side.
        let (min, max) = (bounds.min.as_vec3(), bounds.max.as_vec3());
        body.scale = 1.0 / (max.y - min.y);
        let wrist = max.x - 0.06 * (max.x - min.x);
        body.pins = vec![Select::Box { min: Vec3::new(wrist, min.y, min.z), max }];
    }
    let scene = Scene::build(&scene, Path::new("."))?;
    let origin = families.armadillo_origin();
    Ok(scene.with_note(&format!("It begins at rest shape and swings from one hand. {origin}")))
}
