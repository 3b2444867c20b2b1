//! What bodies collide with.

use std::path::Path;
use std::sync::Arc;

use glam::{EulerRot, Quat, Vec3};
use serde::{Deserialize, Serialize};
use vivace_collision::{CollisionError, Field, Options, Pose, Shape};
use vivace_mesh::stuffing::Stuffing;
use vivace_mesh::{MeshError, TriMesh, solid};

use crate::{BodyError, SceneError, Source};

/// Bodies collide with one another, with themselves and with obstacles.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Collisions {
    /// The distance that surfaces keep \[m\]: at most half the shortest edge of a mesh.
    pub thickness: f32,
    /// Coulomb's coefficient between bodies \[1\].
    #[serde(default = "friction")]
    pub friction: f32,
    /// Whether bodies collide with themselves and one another; if not, with obstacles only.
    #[serde(default = "yes")]
    pub self_collision: bool,
    /// Solids that do not give.
    #[serde(default)]
    pub obstacles: Vec<Obstacle>,
}

/// A solid that stands, or moves steadily.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Obstacle {
    /// Its shape.
    pub solid: Solid,
    /// Turned about the x axis, then y, then z \[degrees\], before it is moved.
    #[serde(default)]
    pub rotate: Vec3,
    /// Moved by this \[m\].
    #[serde(default)]
    pub at: Vec3,
    /// How fast it moves \[m/s\].
    #[serde(default)]
    pub velocity: Vec3,
    /// Coulomb's coefficient \[1\].
    #[serde(default = "friction")]
    pub friction: f32,
}

/// The shape of an obstacle.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Solid {
    /// All that is below y = 0.
    Plane,
    /// A ball about the origin.
    Sphere {
        /// Its radius \[m\].
        radius: f32,
    },
    /// All that is within `radius` of the y axis from −`half_length` to `half_length`.
    Capsule {
        /// Half the length of the straight part \[m\].
        half_length: f32,
        /// Its radius \[m\].
        radius: f32,
    },
    /// A box about the origin.
    Box {
        /// Half its edges \[m\].
        half_extent: Vec3,
    },
    /// The inside of a signed distance function, sampled.
    Sdf {
        /// The function.
        source: Source,
        /// Between samples \[m\].
        spacing: f32,
    },
}

fn friction() -> f32 {
    0.3
}

fn yes() -> bool {
    true
}

/// The most that a sampled solid may take \[bytes\].
const MAX_BYTES: u64 = 1 << 28;

impl Collisions {
    /// Of this thickness \[m\], with friction 0.3, with obstacles that stand.
    #[must_use]
    pub fn new(thickness: f32, obstacles: Vec<Obstacle>) -> Self {
        Self { thickness, friction: friction(), self_collision: true, obstacles }
    }

    /// Options for a detector.
    #[must_use]
    pub fn options(&self) -> Options {
        let (friction, self_collision) = (self.friction, self.self_collision);
        Options { friction, self_collision, ..Options::new(self.thickness) }
    }

    /// The obstacles where they stand at the start, in order. Files are looked for in `folder`.
    ///
    /// # Errors
    /// A solid that has no samples, a file that cannot be read, a value that is not finite: says which obstacle.
    pub fn obstacles(&self, folder: &Path) -> Result<Vec<vivace_collision::Obstacle>, SceneError> {
        let build = |(obstacle, of): (usize, &Obstacle)| {
            of.build(folder).map_err(|source| SceneError::Obstacle { obstacle, source })
        };
        self.obstacles.iter().enumerate().map(build).collect()
    }
}

impl Obstacle {
    /// In its own place, at rest, with friction 0.3.
    #[must_use]
    pub fn new(solid: Solid) -> Self {
        let zero = Vec3::ZERO;
        Self { solid, rotate: zero, at: zero, velocity: zero, friction: friction() }
    }

    /// Its surface in its own coordinates, to be looked at; of a plane a square of `extent` \[m\] to each side. Where bodies meet a sampled
    /// solid, they meet its samples, so their surface may differ from this one by a fraction of the spacing. Files are looked for in
    /// `folder`.
    ///
    /// # Errors
    /// A solid that has no surface, a file that cannot be read.
    pub fn surface(&self, folder: &Path, extent: f32) -> Result<TriMesh, ObstacleError> {
        const QUARTER: usize = 24;
        Ok(match &self.solid {
            Solid::Plane => {
                let corner = |x: f32, z: f32| extent * Vec3::new(x, 0.0, z);
                let corners = [corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0)];
                TriMesh::new(corners.to_vec(), vec![[0, 1, 2], [0, 2, 3]])?
            }
            &Solid::Sphere { radius } => solid::capsule(0.0, radius, QUARTER)?,
            &Solid::Capsule { half_length, radius } => solid::capsule(half_length, radius, QUARTER)?,
            &Solid::Box { half_extent } => solid::cuboid(half_extent)?,
            Solid::Sdf { source, spacing } => {
                let filled = Stuffing::with_cell_size(2.0 * f64::from(*spacing));
                filled.fill(source.distance(folder)?.as_ref())?.0.boundary_mesh()?.0
            }
        })
    }

    fn build(&self, folder: &Path) -> Result<vivace_collision::Obstacle, ObstacleError> {
        for (what, value) in [("rotate", self.rotate), ("at", self.at), ("velocity", self.velocity)] {
            if !value.is_finite() {
                return Err(ObstacleError::NotFinite { what, value });
            }
        }
        let shape = match &self.solid {
            Solid::Plane => Shape::Plane,
            &Solid::Sphere { radius } => Shape::Sphere { radius },
            &Solid::Capsule { half_length, radius } => Shape::Capsule { half_length, radius },
            &Solid::Box { half_extent } => Shape::Cuboid { half_extent },
            Solid::Sdf { source, spacing } => {
                let solid = source.distance(folder)?;
                Shape::Field(Arc::new(Field::new(&&*solid, *spacing, MAX_BYTES)?))
            }
        };
        let [x, y, z] = self.rotate.to_array().map(f32::to_radians);
        let rotation = Quat::from_euler(EulerRot::XYZEx, x, y, z).normalize();
        let pose = Pose { position: self.at, rotation };
        Ok(vivace_collision::Obstacle::fixed(shape, pose, self.friction))
    }
}

/// Why an obstacle is refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ObstacleError {
    /// A place or velocity.
    #[error("{what} is {value}; it must be finite")]
    NotFinite {
        /// What is not finite.
        what: &'static str,
        /// Its value.
        value: Vec3,
    },
    /// Its signed distance function cannot be had.
    #[error(transparent)]
    Source(#[from] BodyError),
    /// It cannot be sampled.
    #[error(transparent)]
    Field(#[from] CollisionError),
    /// It has no surface.
    #[error(transparent)]
    Surface(#[from] MeshError),
}
