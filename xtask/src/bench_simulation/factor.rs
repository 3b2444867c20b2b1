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

/// Time of a solve with a sparse Cholesky factor of PLAIN's matrix \[ms\], three right-hand sides, in `f32` as ours is: it takes
/// three quarters of the time that `f64` does.
pub(super) fn task(plain: &Plain) -> Result<Task, FigureError> {
    const SOLVES: u32 = 4;
    let (n, factor) = factor(plain)?;
    let mut x = Mat::zeros(n, 3);
    let mut solve = move || {
        x.fill(1.0);
        factor.solve_in_place(&mut x);
    };
    Ok(Task::of_others("faer, solve", move || {
        // One that warms the caches.
        solve();
        let begin = Instant::now();
        (0..SOLVES).for_each(|_| solve());
        begin.elapsed().as_secs_f64() * 1e3 / f64::from(SOLVES)
    }))
}

fn factor(plain: &Plain) -> Result<(usize, Llt<u32, f32>), FigureError> {
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
        let mut x = Mat::<f32>::zeros(n, 3);
        x.fill(1.0);
        factor.solve_in_place(&mut x);
        let mut left = vec![1.0; n];
        for (row, column, value) in plain.entries().1 {
            left[row as usize] -= value * x[(column as usize, 2)];
        }
        assert!(left.iter().all(|left| left.abs() < 1e-4), "{left:?}");
    }
}
