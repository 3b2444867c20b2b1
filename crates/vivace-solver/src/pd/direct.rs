//! The global step by a sparse Cholesky factor, made once for each size of the time step (Bouaziz et al. 2014, section 5).

use glam::{Vec3, Vec4};

use vivace_kernels::pcg::pcg;

use super::rows::Rows;
use crate::SolverError;
use crate::cholesky::{Cholesky, Pattern};

/// `P Y Pᵀ = L Lᵀ`: factored in `f64`, kept in `f32`. That costs no digits that the positions have, unless Y is so ill-conditioned that it is refused.
#[derive(Debug, Clone)]
pub(crate) struct Factor {
    /// Row i of the permuted system is row `order[i]` of Y.
    order: Vec<u32>,
    /// Column j of L below the diagonal: `offsets[j]..offsets[j + 1]`.
    offsets: Vec<u32>,
    entries: Vec<Entry>,
    inverse_diagonal: Vec<f32>,
    work: Vec<Vec4>,
}

/// A solve must at least halve what is left, or iterations of it do not converge.
const WORST_RESIDUAL: f64 = 0.5;

#[derive(Debug, Clone, Copy)]
struct Entry {
    row: u32,
    value: f32,
}

impl Factor {
    /// Factors Y, with `anchor_weights` \[N/m\] on its diagonal.
    ///
    /// # Errors
    /// Y is not positive definite in `f64`, or its factor has more entries than 32 bits can number.
    pub(crate) fn new(rows: &Rows, anchor_weights: &[f32]) -> Result<Self, SolverError> {
        let (pattern, values) = lower_triangle(rows, anchor_weights);
        let mut cholesky = Cholesky::new(pattern, 3, None)?;
        cholesky.factor(&values)?;
        let columns = cholesky.columns();
        #[expect(clippy::cast_possible_truncation, reason = "the factor is kept in f32")]
        let entry = |(&row, &value): (&u32, &f64)| Entry { row, value: value as f32 };
        #[expect(clippy::cast_possible_truncation, reason = "the factor is kept in f32")]
        let inverse_diagonal = columns.diagonal.iter().map(|d| (1.0 / d) as f32).collect();
        let mut factor = Self {
            order: columns.order,
            offsets: columns.offsets,
            entries: columns.rows.iter().zip(&columns.values).map(entry).collect(),
            inverse_diagonal,
            work: vec![Vec4::ZERO; rows.len()],
        };
        check(rows, anchor_weights, |x| factor.solve_in_place(x))?;
        Ok(factor)
    }

    /// Makes x \[N\] the solution \[m\] of `Y δ = x`: forward and backward substitution, x, y and z at once.
    pub(crate) fn solve_in_place(&mut self, x: &mut [Vec3]) {
        let Self { order, offsets, entries, inverse_diagonal, work } = self;
        for (work, &row) in work.iter_mut().zip(&*order) {
            *work = x[row as usize].extend(0.0);
        }
        let column = |j: usize| &entries[offsets[j] as usize..offsets[j + 1] as usize];
        for (j, inverse) in inverse_diagonal.iter().enumerate() {
            let solved = work[j] * *inverse;
            work[j] = solved;
            for entry in column(j) {
                work[entry.row as usize] -= entry.value * solved;
            }
        }
        for (j, inverse) in inverse_diagonal.iter().enumerate().rev() {
            let (pairs, rest) = column(j).as_chunks::<2>();
            let (mut even, mut odd) = (work[j], Vec4::ZERO);
            for [a, b] in pairs {
                even -= a.value * work[a.row as usize];
                odd -= b.value * work[b.row as usize];
            }
            for entry in rest {
                even -= entry.value * work[entry.row as usize];
            }
            work[j] = (even + odd) * *inverse;
        }
        for (work, &row) in work.iter().zip(&*order) {
            x[row as usize] = work.truncate();
        }
    }
}

/// The lower triangle of Y, with `anchor_weights` \[N/m\] on its diagonal.
pub(crate) fn lower_triangle(rows: &Rows, anchor_weights: &[f32]) -> (Pattern, Vec<f64>) {
    let n = rows.len();
    let mut pattern = Pattern { offsets: vec![0], rows: Vec::new() };
    let mut values = Vec::new();
    let mut column = Vec::new();
    for (j, number) in (0..n).zip(0_u32..) {
        pattern.rows.push(number);
        values.push(f64::from(rows.diagonal[j]) + f64::from(anchor_weights[j]));
        let entries = rows.offsets[j] as usize..rows.offsets[j + 1] as usize;
        column.clear();
        column.extend(rows.columns[entries.clone()].iter().zip(&rows.weights[entries]));
        // Pinned particles are numbered beyond the rows.
        column.retain(|&(&i, _)| i > number && (i as usize) < n);
        column.sort_unstable_by_key(|&(&i, _)| i);
        pattern.rows.extend(column.iter().map(|(i, _)| **i));
        values.extend(column.iter().map(|(_, weight)| -f64::from(**weight)));
        pattern.offsets.push(u32::try_from(pattern.rows.len()).unwrap_or(u32::MAX));
    }
    (pattern, values)
}

