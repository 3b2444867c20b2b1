//! One body of a scene.

use std::path::Path;

use glam::{EulerRot, Quat, Vec3};
use serde::{Deserialize, Serialize};
use vivace_mesh::Mesh;
use vivace_model::{ModelBuilder, ModelError};

use crate::shape::moved;
use crate::{BodyError, Drag, Held, Material, Select, Shape};

/// A mesh of some material, put somewhere and held at some of its vertices.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Body {
    /// Its mesh.
    pub shape: Shape,
    /// What it is made of.
    pub material: Material,
    /// Times this \[1\], before it is turned; 1 if left out.
    #[serde(default = "one")]
    pub scale: f32,
    /// Turned about the x axis, then y, then z \[degrees\], before it is moved.
    #[serde(default)]
    pub rotate: Vec3,
    /// Moved by this \[m\].
    #[serde(default)]
    pub at: Vec3,
    /// Velocity at the start \[m/s\].
    #[serde(default)]
    pub velocity: Vec3,
    /// Vertices that stay where they are.
    #[serde(default)]
    pub pins: Vec<Select>,
    /// Vertices that are held by springs, whose ends may be moved.
    #[serde(default)]
    pub attachments: Vec<Attach>,
    /// Vertices that are taken while it runs, follow a path, and may be let go.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub drags: Vec<Drag>,
}

/// Vertices held by a spring each. Attachments are numbered through all bodies in the order of the scene, those of one selection
/// by vertex.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Attach {
    /// Which vertices.
    pub select: Select,
    /// Stiffness \[N/m\].
    pub stiffness: f32,
    /// The end of the spring, seen from where the vertex is at the start \[m\].
    #[serde(default)]
    pub offset: Vec3,
}

fn one() -> f32 {
    1.0
}

impl Body {
    /// In its own place, free.
    #[must_use]
    pub fn new(shape: Shape, material: Material) -> Self {
        Self {
            shape,
            material,
            scale: 1.0,
            rotate: Vec3::ZERO,
            at: Vec3::ZERO,
            velocity: Vec3::ZERO,
            pins: Vec::new(),
            attachments: Vec::new(),
            drags: Vec::new(),
        }
    }

    /// Adds it, its velocity once for each vertex, and what is to be dragged.
    pub(crate) fn add(
        &self,
        builder: &mut ModelBuilder,
        velocities: &mut Vec<Vec3>,
        drags: &mut Vec<Held>,
        folder: &Path,
    ) -> Result<(), BodyError> {
        self.check()?;
        let mesh = self.shape.mesh(folder)?;
        let placed = self.placed(&mesh)?;
        let first = self.material.add(builder, &placed)?;
        let own = match &mesh {
            Mesh::Tri(mesh) => mesh.positions(),
            Mesh::Tet(mesh) => mesh.positions(),
            _ => &[],
        };
        velocities.extend(own.iter().map(|_| self.velocity));
        for (index, select) in self.pins.iter().enumerate() {
            for vertex in pick("pins", index, select, own)? {
                builder.pin(first + vertex)?;
            }
        }
        for (index, attach) in self.attachments.iter().enumerate() {
            for vertex in pick("attachments", index, &attach.select, own)? {
                let particle = first + vertex;
                let target = builder.positions()[particle as usize] + attach.offset;
                builder.attach(particle, target, attach.stiffness)?;
            }
        }
        for (index, drag) in self.drags.iter().enumerate() {
            drag.check().map_err(|source| BodyError::Drag { index, source })?;
            let particles = pick("drags", index, &drag.select, own)?.iter().map(|v| first + v).collect();
            drags.push(Held { particles, hold: drag.hold, path: drag.path.clone(), release: drag.release });
        }
        Ok(())
    }

    fn check(&self) -> Result<(), ModelError> {
        if !(self.scale > 0.0 && self.scale.is_finite()) {
            return Err(ModelError::Value { what: "scale", value: self.scale, need: "finite and positive" });
        }
        for (what, value) in [("rotate", self.rotate), ("at", self.at), ("velocity", self.velocity)] {
            if let Some(&value) = value.as_ref().iter().find(|v| !v.is_finite()) {
                return Err(ModelError::Value { what, value, need: "finite" });
            }
        }
        Ok(())
    }

    fn placed(&self, mesh: &Mesh) -> Result<Mesh, BodyError> {
        if self.scale == 1.0 && self.rotate == Vec3::ZERO && self.at == Vec3::ZERO {
            return Ok(mesh.clone());
        }
        let [x, y, z] = self.rotate.to_array().map(f32::to_radians);
        let turn = Quat::from_euler(EulerRot::XYZEx, x, y, z);
        moved(mesh, |p| turn * (p * self.scale) + self.at)
    }
}

fn pick(
    list: &'static str,
    index: usize,
    select: &Select,
    positions: &[Vec3],
) -> Result<Vec<u32>, BodyError> {
    let vertices = select.pick(positions).map_err(|reason| BodyError::Select { list, index, reason })?;
    if vertices.is_empty() {
        let min = positions.iter().copied().reduce(Vec3::min).unwrap_or_default();
        let max = positions.iter().copied().reduce(Vec3::max).unwrap_or_default();
        return Err(BodyError::Nothing { list, index, min, max });
    }
    Ok(vertices)
}
