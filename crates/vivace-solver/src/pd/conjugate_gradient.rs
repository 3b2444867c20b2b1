//! Preconditioned conjugate gradients (Hestenes and Stiefel 1952) on `Y δ = r`, x, y and z at once.

use glam::{DVec3, Vec3};

use super::rows::Rows;
use crate::Preconditioner;
use crate::parallel::in_pieces;

/// Work vectors, kept from solve to solve.
#[derive(Debug, Clone, Default)]
pub(crate) struct ConjugateGradient {
    /// Y_ii, and one over it.
    diagonal: Vec<f32>,
    inverse_diagonal: Vec<f32>,
    work: Work,
}

#[derive(Debug, Clone, Default)]
struct Work {
    solution: Vec<Vec3>,
    direction: Vec<Vec3>,
    /// Y times the direction.
    image: Vec<Vec3>,
    /// M⁻¹ r.
    preconditioned: Vec<Vec3>,
}

/// When to stop.
#[derive(Debug, Clone, Copy)]
struct Limit {
    iterations: u32,
    /// Of the residual's norm, relative to the first; each of x, y and z must meet it.
    tolerance: f64,
}

/// Rows that one thread computes before another may take over.
const GRAIN: usize = 256;
/// With a residual this small against the first, `f32` has no more digits to give.
pub(crate) const ROUNDING: f64 = 1e-7;

impl ConjugateGradient {
    /// Makes `residual` \[N\] the δ \[m\] of `Y δ = residual` after `iterations` iterations, fewer if rounding is reached before.
    /// `anchor_weights` \[N/m\] belong to the diagonal.
    pub(crate) fn solve_in_place(
        &mut self,
        rows: &Rows,
        anchor_weights: &[f32],
        preconditioner: Preconditioner,
        iterations: u32,
        residual: &mut [Vec3],
    ) {
        let Self { diagonal, inverse_diagonal, work } = self;
        diagonal.clear();
        diagonal.extend(rows.diagonal.iter().zip(anchor_weights).map(|(a, b)| a + b));
        inverse_diagonal.clear();
        inverse_diagonal.extend(diagonal.iter().map(|d| 1.0 / d));
        let limit = Limit { iterations, tolerance: ROUNDING };
        match preconditioner {
            Preconditioner::Jacobi => {
                work.solve(rows, diagonal, limit, residual, |r, z| jacobi(inverse_diagonal, r, z));
            }
            Preconditioner::SymmetricGaussSeidel => {
                work.solve(rows, diagonal, limit, residual, |r, z| {
                    symmetric_gauss_seidel(rows, inverse_diagonal, r, z);
                });
            }
        }
    }
}

impl Work {
    /// Returns how many iterations it took. `residual` becomes the solution.
    fn solve(
        &mut self,
        rows: &Rows,
        diagonal: &[f32],
        limit: Limit,
        residual: &mut [Vec3],
        mut precondition: impl FnMut(&[Vec3], &mut [Vec3]),
    ) -> u32 {
        let Self { solution, direction, image, preconditioned } = self;
        for vector in [&mut *solution, image, preconditioned] {
            vector.clear();
            vector.resize(residual.len(), Vec3::ZERO);
        }
        precondition(residual, preconditioned);
        direction.clone_from(preconditioned);
        let mut rho = dot(residual, preconditioned);
        let enough = dot(residual, residual) * (limit.tolerance * limit.tolerance);
        let mut k = 0;
        while k < limit.iterations && dot(residual, residual).cmpgt(enough).any() {
            in_pieces(0, image.as_mut_slice(), GRAIN, &|first, image: &mut [Vec3]| {
                for (i, image) in (first..).zip(image) {
                    *image = diagonal[i] * direction[i] - weighted(rows, i, direction, |_| true);
                }
            });
            let alpha = ratio(rho, dot(direction, image));
            for (x, d) in solution.iter_mut().zip(&*direction) {
                *x += alpha * *d;
            }
            for (r, y) in residual.iter_mut().zip(&*image) {
                *r -= alpha * *y;
            }
            precondition(residual, preconditioned);
            let next = dot(residual, preconditioned);
            let beta = ratio(next, rho);
            rho = next;
            for (d, z) in direction.iter_mut().zip(&*preconditioned) {
                *d = *z + beta * *d;
            }
            k += 1;
        }
        residual.copy_from_slice(solution);
        k
    }
}

/// Σ −Y_ij x_j over the free neighbors of row `i` that `wanted` lets through.
#[inline]
fn weighted(rows: &Rows, i: usize, x: &[Vec3], wanted: impl Fn(usize) -> bool) -> Vec3 {
    let entries = rows.offsets[i] as usize..rows.offsets[i + 1] as usize;
    let mut sum = Vec3::ZERO;
    for (&j, &weight) in rows.columns[entries.clone()].iter().zip(&rows.weights[entries]) {
        let j = j as usize;
        // Pinned particles, whose numbers are beyond the rows, do not move.
        if j < x.len() && wanted(j) {
            sum += weight * x[j];
        }
    }
    sum
}

/// D⁻¹ r.
fn jacobi(inverse_diagonal: &[f32], r: &[Vec3], z: &mut [Vec3]) {
    for ((z, r), inverse) in z.iter_mut().zip(r).zip(inverse_diagonal) {
        *z = *inverse * *r;
    }
}

