//! What a body is made of.

use std::fmt;

use serde::{Deserialize, Serialize};
use vivace_mesh::{Mesh, TetMesh, TriMesh};
use vivace_model::{ModelBuilder, TearLimit};

use crate::BodyError;

/// Masses and constraints of a body. `None` leaves a kind of constraint out.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Material {
    /// For triangles.
    Cloth {
        /// \[kg/m²\], 0.2 if left out.
        #[serde(default = "cloth_density")]
        density: f32,
        /// Stiffness of a spring on each edge \[N/m\], 100 if left out.
        #[serde(default = "cloth_springs")]
        springs: Option<f32>,
        /// Resistance to bending; flat hinges of 10⁻⁵ J if left out.
        #[serde(default = "cloth_bending")]
        bending: Option<Bending>,
        /// A limit on the strain of each triangle; none if left out.
        #[serde(default)]
        strain: Option<ClothStrain>,
        /// When springs break and the cloth tears; never if left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        tear: Option<TearLimit>,
    },
    /// For tetrahedra.
    Volume {
        /// \[kg/m³\], 1000 if left out.
        #[serde(default = "volume_density")]
        density: f32,
        /// Stiffness against changes of shape \[Pa\], 10⁵ if left out.
        #[serde(default = "volume_strain")]
        strain: Option<f32>,
        /// Stiffness against changes of volume; none if left out.
        #[serde(default)]
        volume: Option<VolumeStiffness>,
        /// Stiffness of a spring on each edge \[N/m\]; none if left out.
        #[serde(default)]
        springs: Option<f32>,
    },
}

/// A hinge on each inner edge.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bending {
    /// \[J\].
    pub stiffness: f32,
    /// At rest as the shape is, not flat.
    #[serde(default)]
    pub curved: bool,
}

/// A limit on the strain of each triangle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClothStrain {
    /// \[N/m\].
    pub stiffness: f32,
    /// No force within ± this strain \[1\], at least 0 and below 1.
    pub limit: f32,
}

/// Stiffness against changes of volume.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VolumeStiffness {
    /// \[Pa\].
    pub stiffness: f32,
    /// Least and greatest volume without a force, over that at rest \[1\]; exactly the rest volume if left out.
    #[serde(default = "rest_volume")]
    pub range: [f32; 2],
}

impl fmt::Display for Material {
    /// In one line, with units.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let springs = match *self {
            Self::Cloth { density, springs, bending, strain, tear } => {
                write!(f, "{density} kg/m\u{b2}")?;
                if let Some(Bending { stiffness, curved }) = bending {
                    write!(f, ", {} hinges of {stiffness:?} J", if curved { "curved" } else { "flat" })?;
                }
                if let Some(ClothStrain { stiffness, limit }) = strain {
                    write!(f, ", {stiffness} N/m beyond a strain of {limit}")?;
                }
                if let Some(TearLimit { strain, .. }) = tear {
                    write!(f, ", tearing above a strain of {strain}")?;
                }
                springs
            }
            Self::Volume { density, strain, volume, springs } => {
                write!(f, "{density} kg/m\u{b3}")?;
                if let Some(stiffness) = strain {
                    write!(f, ", {stiffness} Pa against changes of shape")?;
                }
                if let Some(VolumeStiffness { stiffness, range: [least, most] }) = volume {
                    write!(f, ", {stiffness} Pa against volumes outside {least} to {most}")?;
                }
                springs
            }
        };
        springs.map_or(Ok(()), |stiffness| write!(f, ", springs of {stiffness} N/m"))
    }
}

fn cloth_density() -> f32 {
    0.2
}

fn cloth_springs() -> Option<f32> {
    Some(100.0)
}

fn cloth_bending() -> Option<Bending> {
    Some(Bending { stiffness: 1e-5, curved: false })
}

fn volume_density() -> f32 {
    1000.0
}

fn volume_strain() -> Option<f32> {
    Some(1e5)
}

fn rest_volume() -> [f32; 2] {
    [1.0, 1.0]
}

impl Material {
    /// Cotton-like cloth: what a scene file gets that says `Cloth()`.
    #[must_use]
    pub fn cloth() -> Self {
        Self::Cloth {
            density: cloth_density(),
            springs: cloth_springs(),
            bending: cloth_bending(),
            strain: None,
            tear: None,
        }
    }

    /// Rubber-like volume: what a scene file gets that says `Volume()`.
    #[must_use]
    pub fn volume() -> Self {
        Self::Volume { density: volume_density(), strain: volume_strain(), volume: None, springs: None }
    }

    /// Adds the mesh with masses and constraints; returns its first particle.
    pub(crate) fn add(&self, builder: &mut ModelBuilder, mesh: &Mesh) -> Result<u32, BodyError> {
        match (self, mesh) {
            (&Self::Cloth { density, springs, bending, strain, tear }, Mesh::Tri(mesh)) => {
                let (before, first) =
                    (builder.n_springs(), add_cloth(builder, mesh, density, springs, bending, strain)?);
                match tear {
                    Some(_) if springs.is_none() => return Err(BodyError::NoSprings),
                    Some(limit) => builder.let_tear(before..builder.n_springs(), &limit)?,
                    None => {}
                }
                Ok(first)
            }
            (&Self::Volume { density, strain, volume, springs }, Mesh::Tet(mesh)) => {
                add_volume(builder, mesh, density, strain, volume, springs)
            }
            (Self::Cloth { .. }, _) => {
                Err(BodyError::Material { shape: "volume", material: "cloth", remedy: "Volume()" })
            }
            (Self::Volume { .. }, _) => {
                Err(BodyError::Material { shape: "cloth", material: "volume", remedy: "Cloth()" })
            }
        }
    }
}

fn add_cloth(
    builder: &mut ModelBuilder,
    mesh: &TriMesh,
    density: f32,
    springs: Option<f32>,
    bending: Option<Bending>,
    strain: Option<ClothStrain>,
) -> Result<u32, BodyError> {
    let first = builder.cloth(mesh, density)?;
    if let Some(stiffness) = springs {
        builder.springs(first, &mesh.edges(), stiffness)?;
    }
    if let Some(Bending { stiffness, curved }) = bending {
        builder.hinges(first, &mesh.hinges(), stiffness, curved)?;
    }
    if let Some(ClothStrain { stiffness, limit }) = strain {
        builder.triangle_strain(first, mesh.triangles(), stiffness, limit)?;
    }
    Ok(first)
}

fn add_volume(
    builder: &mut ModelBuilder,
    mesh: &TetMesh,
    density: f32,
    strain: Option<f32>,
    volume: Option<VolumeStiffness>,
    springs: Option<f32>,
) -> Result<u32, BodyError> {
    let first = builder.volume(mesh, density)?;
    if let Some(stiffness) = springs {
        builder.springs(first, &mesh.edges(), stiffness)?;
    }
    if let Some(stiffness) = strain {
        builder.tet_strain(first, mesh.tets(), stiffness)?;
    }
    if let Some(VolumeStiffness { stiffness, range }) = volume {
        builder.tet_volume(first, mesh.tets(), stiffness, range)?;
    }
    Ok(first)
}
