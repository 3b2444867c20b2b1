//! Positions, coordinate by coordinate, so that eight of them are three loads.

#![allow(clippy::inline_always, reason = "eight lanes stay in registers only if it is")]

use std::ops::{Add, Mul, Range, Sub};

use glam::Vec3A;
use wide::f32x8;

use crate::parallel::Split;

/// Particles that are computed together.
pub(crate) const LANES: usize = 8;

/// Eight vectors.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lanes3 {
    pub(crate) x: f32x8,
    pub(crate) y: f32x8,
    pub(crate) z: f32x8,
}

impl Lanes3 {
    pub(crate) const ZERO: Self = Self { x: f32x8::ZERO, y: f32x8::ZERO, z: f32x8::ZERO };

    #[inline(always)]
    pub(crate) fn from_array(vectors: [Vec3A; LANES]) -> Self {
        Self {
            x: f32x8::new(vectors.map(|v| v.x)),
            y: f32x8::new(vectors.map(|v| v.y)),
            z: f32x8::new(vectors.map(|v| v.z)),
        }
    }

    #[inline(always)]
    pub(crate) fn to_array(self) -> [Vec3A; LANES] {
        let (x, y, z) = (self.x.to_array(), self.y.to_array(), self.z.to_array());
        std::array::from_fn(|lane| Vec3A::new(x[lane], y[lane], z[lane]))
    }

    #[inline(always)]
    pub(crate) fn dot(self, other: Self) -> f32x8 {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    #[inline(always)]
    pub(crate) fn cross(self, other: Self) -> Self {
        Self {
            x: self.y * other.z - self.z * other.y,
            y: self.z * other.x - self.x * other.z,
            z: self.x * other.y - self.y * other.x,
        }
    }
}

impl Add for Lanes3 {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z }
    }
}

impl Sub for Lanes3 {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }
}

impl Mul<f32x8> for Lanes3 {
    type Output = Self;

    #[inline(always)]
    fn mul(self, scale: f32x8) -> Self {
        Self { x: self.x * scale, y: self.y * scale, z: self.z * scale }
    }
}

/// Eight elements from `at`; 0 where there are not as many.
#[inline(always)]
pub(crate) fn load(values: &[f32], at: usize) -> f32x8 {
    let values = &values[at..];
    values.first_chunk().map_or_else(|| f32x8::new(padded(values)), |chunk| f32x8::new(*chunk))
}

#[cold]
fn padded(values: &[f32]) -> [f32; LANES] {
    let mut chunk = [0.0; LANES];
    chunk[..values.len()].copy_from_slice(values);
    chunk
}

/// Vectors in one array: all x, then all y, then all z, each with room for eight more at its end.
#[derive(Debug, Clone, Default)]
pub(crate) struct Points {
    stride: usize,
    data: Vec<f32>,
}

impl Points {
    /// `n` vectors, all 0.
    pub(crate) fn zeros(n: usize) -> Self {
        let stride = n + LANES;
        Self { stride, data: vec![0.0; 3 * stride] }
    }

    /// How many may be read: eight more than there are.
    #[inline(always)]
    pub(crate) fn stride(&self) -> usize {
        self.stride
    }

    /// All numbers.
    pub(crate) fn data(&self) -> &[f32] {
        &self.data
    }

    /// All numbers.
    pub(crate) fn data_mut(&mut self) -> &mut [f32] {
        &mut self.data
    }

    /// All x, all y, all z.
    #[inline(always)]
    pub(crate) fn axes(&self) -> [&[f32]; 3] {
        let n = self.stride;
        [&self.data[..n], &self.data[n..][..n], &self.data[2 * n..][..n]]
    }

    #[inline(always)]
    pub(crate) fn get(&self, i: usize) -> Vec3A {
        let [x, y, z] = self.axes();
        Vec3A::new(x[i], y[i], z[i])
    }

    #[inline(always)]
    pub(crate) fn set(&mut self, i: usize, value: Vec3A) {
        let n = self.stride;
        [self.data[i], self.data[n + i], self.data[2 * n + i]] = value.to_array();
    }

    /// Vectors `at..at + 8`.
    #[inline(always)]
    pub(crate) fn lanes(&self, at: usize) -> Lanes3 {
        let [x, y, z] = self.axes();
        Lanes3 { x: load(x, at), y: load(y, at), z: load(z, at) }
    }

    /// Vectors anywhere.
    #[inline(always)]
    pub(crate) fn gather(&self, at: &[u32; LANES]) -> Lanes3 {
        let [x, y, z] = self.axes();
        let of = |axis: &[f32]| f32x8::new(at.map(|i| axis[i as usize]));
        Lanes3 { x: of(x), y: of(y), z: of(z) }
    }

    /// Sets vectors `at..at + n`, `n` at most 8.
    #[inline(always)]
    pub(crate) fn store(&mut self, at: usize, n: usize, values: Lanes3) {
        self.range_mut(at..at + n).store(0, n, values);
    }

    /// Some of the vectors.
    #[inline(always)]
    pub(crate) fn range_mut(&mut self, range: Range<usize>) -> PointsMut<'_> {
        let n = self.stride;
        let (x, yz) = self.data.split_at_mut(n);
        let (y, z) = yz.split_at_mut(n);
        PointsMut { x: &mut x[range.clone()], y: &mut y[range.clone()], z: &mut z[range] }
    }
}

/// A stretch of [`Points`].
#[derive(Debug)]
pub(crate) struct PointsMut<'a> {
    pub(crate) x: &'a mut [f32],
    pub(crate) y: &'a mut [f32],
    pub(crate) z: &'a mut [f32],
}

impl PointsMut<'_> {
    /// Sets vectors `at..at + n`, `n` at most 8.
    #[inline(always)]
    pub(crate) fn store(&mut self, at: usize, n: usize, values: Lanes3) {
        let axes = [(&mut *self.x, values.x), (&mut *self.y, values.y), (&mut *self.z, values.z)];
        for (axis, values) in axes {
            let values = values.to_array();
            match axis[at..].first_chunk_mut() {
                Some(chunk) if n == LANES => *chunk = values,
                _ => axis[at..at + n].copy_from_slice(&values[..n]),
            }
        }
    }
}

impl PointsMut<'_> {
    /// Adds `omega` times the `steps` from `first` on.
    pub(crate) fn axpy(&mut self, omega: f32, first: usize, steps: &Points) {
        let axes = [&mut *self.x, &mut *self.y, &mut *self.z].into_iter().zip(steps.axes());
        for (axis, steps) in axes {
            for (value, step) in axis.iter_mut().zip(&steps[first..]) {
                *value += omega * step;
            }
        }
    }
}

impl Split for PointsMut<'_> {
    fn len(&self) -> usize {
        self.x.len()
    }

    fn split(self, at: usize) -> (Self, Self) {
        let ((x, x2), (y, y2), (z, z2)) =
            (self.x.split_at_mut(at), self.y.split_at_mut(at), self.z.split_at_mut(at));
        (PointsMut { x, y, z }, PointsMut { x: x2, y: y2, z: z2 })
    }
}
