//! Triangle and tetrahedral meshes: read, written, generated, tetrahedralised.
//!
//! Lengths are in metres. Nothing here knows constraints, colours or devices.

mod error;
mod mesh;

pub use error::MeshError;
pub use mesh::{TetMesh, TriMesh};
