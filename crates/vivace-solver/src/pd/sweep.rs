//! What one vertex computes: the body of Algorithm 1's inner loop.
//!
//! A vertex is a few 16-byte loads, and the lengths of four springs at a time go through one square root and one division: plain
//! SSE2 or NEON, no dispatch at run time.

use std::ops::Range;

use glam::{Mat3, Vec3, Vec3A, Vec4};
use rayon::prelude::*;

use super::rows::Rows;

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
        let mut sum = self.anchor_weights[i] * (self.anchors[i] - at) + pull;
        let (start, middle) = (rows.offsets[i] as usize, rows.spring_ends[i] as usize);
        let end = rows.offsets[i + 1] as usize;
        let (columns, weights) = (&rows.columns[start..middle], &rows.weights[start..middle]);
        let pulls = &rows.pulls[start..middle];
        let (columns4, columns1) = columns.as_chunks::<4>();
        let (weights4, weights1) = weights.as_chunks::<4>();
        let (pulls4, pulls1) = pulls.as_chunks::<4>();
        for ((columns, weights), pulls) in columns4.iter().zip(weights4).zip(pulls4) {
            let d = columns.map(|j| q[j as usize] - at);
            let c = Vec4::from_array(*weights) - Vec4::from_array(*pulls) / lengths(&d);
            sum += d[0] * c.x + d[1] * c.y;
            sum += d[2] * c.z + d[3] * c.w;
        }
        let n_left = columns1.len();
        if n_left > 0 {
            let (mut d, mut weights, mut pulls) = ([Vec3A::ZERO; 4], [0.0; 4], [0.0; 4]);
            for k in 0..n_left.min(3) {
                d[k] = q[columns1[k] as usize] - at;
                weights[k] = weights1[k];
                pulls[k] = pulls1[k];
            }
            let c = Vec4::from_array(weights) - Vec4::from_array(pulls) / lengths(&d);
            sum += d[0] * c.x + d[1] * c.y;
            sum += d[2] * c.z;
        }
        sum + taps(&rows.columns[middle..end], &rows.weights[middle..end], q, at)
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
        let mut isotropic = rows.diagonal[i] + self.anchor_weights[i];
        let (mut diagonal, mut off) = (Vec3A::ZERO, Vec3A::ZERO);
        for k in rows.offsets[i] as usize..rows.spring_ends[i] as usize {
            let d = q[rows.columns[k] as usize] - q[i];
            let squared = d.length_squared().max(TINY * TINY);
            let stiffness = rows.stiffness[k];
            let across = (stiffness - rows.pulls[k] / squared.sqrt()).max(0.0);
            // k (u uᵀ + across (I − u uᵀ)) in place of k I.
            let along = (stiffness - across) / squared;
            isotropic += across - stiffness;
            diagonal += d * d * along;
            off += d * Vec3A::new(d.y, d.z, d.x) * along;
        }
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

/// Lengths of four vectors, at least [`TINY`].
#[inline]
fn lengths(d: &[Vec3A; 4]) -> Vec4 {
    let squared =
        Vec4::new(d[0].length_squared(), d[1].length_squared(), d[2].length_squared(), d[3].length_squared());
    squared.max(Vec4::splat(TINY * TINY)).sqrt()
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
