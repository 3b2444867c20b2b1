//! Solids that particles stay out of. What `vivace-collision`'s obstacles are, as a device reads them.

use bytemuck::{Pod, Zeroable};
use glam::{UVec3, Vec3, Vec4};

/// The same in WGSL.
pub(super) const WGSL: &str = include_str!("solid.wgsl");

/// What a solid is, in its own coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum SolidShape {
    /// The half space y ≤ 0.
    Plane = 0,
    /// A ball around the origin: `size.x` is the radius \[m\].
    Sphere = 1,
    /// All that is within `size.x` of the y axis from −`size.y` to `size.y` \[m\].
    Capsule = 2,
    /// A box around the origin: `size` is half of its edge lengths \[m\].
    Cuboid = 3,
    /// Sampled distances, see [`Solid::nodes`].
    Field = 4,
}

/// A solid, and how near particles may come: the parameters of [`MeetSolid`](super::MeetSolid) and [`KeepOut`](super::KeepOut).
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Solid {
    /// How it is turned at the start of the frame and at its end: quaternions of length 1.
    pub rotations: [Vec4; 2],
    /// Where its origin lies at the start of the frame \[m\].
    pub from: Vec3,
    /// A [`SolidShape`].
    pub shape: u32,
    /// Where its origin lies at the end of the frame \[m\].
    pub to: Vec3,
    /// Coulomb's coefficient \[1\].
    pub friction: f32,
    /// See [`SolidShape`] \[m\].
    pub size: Vec3,
    /// What the distance may change per metre, at most.
    pub slope: f32,
    /// The first node of a field \[m\].
    pub min: Vec3,
    /// The distance of its nodes along each axis \[m\].
    pub spacing: f32,
    /// How many there are along each axis; x comes first.
    pub nodes: UVec3,
    /// Whether a particle is put beside the surface; else it stops on its way.
    pub slides: u32,
    /// The distance that particles keep \[m\].
    pub distance: f32,
    /// By how much more they may be apart and still have a contact \[m\].
    pub margin: f32,
    /// Fills up what WGSL aligns.
    pub padding: [u32; 2],
}

/// Cosine between the directions at the way's end and where it meets the solid, above which the end decides.
pub(super) const SAME_SIDE: f32 = 0.5;
const MAX_STEPS: u32 = 256;

/// The surface as seen from a point: the distance \[m\], negative inside, never more than it is; and the direction out of the solid.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seen {
    pub(super) distance: f32,
    pub(super) normal: Vec3,
}

fn direction(v: Vec3, otherwise: Vec3) -> Vec3 {
    let length = v.length();
    if length > 0.0 { v / length } else { otherwise }
}

fn rotate(rotation: Vec4, v: Vec3) -> Vec3 {
    let axis = rotation.truncate();
    let across = axis.cross(v);
    v + 2.0 * (rotation.w * across + axis.cross(across))
}

fn mix(a: f32, b: f32, t: f32) -> f32 {
    a + t * (b - a)
}

impl Solid {
    pub(super) fn way(&self, from: Vec3, to: Vec3) -> [Vec3; 2] {
        let back = |rotation: Vec4| Vec4::new(-rotation.x, -rotation.y, -rotation.z, rotation.w);
        [rotate(back(self.rotations[0]), from - self.from), rotate(back(self.rotations[1]), to - self.to)]
    }

    /// A point of the solid at the start of the frame.
    pub(super) fn begun(&self, point: Vec3) -> Vec3 {
        rotate(self.rotations[0], point) + self.from
    }

    /// A point of the solid at the end of the frame.
    pub(super) fn ended(&self, point: Vec3) -> Vec3 {
        self.turned(point) + self.to
    }

    pub(super) fn turned(&self, direction: Vec3) -> Vec3 {
        rotate(self.rotations[1], direction)
    }

    pub(super) fn is_still(&self) -> bool {
        self.from == self.to && self.rotations[0] == self.rotations[1]
    }

    /// The surface as seen from `point`, in the solid's own coordinates.
    pub(super) fn seen_from(&self, values: &[f32], point: Vec3) -> Seen {
        let around =
            |core: Vec3| Seen { distance: core.length() - self.size.x, normal: direction(core, Vec3::Y) };
        match self.shape {
            0 => Seen { distance: point.y, normal: Vec3::Y },
            1 => around(point),
            2 => around(point - Vec3::Y * point.y.clamp(-self.size.y, self.size.y)),
            3 => self.cuboid(point),
            _ => self.field(values, point),
        }
    }

    fn cuboid(&self, point: Vec3) -> Seen {
        let beyond = point.abs() - self.size;
        let sign = Vec3::select(point.cmplt(Vec3::ZERO), Vec3::NEG_ONE, Vec3::ONE);
        let outside = beyond.max(Vec3::ZERO);
        if outside != Vec3::ZERO {
            return Seen { distance: outside.length(), normal: direction(sign * outside, Vec3::Y) };
        }
        if beyond.x >= beyond.y && beyond.x >= beyond.z {
            return Seen { distance: beyond.x, normal: Vec3::X * sign.x };
        }
        if beyond.y >= beyond.z {
            return Seen { distance: beyond.y, normal: Vec3::Y * sign.y };
        }
        Seen { distance: beyond.z, normal: Vec3::Z * sign.z }
    }

    fn field(&self, values: &[f32], point: Vec3) -> Seen {
        let last = (self.nodes - 1).as_vec3();
        let at = (point - self.min) / self.spacing;
        let clamped = at.max(Vec3::ZERO).min(last);
        let cell = clamped.floor().min(last - 1.0);
        let f = clamped - cell;
        let c = cell.as_uvec3();
        let first = (c.z * self.nodes.y + c.y) * self.nodes.x + c.x;
        let (y, z) = (self.nodes.x, self.nodes.x * self.nodes.y);
        let v = [0, 1, y, y + 1, z, z + 1, z + y, z + y + 1].map(|k| values[(first + k) as usize]);
        let x = [0, 2, 4, 6].map(|k| mix(v[k], v[k + 1], f.x));
        let (low, high) = (mix(x[0], x[1], f.y), mix(x[2], x[3], f.y));
        let value = mix(low, high, f.z);
        let d = [0, 2, 4, 6].map(|k| v[k + 1] - v[k]);
        let gradient = Vec3::new(
            mix(mix(d[0], d[1], f.y), mix(d[2], d[3], f.y), f.z),
            mix(x[1] - x[0], x[3] - x[2], f.z),
            high - low,
        );
        let normal = direction(gradient, Vec3::Y);
        let beyond = self.spacing * (at - clamped);
        let away = beyond.length();
        if away == 0.0 {
            return Seen { distance: value, normal };
        }
        Seen { distance: away.max(value - away), normal: direction(value * normal + beyond, normal) }
    }

    /// Where on the segment from `a` to `b`, from part `from` of it on, the distance is first `level` \[m\] or less; `None` if nowhere
    /// (Hart 1996).
    pub(super) fn first_within(
        &self,
        values: &[f32],
        [a, b]: [Vec3; 2],
        level: f32,
        from: f32,
    ) -> Option<f32> {
        let speed = (b - a).length() * self.slope;
        let mut part = from;
        for _ in 0..MAX_STEPS {
            let left = self.seen_from(values, a + part * (b - a)).distance - level;
            if left <= 0.0 {
                return Some(part);
            }
            let to_go = (1.0 - part) * speed;
            if left >= to_go {
                return None;
            }
            let step = left.max(0.1 * level);
            if step >= to_go {
                return (self.seen_from(values, b).distance <= level).then_some(1.0);
            }
            part += step / speed;
        }
        Some(part)
    }
}
