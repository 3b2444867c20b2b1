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

    /// Some of the vectors to write, and all others to read meanwhile.
    pub(crate) fn around(&mut self, range: Range<usize>) -> (PointsMut<'_>, Around<'_>) {
        let n = self.stride;
        let (x, yz) = self.data.split_at_mut(n);
        let (y, z) = yz.split_at_mut(n);
        let ((bx, x, ax), (by, y, ay), (bz, z, az)) =
            (cut_out(x, &range), cut_out(y, &range), cut_out(z, &range));
        (PointsMut { x, y, z }, Around { written: range, before: [bx, by, bz], after: [ax, ay, az] })
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

/// What comes before `range`, it, and what comes after it.
fn cut_out<'a>(axis: &'a mut [f32], range: &Range<usize>) -> (&'a [f32], &'a mut [f32], &'a [f32]) {
    let (before, rest) = axis.split_at_mut(range.start);
    let (own, after) = rest.split_at_mut(range.len());
    (before, own, after)
}

/// Where vectors are read.
pub(crate) trait Read: Sync {
    /// Vectors `at..at + 8`.
    fn lanes(&self, at: usize) -> Lanes3;

    /// Vectors anywhere.
    fn gather(&self, at: &[u32; LANES]) -> Lanes3;
}

/// Eight, one by one.
#[inline(always)]
fn each(&[a, b, c, d, e, f, g, h]: &[u32; LANES], of: impl Fn(usize) -> f32) -> f32x8 {
    // Written out: `array::map` may become a call.
    let at = |i: u32| of(i as usize);
    f32x8::new([at(a), at(b), at(c), at(d), at(e), at(f), at(g), at(h)])
}

impl Read for Points {
    #[inline(always)]
    fn lanes(&self, at: usize) -> Lanes3 {
        let [x, y, z] = self.axes();
        Lanes3 { x: load(x, at), y: load(y, at), z: load(z, at) }
    }

    #[inline(always)]
    fn gather(&self, at: &[u32; LANES]) -> Lanes3 {
        let [x, y, z] = self.axes();
        Lanes3 { x: each(at, |i| x[i]), y: each(at, |i| y[i]), z: each(at, |i| z[i]) }
    }
}

/// All vectors but a stretch of them, which someone writes meanwhile: read as 0.
#[derive(Debug)]
pub(crate) struct Around<'a> {
    written: Range<usize>,
    before: [&'a [f32]; 3],
    after: [&'a [f32]; 3],
}

impl Around<'_> {
    #[inline(always)]
    fn get(&self, axis: usize, i: usize) -> f32 {
        if i < self.written.start {
            self.before[axis][i]
        } else if i >= self.written.end {
            self.after[axis][i - self.written.end]
        } else {
            0.0
        }
    }

    /// A run into what is written, or over it.
    #[cold]
    #[inline(never)]
    fn across(&self, at: usize) -> Lanes3 {
        let of = |axis: usize| f32x8::new(std::array::from_fn(|lane| self.get(axis, at + lane)));
        Lanes3 { x: of(0), y: of(1), z: of(2) }
    }
}

impl Read for Around<'_> {
    #[inline(always)]
    fn lanes(&self, at: usize) -> Lanes3 {
        let ([x, y, z], at) = if at + LANES <= self.written.start {
            (self.before, at)
        } else if at >= self.written.end {
            (self.after, at - self.written.end)
        } else {
            return self.across(at);
        };
        Lanes3 { x: load(x, at), y: load(y, at), z: load(z, at) }
    }

    #[inline(always)]
    fn gather(&self, at: &[u32; LANES]) -> Lanes3 {
        let of = |axis: usize| each(at, |i| self.get(axis, i));
        Lanes3 { x: of(0), y: of(1), z: of(2) }
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

    /// Vectors `at..at + 8`; 0 where there are not as many.
    #[inline(always)]
    pub(crate) fn lanes(&self, at: usize) -> Lanes3 {
        Lanes3 { x: load(self.x, at), y: load(self.y, at), z: load(self.z, at) }
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
