//! From meshes to pixels: camera, clipping, light, and four samples a pixel.

use euc::buffer::Buffer2d;
use euc::rasterizer::{BackfaceCullingDisabled, Triangles};
use glam::{DVec3, Vec3};

use super::camera::{Camera, View};
use super::clip::{self, Corner};
use super::color::{color_of, light_of, map_light};
use super::image::Image;
use super::normals;

/// The color behind everything, sRGB.
pub const BACKGROUND: [u8; 3] = [236, 238, 241];

/// Samples along each side of a pixel.
const SAMPLES: usize = 2;

/// Direction to the light and its strength, relative to the camera: right, up, towards the eye.
const KEY: (Vec3, f32) = (Vec3::new(-0.48, 0.68, 0.55), 0.78);
const FILL: (Vec3, f32) = (Vec3::new(0.85, 0.1, 0.5), 0.2);
const AMBIENT: f32 = 0.16;
const SHINE: f32 = 0.09;

/// What the back of a surface reflects of its color, and what is added to it.
const BACK: (f32, Vec3) = (0.5, Vec3::new(0.02, 0.025, 0.035));

/// How a mesh is colored.
#[derive(Clone, Copy, Debug)]
pub enum Paint<'a> {
    /// One color, sRGB.
    Plain([u8; 3]),
    /// A scalar at each vertex through [`color_map`](super::color_map).
    Scalar {
        /// One value for each vertex; gray where it is missing or NaN.
        values: &'a [f32],
        /// The value at the dark end of the map.
        low: f32,
        /// The value at the light end of the map.
        high: f32,
    },
}

impl Paint<'_> {
    /// The scalar of a vertex as a share of its range, 0 for a plain mesh.
    fn share(&self, vertex: u32) -> f32 {
        match *self {
            Self::Plain(_) => 0.0,
            Self::Scalar { values, low, high } => {
                let value = values.get(vertex as usize).copied().unwrap_or(f32::NAN);
                let share = if high > low { (value - low) / (high - low) } else { 0.5 + 0.0 * value };
                if share.is_nan() { f32::NAN } else { share.clamp(0.0, 1.0) }
            }
        }
    }
}

/// Triangles to be drawn, seen from both sides; the front is where they run counter-clockwise.
#[derive(Clone, Copy, Debug)]
pub struct Mesh3<'a> {
    /// Positions \[m\]; triangles at one that is not finite are left out.
    pub positions: &'a [Vec3],
    /// Vertices of each triangle.
    pub triangles: &'a [[u32; 3]],
    /// How it is colored.
    pub colors: Paint<'a>,
}

/// The renderer.
#[derive(Clone, Copy, Debug)]
pub struct Picture;

impl Picture {
    /// Draws the meshes, lit from above the camera's left shoulder, on light gray.
    pub fn render(meshes: &[Mesh3], camera: &Camera, width: u32, height: u32) -> Image {
        let (columns, rows) = (width as usize, height as usize);
        let size = [columns * SAMPLES, rows * SAMPLES];
        let mut samples = Buffer2d::new(size, light_of(BACKGROUND));
        let mut depth = Buffer2d::new(size, 0.0);
        let view = camera.view(width, height);
        for mesh in meshes {
            let vertices = seen(mesh, &view);
            let plain = match mesh.colors {
                Paint::Plain(color) => Some(light_of(color)),
                Paint::Scalar { .. } => None,
            };
            euc::Pipeline::draw::<Triangles<_, BackfaceCullingDisabled>, _>(
                &Shader { plain },
                &vertices,
                &mut samples,
                Some(&mut depth),
            );
        }
        let samples: &[Vec3] = samples.as_ref();
        let mut pixels = Vec::with_capacity(columns * rows * 3);
        for row in 0..rows {
            for column in 0..columns {
                let mut sum = Vec3::ZERO;
                for sample in 0..SAMPLES * SAMPLES {
                    let (x, y) = (column * SAMPLES + sample % SAMPLES, row * SAMPLES + sample / SAMPLES);
                    sum += samples[y * size[0] + x];
                }
                pixels.extend(color_of(sum / (SAMPLES * SAMPLES) as f32));
            }
        }
        Image { width, height, pixels }
    }
}

/// A vertex as the rasterizer takes it.
struct Vertex {
    at: [f32; 4],
    normal: Vec3,
    share: f32,
    /// 0 on the front, 1 on the back.
    back: f32,
}

/// Three vertices for each triangle that is left after clipping.
fn seen(mesh: &Mesh3, view: &View) -> Vec<Vertex> {
    let normals = normals::smooth(mesh.positions, mesh.triangles);
    let mut vertices = Vec::with_capacity(3 * mesh.triangles.len());
    for (&triangle, &normals) in mesh.triangles.iter().zip(&normals) {
        let Some(at) = normals::corners(mesh.positions, triangle) else { continue };
        let at = at.map(|position| view.see(position));
        let is_back = turns_away(at);
        let corner = |k: usize| Corner {
            at: at[k],
            normal: view.turn(if is_back { -normals[k] } else { normals[k] }),
            share: mesh.colors.share(triangle[k]),
        };
        let piece = clip::visible([corner(0), corner(1), corner(2)], view.scale);
        for k in 2..piece.len() {
            let fan = clip::grown([piece[0], piece[k - 1], piece[k]]);
            let places = fan.map(|corner| corner.homogeneous(view.scale));
            if clip::fillable(places) {
                let back = if is_back { 1.0 } else { 0.0 };
                vertices.extend(fan.iter().zip(places).map(|(corner, at)| Vertex {
                    at,
                    normal: corner.normal,
                    share: corner.share,
                    back,
                }));
            }
        }
    }
    vertices
}

/// Whether a triangle shows its back; right, up and depth are left-handed, hence the sign.
fn turns_away([a, b, c]: [DVec3; 3]) -> bool {
    (b - a).cross(c - a).dot(a) < 0.0
}

struct Shader {
    /// The light that the mesh reflects, unless it follows from the scalar.
    plain: Option<Vec3>,
}

impl euc::Pipeline for Shader {
    type Vertex = Vertex;
    /// The normal; share and back.
    type VsOut = ((f32, f32, f32), (f32, f32));
    type Pixel = Vec3;

    fn vert(&self, vertex: &Vertex) -> ([f32; 4], Self::VsOut) {
        (vertex.at, (vertex.normal.into(), (vertex.share, vertex.back)))
    }

    fn frag(&self, &(normal, (share, back)): &Self::VsOut) -> Vec3 {
        let front = self.plain.unwrap_or_else(|| map_light(share));
        let surface = front.lerp(front * BACK.0 + BACK.1, back);
        let normal = Vec3::from(normal).normalize_or(Vec3::Z);
        // Light that reaches a little around the edge: cloth is not black in its shadow.
        let lit = |(from, strength): (Vec3, f32)| {
            strength * ((normal.dot(from.normalize()) + 0.25) / 1.25).max(0.0)
        };
        let sky = AMBIENT * (1.0 + 0.35 * normal.y);
        let half = (KEY.0.normalize() + Vec3::Z).normalize();
        let shine = SHINE * normal.dot(half).max(0.0).powi(32) * (1.0 - back);
        surface * (sky + lit(KEY) + lit(FILL)) + shine
    }
}
