//! Several vectors at a time: how the host runs a kernel faster than one by one. A device has lanes of its own.

#![allow(clippy::inline_always, reason = "vectors stay in registers only if it is")]

use std::ops::{Add, Mul, Neg, Sub};

use glam::{Vec3A, Vec4};
use wide::{f32x4, f32x8};

/// Lengths below this are 0 \[m\]; its square is a normal number.
const TINY: f32 = 1e-18;

/// Vectors, coordinate by coordinate: `f32x4` holds four of them, `f32x8` eight.
#[derive(Debug, Clone, Copy)]
pub struct Lanes3<V> {
    /// All x.
    pub x: V,
    /// All y.
    pub y: V,
    /// All z.
    pub z: V,
}

impl<V: Copy + Add<Output = V> + Sub<Output = V> + Mul<Output = V>> Lanes3<V> {
    /// All the same coordinate.
    #[inline(always)]
    #[must_use]
    pub fn splat(v: V) -> Self {
        Self { x: v, y: v, z: v }
    }

    /// Dot products.
    #[inline(always)]
    #[must_use]
    pub fn dot(self, other: Self) -> V {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// Cross products.
    #[inline(always)]
    #[must_use]
    pub fn cross(self, other: Self) -> Self {
        Self {
            x: self.y * other.z - self.z * other.y,
            y: self.z * other.x - self.x * other.z,
            z: self.x * other.y - self.y * other.x,
        }
    }
}

impl Lanes3<f32x8> {
    /// Eight times 0.
    pub const ZERO: Self = Self { x: f32x8::ZERO, y: f32x8::ZERO, z: f32x8::ZERO };

    /// Squared lengths; never 0, so that they may be divided by.
    #[inline(always)]
    #[must_use]
    pub fn squared_length(self) -> f32x8 {
        self.dot(self).fast_max(f32x8::splat(TINY * TINY))
    }

    /// These eight.
    #[inline(always)]
    #[must_use]
    pub fn from_array([a, b, c, d, e, f, g, h]: [Vec3A; 8]) -> Self {
        // Written out: `array::map` may become a call.
        Self {
            x: f32x8::new([a.x, b.x, c.x, d.x, e.x, f.x, g.x, h.x]),
            y: f32x8::new([a.y, b.y, c.y, d.y, e.y, f.y, g.y, h.y]),
            z: f32x8::new([a.z, b.z, c.z, d.z, e.z, f.z, g.z, h.z]),
        }
    }

    /// One by one.
    #[inline(always)]
    #[must_use]
    pub fn to_array(self) -> [Vec3A; 8] {
        let (x, y, z) = (self.x.to_array(), self.y.to_array(), self.z.to_array());
        std::array::from_fn(|lane| Vec3A::new(x[lane], y[lane], z[lane]))
    }
}

impl Lanes3<f32x4> {
    /// Four times 0.
    pub const ZERO: Self = Self { x: f32x4::ZERO, y: f32x4::ZERO, z: f32x4::ZERO };

    /// Lengths; never 0, so that they may be divided by.
    #[inline(always)]
    #[must_use]
    pub fn length(self) -> f32x4 {
        self.dot(self).fast_max(f32x4::splat(TINY * TINY)).sqrt()
    }

    /// These four, and their fourth coordinates.
    #[inline(always)]
    #[must_use]
    pub fn from_vec4s([a, b, c, d]: [Vec4; 4]) -> (Self, f32x4) {
        let of = |v: Vec4| f32x4::new(v.to_array());
        let [x, y, z, w] = f32x4::transpose([of(a), of(b), of(c), of(d)]);
        (Self { x, y, z }, w)
    }

    /// One by one, with a fourth coordinate of 0.
    #[inline(always)]
    #[must_use]
    pub fn to_vec4s(self) -> [Vec4; 4] {
        let [a, b, c, d] = f32x4::transpose([self.x, self.y, self.z, f32x4::ZERO]);
        let of = |v: f32x4| Vec4::from_array(v.to_array());
        [of(a), of(b), of(c), of(d)]
    }
}

impl<V: Add<Output = V>> Add for Lanes3<V> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z }
    }
}

impl<V: Sub<Output = V>> Sub for Lanes3<V> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }
}

impl<V: Copy + Mul<Output = V>> Mul<V> for Lanes3<V> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, scale: V) -> Self {
        Self { x: self.x * scale, y: self.y * scale, z: self.z * scale }
    }
}

impl<V: Neg<Output = V>> Neg for Lanes3<V> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self { x: -self.x, y: -self.y, z: -self.z }
    }
}

/// `value` of each of four.
#[inline(always)]
pub fn each<T>([a, b, c, d]: &[T; 4], value: impl Fn(&T) -> f32) -> f32x4 {
    f32x4::new([value(a), value(b), value(c), value(d)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_gathered_comes_back() {
        let vectors = [0.0, 3.0, -7.0, 1e9].map(|k| Vec4::new(k, 0.5, -k, 7.0));
        let (lanes, fourth) = Lanes3::from_vec4s(vectors);
        assert_eq!(fourth.to_array(), [7.0; 4]);
        assert_eq!(lanes.to_vec4s(), vectors.map(|v| v.truncate().extend(0.0)));
        let eight: [Vec3A; 8] = std::array::from_fn(|k| Vec3A::new(1.0, vectors[k / 2].x, 0.25));
        assert_eq!(Lanes3::from_array(eight).to_array(), eight);
    }
}
