//! Where a body's mesh comes from.

use std::path::{Path, PathBuf};

use glam::Vec3;
use serde::{Deserialize, Serialize};
use vivace_mesh::irregularity::Irregularity;
use vivace_mesh::sdf::{ARMCHAIR, Blend, ClosedSurface, DILLO, HARE, SignedDistance};
use vivace_mesh::stuffing::Stuffing;
use vivace_mesh::{Mesh, MeshError, TetMesh, TriMesh, ball, beam, cloth, load};

use crate::BodyError;

/// A body's mesh, before it is scaled, turned and moved.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Shape {
    /// A rectangle in the xz plane, its first vertex in the origin.
    Cloth {
        /// Vertices along x.
        width: usize,
        /// Vertices along z.
        height: usize,
        /// Between neighbors \[m\].
        spacing: f32,
        /// How it is cut into triangles.
        #[serde(default)]
        pattern: Pattern,
    },
    /// A box of cubes, six tetrahedra each, its lowest corner in the origin.
    Beam {
        /// Cubes along x, y and z.
        cells: [usize; 3],
        /// Edge of a cube \[m\].
        spacing: f32,
    },
    /// A ball of tetrahedra about the origin.
    Ball {
        /// Cells along the core; about 4.4 n³ vertices.
        n: usize,
        /// Radius \[m\].
        radius: f32,
    },
    /// The inside of a signed distance function, filled with tetrahedra.
    Sdf {
        /// The function.
        source: Source,
        /// About so many vertices.
        vertices: usize,
        /// Makes the mesh irregular, as scanned models are; left out, it stays regular inside.
        #[serde(default)]
        irregular: Option<u64>,
    },
    /// An .obj (triangles) or .vtk (tetrahedra) file; the path is relative to the scene's folder.
    Mesh(PathBuf),
}

/// How a cloth is cut into triangles.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Pattern {
    /// The same diagonal in every square.
    #[default]
    Regular,
    /// Diagonals that alternate.
    Alternating,
    /// A jittered grid, Delaunay-triangulated.
    Irregular {
        /// 0 to 0.45 spacings.
        jitter: f32,
        /// One seed gives one mesh.
        seed: u64,
    },
}

/// A signed distance function.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Source {
    /// The armored animal that stands in for the armadillo.
    Dillo,
    /// The hare that stands in for the bunny.
    Hare,
    /// An armchair of 1.09 m that faces +z and stands on y = 0.
    Armchair,
    /// Lines `blend`, `cone`, `ellip` and `box`, see [`vivace_mesh::sdf::Blend`].
    Text(String),
    /// A file of such lines, a closed surface as .obj, or a volume as .vtk whose boundary is one; the path is relative to the
    /// scene's folder.
    Path(PathBuf),
}

impl Shape {
    /// Its name in a scene file.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Cloth { .. } => "Cloth",
            Self::Beam { .. } => "Beam",
            Self::Ball { .. } => "Ball",
            Self::Sdf { .. } => "Sdf",
            Self::Mesh(_) => "Mesh",
        }
    }

    /// Its mesh; files are looked for in `folder`.
    ///
    /// # Errors
    /// Sizes that have no mesh; files that cannot be read.
    pub fn mesh(&self, folder: &Path) -> Result<Mesh, BodyError> {
        Ok(match self {
            &Self::Cloth { width, height, spacing, pattern } => Mesh::Tri(match pattern {
                Pattern::Regular => cloth::regular(width, height, spacing)?,
                Pattern::Alternating => cloth::alternating(width, height, spacing)?,
                Pattern::Irregular { jitter, seed } => {
                    cloth::irregular(width, height, spacing, jitter, seed)?
                }
            }),
            &Self::Beam { cells, spacing } => Mesh::Tet(beam::regular(cells, spacing)?),
            &Self::Ball { n, radius } => Mesh::Tet(ball::layered(n, radius)?),
            Self::Sdf { source, vertices, irregular } => {
                let mut stuffing = Stuffing::with_about_vertices(*vertices);
                if let Some(seed) = *irregular {
                    stuffing = stuffing.with_irregularity(Irregularity { seed, ..Irregularity::default() });
                }
                Mesh::Tet(stuffing.fill(source.distance(folder)?.as_ref())?.0)
            }
            Self::Mesh(path) => load(folder.join(path))?.mesh,
        })
    }
}

impl Source {
    /// The function; files are looked for in `folder`.
    ///
    /// # Errors
    /// A text or a file that is none.
    pub fn distance(&self, folder: &Path) -> Result<Box<dyn SignedDistance + Sync>, BodyError> {
        let blend = |text: &str| Ok(Box::new(text.parse::<Blend>()?) as Box<dyn SignedDistance + Sync>);
        match self {
            Self::Dillo => blend(DILLO),
            Self::Hare => blend(HARE),
            Self::Armchair => blend(ARMCHAIR),
            Self::Text(text) => blend(text),
            Self::Path(path) => {
                let path = folder.join(path);
                let has = |wanted| path.extension().is_some_and(|found| found.eq_ignore_ascii_case(wanted));
                if has("obj") || has("vtk") {
                    let surface = match load(&path)?.mesh {
                        Mesh::Tet(mesh) => mesh.boundary_mesh()?.0,
                        Mesh::Tri(mesh) => mesh,
                        _ => return Err(MeshError::Empty { what: "triangles" }.into()),
                    };
                    return Ok(Box::new(ClosedSurface::new(&surface)?));
                }
                match std::fs::read_to_string(&path) {
                    Ok(text) => blend(&text),
                    Err(error) => Err(BodyError::Read { path, reason: error.to_string() }),
                }
            }
        }
    }
}

/// The mesh with every vertex moved.
pub(crate) fn moved(mesh: &Mesh, place: impl Fn(Vec3) -> Vec3) -> Result<Mesh, BodyError> {
    let positions = |all: &[Vec3]| all.iter().map(|&p| place(p)).collect::<Vec<_>>();
    Ok(match mesh {
        Mesh::Tri(mesh) => Mesh::Tri(TriMesh::new(positions(mesh.positions()), mesh.triangles().to_vec())?),
        Mesh::Tet(mesh) => Mesh::Tet(TetMesh::new(positions(mesh.positions()), mesh.tets().to_vec())?),
        _ => mesh.clone(),
    })
}
