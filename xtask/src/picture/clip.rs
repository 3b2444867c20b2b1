//! Triangles cut to what the camera sees.

#![expect(clippy::cast_possible_truncation, reason = "the picture is filled in f32")]

use glam::{DVec3, Vec3};

/// Nearest and furthest depth that is drawn, in distances between eye and target: both ends keep clear of what `f32` can do.
const NEAR: f64 = 1e-3;
const FAR: f64 = 1e3;

/// The least sine-like measure of a triangle's solid angle that is filled; below, rounding decides on which side it lies.
const THIN: f64 = 4e-6;

/// How far triangles are grown: in slopes from the eye, and as a share of their size.
const GROWTH: f64 = 2e-5;

/// A corner of a triangle as the camera sees it.
#[derive(Clone, Copy)]
pub(super) struct Corner {
    /// Right, up and depth.
    pub(super) at: DVec3,
    /// Unit normal: right, up, towards the eye.
    pub(super) normal: Vec3,
    /// The scalar to be mapped, as a share of its range.
    pub(super) share: f32,
}

impl Corner {
    fn between(&self, other: &Self, way: f64) -> Self {
        Self {
            at: self.at.lerp(other.at, way),
            normal: self.normal.lerp(other.normal, way as f32),
            share: self.share + (other.share - self.share) * way as f32,
        }
    }

    /// Homogeneous coordinates in the picture. The constant third makes the depth −1/distance, which `f32` resolves evenly.
    pub(super) fn homogeneous(&self, scale: (f64, f64)) -> [f32; 4] {
        [(self.at.x * scale.0) as f32, (self.at.y * scale.1) as f32, -1.0, self.at.z as f32]
    }
}

/// The convex piece of a triangle that lies in the picture, by Sutherland and Hodgman; fewer than three corners if none does.
pub(super) fn visible(triangle: [Corner; 3], scale: (f64, f64)) -> Vec<Corner> {
    let planes = [
        (DVec3::Z, NEAR),
        (DVec3::NEG_Z, -FAR),
        (DVec3::new(scale.0, 0.0, 1.0), 0.0),
        (DVec3::new(-scale.0, 0.0, 1.0), 0.0),
        (DVec3::new(0.0, scale.1, 1.0), 0.0),
        (DVec3::new(0.0, -scale.1, 1.0), 0.0),
    ];
    let mut piece = triangle.to_vec();
    for (normal, offset) in planes {
        let inside = |corner: &Corner| normal.dot(corner.at) - offset;
        if piece.iter().all(|corner| inside(corner) >= 0.0) {
            continue;
        }
        let mut cut = Vec::with_capacity(piece.len() + 1);
        for (idx, corner) in piece.iter().enumerate() {
            let next = &piece[(idx + 1) % piece.len()];
            let (here, there) = (inside(corner), inside(next));
            if here >= 0.0 {
                cut.push(*corner);
            }
            if (here >= 0.0) != (there >= 0.0) {
                cut.push(corner.between(next, here / (here - there)));
            }
        }
        piece = cut;
    }
    piece
}

/// A triangle a hundredth of a pixel larger: where two meet, the rasterizer's rounding would else leave pinholes.
pub(super) fn grown(triangle: [Corner; 3]) -> [Corner; 3] {
    let center = triangle.iter().map(|corner| corner.at).sum::<DVec3>() / 3.0;
    triangle.map(|corner| {
        let out = corner.at - center;
        let by = (GROWTH * corner.at.z / out.length().max(f64::MIN_POSITIVE)).min(1.0) + GROWTH;
        Corner { at: corner.at + out * by, ..corner }
    })
}

/// Whether the rasterizer can invert the triangle in `f32`: it panics, in debug, on one that is seen edge-on.
pub(super) fn fillable(triangle: [[f32; 4]; 3]) -> bool {
    let [a, b, c] = triangle.map(|h| DVec3::new(h[0].into(), h[1].into(), h[3].into()));
    // The rasterizer starts from the last corner, or from the first if the triangle turns the other way.
    let stands = |p: DVec3, q: DVec3, r: DVec3| {
        let (rp, rq) = (p - r, q - r);
        let volume = rp.cross(rq).dot(r).abs();
        volume > 1e-20 && volume > THIN * rp.length() * rq.length() * r.length()
    };
    stands(a, b, c) && stands(c, b, a)
}
