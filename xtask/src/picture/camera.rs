//! Where a picture is taken from.

use std::borrow::Borrow;

use glam::{DMat3, DVec3, Vec3};

/// Coordinates beyond this \[m\] belong to a simulation that has blown up: they do not move the camera.
const FAR_OUT: f32 = 1e6;

/// Room around what is framed, as a factor of the distance.
const ROOM: f64 = 1.06;

/// A perspective camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Where it stands \[m\].
    pub eye: Vec3,
    /// What it looks at \[m\].
    pub target: Vec3,
    /// What is up in the picture; need be neither a unit vector nor at right angles to the view.
    pub up: Vec3,
    /// Angle of view \[deg\] along the shorter side of the picture.
    pub fov_degrees: f32,
}

impl Camera {
    /// A camera that looks along `direction` (from the eye to the target), y up, and sees the whole bounding box of `positions`.
    ///
    /// Positions that are not finite or lie beyond 10⁶ m do not count. For an animation, frame one state and keep the camera.
    pub fn framing(positions: impl IntoIterator<Item = impl Borrow<Vec3>>, direction: Vec3) -> Self {
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for position in positions {
            let &position = position.borrow();
            if position.is_finite() && position.abs().max_element() <= FAR_OUT {
                (low, high) = (low.min(position), high.max(position));
            }
        }
        if low.x > high.x {
            (low, high) = (Vec3::splat(-0.5), Vec3::splat(0.5));
        }
        let fov_degrees = 30.0;
        let axes = axes(direction.as_dvec3(), DVec3::Y);
        let center = (low.as_dvec3() + high.as_dvec3()) / 2.0;
        let half = (high.as_dvec3() - low.as_dvec3()) / 2.0;
        let slope = half_slope(fov_degrees);
        let mut distance: f64 = 1e-3;
        for corner in 0..8_u8 {
            let sign = |bit: u8| if corner >> bit & 1 == 0 { -1.0 } else { 1.0 };
            let seen = axes.transpose() * (half * DVec3::new(sign(0), sign(1), sign(2)));
            distance = distance.max(seen.x.abs().max(seen.y.abs()) / slope - seen.z);
        }
        let eye = (center - axes.z_axis * distance * ROOM).as_vec3();
        Self { eye, target: center.as_vec3(), up: axes.y_axis.as_vec3(), fov_degrees }
    }

    /// The way from positions to what the camera sees, for a picture of this shape.
    pub(super) fn view(&self, width: u32, height: u32) -> View {
        let eye = self.eye.as_dvec3();
        let forward = self.target.as_dvec3() - eye;
        let distance = forward.length();
        let distance = if distance.is_finite() && distance > 0.0 { distance } else { 1.0 };
        let (width, height) = (f64::from(width.max(1)), f64::from(height.max(1)));
        let shorter = width.min(height) / half_slope(self.fov_degrees);
        View {
            eye,
            axes: axes(forward, self.up.as_dvec3()),
            distance,
            scale: (shorter / width, shorter / height),
        }
    }
}

/// A camera's frame, ready for many positions.
pub(super) struct View {
    pub(super) eye: DVec3,
    /// Right, up and forward.
    pub(super) axes: DMat3,
    distance: f64,
    /// From slopes to the picture, which reaches from −1 to 1 both ways.
    pub(super) scale: (f64, f64),
}

impl View {
    /// Right, up and depth of a position, in distances between eye and target.
    pub(super) fn see(&self, position: Vec3) -> DVec3 {
        self.axes.transpose() * (position.as_dvec3() - self.eye) / self.distance
    }

    /// A direction as right, up and towards the eye.
    pub(super) fn turn(&self, direction: DVec3) -> Vec3 {
        (self.axes.transpose() * direction * DVec3::new(1.0, 1.0, -1.0)).as_vec3()
    }
}

/// Tangent of half the angle of view; an angle that makes no picture is replaced by the nearest that does.
fn half_slope(fov_degrees: f32) -> f64 {
    let degrees = if fov_degrees.is_nan() { 30.0 } else { f64::from(fov_degrees).clamp(0.1, 170.0) };
    (degrees.to_radians() / 2.0).tan()
}

/// Right, up and forward; where the directions do not say, the camera looks down −z, and keeps upright.
fn axes(forward: DVec3, up: DVec3) -> DMat3 {
    let forward = forward.try_normalize().unwrap_or(DVec3::NEG_Z);
    let across = |up: DVec3| {
        let up = up.try_normalize()?;
        let right = forward.cross(up);
        (right.length() > 1e-6).then(|| right.normalize())
    };
    let right = across(up).or_else(|| across(DVec3::Y)).or_else(|| across(DVec3::NEG_Z));
    let right = right.unwrap_or(DVec3::X);
    DMat3::from_cols(right, right.cross(forward), forward)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn framing_shows_every_corner_and_fills_the_picture() {
        let corners: Vec<Vec3> = (0..8_u8)
            .map(|k| Vec3::new(f32::from(k & 1) * 4.0, f32::from(k >> 1 & 1), f32::from(k >> 2) * 2.0))
            .collect();
        for direction in [Vec3::NEG_Z, Vec3::NEG_Y, Vec3::new(-1.0, -1.0, -2.0), Vec3::ZERO, Vec3::NAN] {
            let mut positions = corners.clone();
            positions.extend([Vec3::NAN, Vec3::INFINITY, Vec3::splat(1e30)]);
            let view = Camera::framing(&positions, direction).view(300, 200);
            let mut furthest: f64 = 0.0;
            for &corner in &corners {
                let seen = view.see(corner);
                let (x, y) = (seen.x / seen.z * view.scale.0 * 1.5, seen.y / seen.z * view.scale.1);
                furthest = furthest.max(x.abs()).max(y.abs());
            }
            assert!(furthest > 0.85 && furthest < 1.0, "{direction}: {furthest}");
        }
    }

    #[test]
    fn odd_cameras_still_have_a_frame() {
        let good = Camera::framing([Vec3::ZERO], Vec3::NEG_Z);
        let odd = [
            Camera { target: good.eye, ..good },
            Camera { up: Vec3::Z, ..good },
            Camera { up: Vec3::NAN, fov_degrees: f32::NAN, ..good },
            Camera { target: Vec3::splat(f32::INFINITY), fov_degrees: 400.0, ..good },
            Camera::framing(std::iter::empty::<Vec3>(), Vec3::NEG_Y),
        ];
        for camera in odd {
            let view = camera.view(0, 10);
            assert!((view.axes.determinant().abs() - 1.0).abs() < 1e-9, "{camera:?}");
            assert!(view.see(Vec3::ONE).is_finite(), "{camera:?}");
        }
    }
}
