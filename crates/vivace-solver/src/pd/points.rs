//! Positions, coordinate by coordinate, so that eight of them are three loads.

#![allow(clippy::inline_always, reason = "eight lanes stay in registers only if it is")]

use std::ops::Range;

use glam::Vec3A;
use vivace_kernels::lanes;
use wide::f32x8;

use crate::parallel::Split;

/// Vertices that are computed together: registers enough for all that a sweep sums up.
pub(crate) const LANES: usize = 8;

/// Eight vectors.
pub(crate) type Lanes3 = lanes::Lanes3<f32x8>;

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
        let &[a, b, c, d, e, f, g, h] = at;
        let of = |axis: &[f32]| {
            let at = |i: u32| axis[i as usize];
            f32x8::new([at(a), at(b), at(c), at(d), at(e), at(f), at(g), at(h)])
        };
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

    /// Takes the `values` from `first` on.
    pub(crate) fn copy_from(&mut self, first: usize, values: &Points) {
        let axes = [&mut *self.x, &mut *self.y, &mut *self.z].into_iter().zip(values.axes());
        axes.for_each(|(axis, values)| axis.copy_from_slice(&values[first..][..axis.len()]));
    }

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