/// `((D + L) D⁻¹ (D + Lᵀ))⁻¹ r`: a sweep forward from 0, then one backward. Rows are numbered color by color, so the order of
/// rows is that of colors.
fn symmetric_gauss_seidel(rows: &Rows, inverse_diagonal: &[f32], r: &[Vec3], z: &mut [Vec3]) {
    for i in 0..rows.len() {
        z[i] = inverse_diagonal[i] * (r[i] + weighted(rows, i, z, |j| j < i));
    }
    for i in (0..rows.len()).rev() {
        z[i] += inverse_diagonal[i] * weighted(rows, i, z, |j| j > i);
    }
}

/// One dot product for each of x, y and z, in `f64` and in order: the number of threads does not show.
fn dot(a: &[Vec3], b: &[Vec3]) -> DVec3 {
    a.iter().zip(b).map(|(a, b)| a.as_dvec3() * b.as_dvec3()).sum()
}

/// `a / b`, 0 where b is: that column is solved.
fn ratio(a: DVec3, b: DVec3) -> Vec3 {
    DVec3::select(b.cmpgt(DVec3::ZERO), a / b, DVec3::ZERO).as_vec3()
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A grid of springs with random stiffness, every seventh row tied to a pinned particle, and r.
    #[expect(clippy::cast_possible_truncation, reason = "small")]
    pub(crate) fn grid(width: usize) -> (Rows, Vec<f32>, Vec<Vec3>) {
        let n = width * width;
        let mut hash = 1_u32;
        let mut random = move || {
            hash = hash.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            (hash >> 8) as f32 / (1 << 24) as f32
        };
        let mut entries = vec![Vec::new(); n];
        for i in 0..n {
            let right = (i % width + 1 < width).then_some(i + 1);
            for j in [right, Some(i + width), Some(i + width + 1)].into_iter().flatten().filter(|&j| j < n) {
                let weight = 1.0 + 99.0 * random();
                entries[i].push((j as u32, weight));
                entries[j].push((i as u32, weight));
            }
        }
        let mut rows = Rows { offsets: vec![0], ..Rows::default() };
        for (i, mut row) in entries.into_iter().enumerate() {
            if i % 7 == 0 {
                row.push((n as u32, 3.0));
            }
            rows.diagonal.push(row.iter().map(|e| e.1).sum());
            rows.columns.extend(row.iter().map(|e| e.0));
            rows.weights.extend(row.iter().map(|e| e.1));
            rows.offsets.push(rows.columns.len() as u32);
        }
        let anchor_weights = (0..n).map(|_| 0.5 + random()).collect();
        let r = (0..n).map(|_| Vec3::new(random(), random(), random()) - 0.5).collect();
        (rows, anchor_weights, r)
    }

    const BOTH: [Preconditioner; 2] = [Preconditioner::Jacobi, Preconditioner::SymmetricGaussSeidel];

    #[test]
    fn converges_to_the_solution() {
        let (rows, anchor_weights, r) = grid(20);
        for preconditioner in BOTH {
            let mut x = r.clone();
            let mut solver = ConjugateGradient::default();
            solver.solve_in_place(&rows, &anchor_weights, preconditioner, 1000, &mut x);
            let left = rows.relative_residual(&anchor_weights, &r, &x);
            assert!(left < 2e-5, "{preconditioner:?} {left}");
            // Kept work vectors carry nothing over.
            let mut again = r.clone();
            solver.solve_in_place(&rows, &anchor_weights, preconditioner, 1000, &mut again);
            assert_eq!(x, again);
        }
    }

    #[test]
    fn gauss_seidel_needs_fewer_iterations() {
        let (rows, anchor_weights, r) = grid(20);
        let left = BOTH.map(|preconditioner| {
            let mut x = r.clone();
            ConjugateGradient::default().solve_in_place(&rows, &anchor_weights, preconditioner, 15, &mut x);
            rows.relative_residual(&anchor_weights, &r, &x)
        });
        assert!(left[1] < 0.3 * left[0], "{left:?}");
    }

    /// The preconditioner against its definition, the product of its three factors.
    #[test]
    fn gauss_seidel_is_its_definition() {
        let (rows, anchor_weights, r) = grid(6);
        let n = rows.len();
        let d: Vec<f32> = rows.diagonal.iter().zip(&anchor_weights).map(|(a, b)| a + b).collect();
        let inverse: Vec<f32> = d.iter().map(|d| 1.0 / d).collect();
        let mut z = vec![Vec3::ZERO; n];
        symmetric_gauss_seidel(&rows, &inverse, &r, &mut z);
        let upper: Vec<_> = (0..n).map(|i| z[i] - weighted(&rows, i, &z, |j| j > i) * inverse[i]).collect();
        for i in 0..n {
            let back = d[i] * upper[i] - weighted(&rows, i, &upper, |j| j < i);
            assert!((back - r[i]).length() < 1e-5, "{i}: {back} {}", r[i]);
        }
    }

    #[test]
    fn a_column_of_zeros_stays_zero() {
        let (rows, anchor_weights, mut r) = grid(5);
        r.iter_mut().for_each(|r| r.y = 0.0);
        let mut x = r.clone();
        ConjugateGradient::default().solve_in_place(&rows, &anchor_weights, BOTH[0], 50, &mut x);
        assert!(x.iter().all(|x| x.y == 0.0 && x.is_finite()));
        assert!(rows.relative_residual(&anchor_weights, &r, &x) < 1e-4);
    }
}
