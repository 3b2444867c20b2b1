//! Triangle and tetrahedral meshes: read, written, generated, tetrahedralised.
//!
//! Lengths are in metres. Nothing here knows constraints, colours or devices.

pub mod ball;
pub mod beam;
pub mod cloth;
pub mod irregularity;
pub mod obj;
pub mod sdf;
pub mod solid;
pub mod stuffing;
pub mod vtk;

mod error;
mod hex;
mod load;
mod mesh;
mod order;
mod report;
mod size;
mod tet;
mod text;
mod topology;
mod tri;

pub use error::MeshError;
pub use load::{Loaded, Mesh, load};
pub use mesh::{FLAT_QUALITY, MAX_COORDINATE, TetMesh, TriMesh};
pub use report::{DegreeSummary, TetReport, TriReport};
