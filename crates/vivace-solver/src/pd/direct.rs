//! The global step by a sparse Cholesky factor, made once for each size of the time step (Bouaziz et al. 2014, section 5).

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};
use glam::{Vec3, Vec4};

use super::rows::Rows;
use crate::SolverError;

/// `P Y Pᵀ = L Lᵀ` in `f32`, column by column.
#[derive(Debug, Clone)]
pub(crate) struct Factor {
    /// Row `i` of the permuted system is row `order[i]` of Y.
    order: Vec<u32>,
    offsets: Vec<u32>,
    /// The rows of the entries below the diagonal.
    rows: Vec<u32>,
    values: Vec<f32>,
    inverse_diagonal: Vec<f32>,
    work: Vec<Vec4>,
}
