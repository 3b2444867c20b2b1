//! What one vertex computes: the body of Algorithm 1's inner loop.
//!
//! A vertex is a few 16-byte loads, and the lengths of four springs at a time go through one square root and one division: plain
//! SSE2 or NEON, no dispatch at run time.

use std::ops::Range;

use glam::{Mat3, Vec3, Vec3A, Vec4};
use rayon::prelude::*;

use super::rows::{Quad, Rows};

/// What a sweep reads beside q.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Vertices<'a> {
    pub(crate) rows: &'a Rows,
    /// m/h² and the stiffness of attachments \[N/m\].
    pub(crate) anchor_weights: &'a [f32],
    /// Mean of the prediction s and the targets of attachments, by these weights \[m\].
    pub(crate) anchors: &'a [Vec3A],
    /// One over the diagonal of Y \[m/N\].
    pub(crate) inverse_diagonal: &'a [f32],
}

/// Lengths below this are 0 \[m\]; its square is a normal number.
const TINY: f32 = 1e-18;

impl Vertices<'_> {
    /// `b_i − (Y q)_i` \[N\] with the springs projected from q.
    #[inline]
    pub(crate) fn fused(&self, i: usize, q: &[Vec3A], pull: Vec3A) -> Vec3A {
        let rows = self.rows;
        let at = q[i];
        let sum = self.anchor_weights[i] * (self.anchors[i] - at) + pull;
        let (mut x, mut y, mut z) = (Vec4::ZERO, Vec4::ZERO, Vec4::ZERO);
        for quad in self.quads(i) {
            let d = Four::new(&quad.columns, q, at);
            let c = Vec4::from_array(quad.weights) - Vec4::from_array(quad.pulls) / d.length();
            x += d.x * c;
            y += d.y * c;
            z += d.z * c;
        }
        let springs = Vec3A::new(x.element_sum(), y.element_sum(), z.element_sum());
        let others = rows.spring_ends[i] as usize..rows.offsets[i + 1] as usize;
        sum + springs + taps(&rows.columns[others.clone()], &rows.weights[others], q, at)
    }

    #[inline]
    fn quads(&self, i: usize) -> &[Quad] {
        let rows = self.rows;
        &rows.quads[rows.quad_offsets[i] as usize..rows.quad_offsets[i + 1] as usize]
    }

    /// `b_i − (Y q)_i` \[N\] with all projections in `pull`.
    #[inline]
    pub(crate) fn linear(&self, i: usize, q: &[Vec3A], pull: Vec3A) -> Vec3A {
        let rows = self.rows;
        let at = q[i];
        let range = rows.offsets[i] as usize..rows.offsets[i + 1] as usize;
        let sum = self.anchor_weights[i] * (self.anchors[i] - at) + pull;
        sum + taps(&rows.columns[range.clone()], &rows.weights[range], q, at)
    }

    /// `Σ w Aᵀ p` of the springs of vertex i \[N\].
    #[inline]
    pub(crate) fn spring_pull(&self, i: usize, q: &[Vec3A]) -> Vec3A {
        let rows = self.rows;
        let mut sum = Vec3A::ZERO;
        for k in rows.offsets[i] as usize..rows.spring_ends[i] as usize {
            let d = q[rows.columns[k] as usize] - q[i];
            sum -= d * (rows.pulls[k] / d.length().max(TINY));
        }
        sum
    }

    /// The vertex's own block of the Hessian, of springs exactly (positive semi-definite), of all else as in Y \[N/m\].
    #[inline]
    pub(crate) fn block(&self, i: usize, q: &[Vec3A]) -> Mat3 {
        let rows = self.rows;
        let mut isotropic = Vec4::ZERO;
        let (mut xx, mut yy, mut zz) = (Vec4::ZERO, Vec4::ZERO, Vec4::ZERO);
        let (mut xy, mut yz, mut zx) = (Vec4::ZERO, Vec4::ZERO, Vec4::ZERO);
        for quad in self.quads(i) {
            let d = Four::new(&quad.columns, q, q[i]);
            let squared = d.squared_length();
            let stiffness = Vec4::from_array(quad.stiffness);
            let across = (stiffness - Vec4::from_array(quad.pulls) / squared.sqrt()).max(Vec4::ZERO);
            // k (u uᵀ + across (I − u uᵀ)) in place of k I.
            let along = (stiffness - across) / squared;
            isotropic += across - stiffness;
            let (x, y, z) = (d.x * along, d.y * along, d.z * along);
            xx += x * d.x;
            yy += y * d.y;
            zz += z * d.z;
            xy += x * d.y;
            yz += y * d.z;
            zx += z * d.x;
        }
        let isotropic = rows.diagonal[i] + self.anchor_weights[i] + isotropic.element_sum();
        let diagonal = Vec3A::new(xx.element_sum(), yy.element_sum(), zz.element_sum());
        let off = Vec3A::new(xy.element_sum(), yz.element_sum(), zx.element_sum());
        let diagonal = diagonal + isotropic;
        Mat3::from_cols(
            Vec3::new(diagonal.x, off.x, off.z),
            Vec3::new(off.x, diagonal.y, off.y),
            Vec3::new(off.z, off.y, diagonal.z),
        )
    }

    /// Energy of the springs and flat hinges in the row of vertex i, half of each entry, and of its inertia \[J\].
    pub(crate) fn objective(&self, i: usize, q: &[Vec3A]) -> f64 {
        let rows = self.rows;
        let at = q[i];
        let mut sum = 0.5 * self.anchor_weights[i] * (at - self.anchors[i]).length_squared();
        let (start, middle) = (rows.offsets[i] as usize, rows.spring_ends[i] as usize);
        // An entry towards a free particle stands in two rows, one towards a pinned particle in one.
        let share = |column: u32| if (column as usize) < rows.len() { 0.25 } else { 0.5 };
        for k in start..middle {
            let stretch = (q[rows.columns[k] as usize] - at).length() - rows.pulls[k] / rows.stiffness[k];
            sum += share(rows.columns[k]) * rows.stiffness[k] * stretch * stretch;
        }
        for k in start..rows.offsets[i + 1] as usize {
            let squared = (q[rows.columns[k] as usize] - at).length_squared();
            sum += share(rows.columns[k]) * rows.linear[k] * squared;
        }
        f64::from(sum)
    }
}

