//! faer's own solve: what the direct solver's is measured against.

use std::fmt::Debug;
use std::time::Instant;

use faer::prelude::Solve;
use faer::sparse::linalg::solvers::Llt;
use faer::sparse::{SparseColMat, Triplet};
use faer::{Mat, Side};
use vivace_solver::SolverError;

use super::plain::Plain;
use super::sweeps::Task;
use crate::figures::FigureError;

/// A solve with a sparse Cholesky factor of PLAIN's matrix in `f64`, three right-hand sides, as faer's documentation shows it.
pub(super) fn task(plain: &Plain) -> Result<Task, FigureError> {
    let (n, factor) = factor(plain)?;
    let mut x = Mat::zeros(n, 3);
    Ok(Task::of_others("faer, solve", move || {
        x.fill(1.0);
        let begin = Instant::now();
        factor.solve_in_place(&mut x);
        begin.elapsed().as_secs_f64() * 1e3
    }))
}

fn factor(plain: &Plain) -> Result<(usize, Llt<u32, f64>), FigureError> {
    let (n, entries) = plain.entries();
    let triplets: Vec<_> =
        entries.iter().map(|&(row, column, value)| Triplet::new(row, column, value)).collect();
    let matrix = SparseColMat::try_new_from_triplets(n, n, &triplets).map_err(failed)?;
    Ok((n, matrix.sp_cholesky(Side::Lower).map_err(failed)?))
}

fn failed(error: impl Debug) -> FigureError {
    SolverError::Factor { reason: format!("{error:?}") }.into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench_simulation::scenes;

    #[test]
    fn solves_what_plain_sweeps_over() {
        let (model, _) = scenes::cloth(6, 100.0, true).unwrap();
        let plain = Plain::new(&model, scenes::STEP).unwrap();
        let (n, factor) = factor(&plain).unwrap();
        assert_eq!(n, 6 * 6 - 2);
        let mut x = Mat::<f64>::zeros(n, 3);
        x.fill(1.0);
        factor.solve_in_place(&mut x);
        let mut left = vec![1.0; n];
        for (row, column, value) in plain.entries().1 {
            left[row as usize] -= value * x[(column as usize, 2)];
        }
        assert!(left.iter().all(|left| left.abs() < 1e-9), "{left:?}");
    }
}