/// Whether `solve` makes a right-hand side the solution in `f32`. What it leaves of a random one, ‖r − Y δ‖/‖r‖, is the condition of Y times
/// the rounding of `f32`.
///
/// # Errors
/// It leaves too much for iterations of it to converge.
pub(crate) fn check(
    rows: &Rows,
    anchor_weights: &[f32],
    solve: impl FnOnce(&mut [Vec3]),
) -> Result<(), SolverError> {
    let random = |k: u32| (pcg(k) >> 8) as f32 / (1 << 23) as f32 - 1.0;
    let r: Vec<Vec3> = (0_u32..)
        .map(|i| Vec3::new(random(3 * i), random(3 * i + 1), random(3 * i + 2)))
        .take(rows.len())
        .collect();
    let mut x = r.clone();
    solve(&mut x);
    let left = rows.relative_residual(anchor_weights, &r, &x);
    if left < WORST_RESIDUAL {
        Ok(())
    } else {
        Err(SolverError::Factor { reason: format!("in f32 a solve leaves {left:.0e} of its residual") })
    }
}

#[cfg(test)]
mod tests {
    use super::super::conjugate_gradient::ConjugateGradient;
    use super::super::conjugate_gradient::tests::grid;
    use super::*;
    use crate::Preconditioner;

    #[test]
    fn solves_as_a_dense_factor_does() {
        let (rows, anchor_weights, r) = grid(5);
        let n = rows.len();
        let mut dense = faer::Mat::<f64>::zeros(n, n);
        for i in 0..n {
            dense[(i, i)] = f64::from(rows.diagonal[i]) + f64::from(anchor_weights[i]);
            for k in rows.offsets[i] as usize..rows.offsets[i + 1] as usize {
                let j = rows.columns[k] as usize;
                if j < n {
                    dense[(i, j)] -= f64::from(rows.weights[k]);
                }
            }
        }
        let expected = faer::Mat::from_fn(n, 3, |i, axis| f64::from(r[i][axis]));
        let expected = faer::linalg::solvers::Solve::solve(&dense.llt(faer::Side::Lower).unwrap(), expected);
        let mut x = r;
        Factor::new(&rows, &anchor_weights).unwrap().solve_in_place(&mut x);
        for i in 0..n {
            for axis in 0..3 {
                let difference = f64::from(x[i][axis]) - expected[(i, axis)];
                assert!(difference.abs() < 1e-6, "{i} {axis}: {} {}", x[i][axis], expected[(i, axis)]);
            }
        }
    }

    #[test]
    fn residual_is_rounding_and_solves_repeat() {
        let (rows, anchor_weights, r) = grid(40);
        let mut factor = Factor::new(&rows, &anchor_weights).unwrap();
        let mut first = r.clone();
        factor.solve_in_place(&mut first);
        let left = rows.relative_residual(&anchor_weights, &r, &first);
        assert!(left < 1e-5, "{left}");
        let mut again = r;
        factor.solve_in_place(&mut again);
        assert_eq!(first, again);
    }

    #[test]
    fn conjugate_gradients_converge_to_it() {
        let (rows, anchor_weights, r) = grid(20);
        let (mut direct, mut iterated) = (r.clone(), r);
        Factor::new(&rows, &anchor_weights).unwrap().solve_in_place(&mut direct);
        let preconditioner = Preconditioner::SymmetricGaussSeidel;
        ConjugateGradient::default().solve_in_place(
            &rows,
            &anchor_weights,
            preconditioner,
            500,
            &mut iterated,
        );
        for (a, b) in direct.iter().zip(&iterated) {
            assert!(a.distance(*b) < 1e-5 * (1.0 + a.length()), "{a} {b}");
        }
    }

    #[test]
    fn an_indefinite_matrix_is_refused() {
        let (rows, mut anchor_weights, _) = grid(5);
        anchor_weights[7] = -1e6;
        assert!(matches!(Factor::new(&rows, &anchor_weights), Err(SolverError::Factor { .. })));
        assert!(Factor::new(&Rows { offsets: vec![0], ..Rows::default() }, &[]).is_ok());
    }
}