/// Four differences of positions, coordinate by coordinate.
struct Four {
    x: Vec4,
    y: Vec4,
    z: Vec4,
}

impl Four {
    #[inline]
    fn new(columns: &[u32; 4], q: &[Vec3A], at: Vec3A) -> Self {
        let [a, b, c, d] = columns.map(|j| q[j as usize] - at);
        Self {
            x: Vec4::new(a.x, b.x, c.x, d.x),
            y: Vec4::new(a.y, b.y, c.y, d.y),
            z: Vec4::new(a.z, b.z, c.z, d.z),
        }
    }

    /// At least [`TINY`].
    #[inline]
    fn squared_length(&self) -> Vec4 {
        (self.x * self.x + self.y * self.y + self.z * self.z).max(Vec4::splat(TINY * TINY))
    }

    #[inline]
    fn length(&self) -> Vec4 {
        self.squared_length().sqrt()
    }
}

/// `Σ_j −Y_ij (q_j − q_i)`.
#[inline]
fn taps(columns: &[u32], weights: &[f32], q: &[Vec3A], at: Vec3A) -> Vec3A {
    let (mut even, mut odd) = (Vec3A::ZERO, Vec3A::ZERO);
    let (columns2, columns1) = columns.as_chunks::<2>();
    let (weights2, weights1) = weights.as_chunks::<2>();
    for (columns, weights) in columns2.iter().zip(weights2) {
        even += (q[columns[0] as usize] - at) * weights[0];
        odd += (q[columns[1] as usize] - at) * weights[1];
    }
    if let (Some(&column), Some(&weight)) = (columns1.first(), weights1.first()) {
        even += (q[column as usize] - at) * weight;
    }
    even + odd
}

/// Vertices that one thread computes before another may take over.
pub(crate) const GRAIN: usize = 256;

/// `out[k] = f(range.start + k)`, on all threads of the pool.
pub(crate) fn fill<T: Send>(range: Range<usize>, out: &mut [T], f: impl Fn(usize) -> T + Sync) {
    let piece = |first: usize, out: &mut [T]| {
        for (k, out) in out.iter_mut().enumerate() {
            *out = f(first + k);
        }
    };
    let n_threads = rayon::current_num_threads();
    if n_threads == 1 || out.len() < 2 * GRAIN {
        return piece(range.start, out);
    }
    let len = out.len().div_ceil(n_threads).max(GRAIN);
    out.par_chunks_mut(len).enumerate().for_each(|(k, out)| piece(range.start + k * len, out));
}

/// Sums `f` over `0..n`, piece by piece in order, so that the number of threads does not show.
pub(crate) fn sum_in_pieces(n: usize, f: impl Fn(usize) -> f64 + Sync) -> f64 {
    const PIECE: usize = 1024;
    let sum = |piece: usize| (piece * PIECE..((piece + 1) * PIECE).min(n)).map(&f).sum::<f64>();
    if rayon::current_num_threads() == 1 || n < 2 * PIECE {
        return (0..n.div_ceil(PIECE)).map(sum).sum();
    }
    let pieces: Vec<f64> = (0..n.div_ceil(PIECE)).into_par_iter().map(sum).collect();
    pieces.iter().sum()
}
