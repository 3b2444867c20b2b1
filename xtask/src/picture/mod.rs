//! Pictures of simulated cloths and volumes without a GPU: meshes and a camera in, PNG and animated PNG out.
//!
//! The triangles are filled by the software rasterizer `euc`; clipping, normals and light are here. A simulation that
//! has blown up is still drawn: positions that are not finite are left out, those far away are clipped.
//! [`report::PictureGrid`](crate::report::PictureGrid) sets the pictures side by side.

mod camera;
mod clip;
mod color;
mod image;
mod normals;
mod render;
mod stage;
#[cfg(test)]
mod tests;

pub use camera::Camera;
pub use color::color_map;
pub use image::{Image, animation};
pub use render::{BACKGROUND, Mesh3, Paint, Picture};
pub use stage::{Moment, Stage};
