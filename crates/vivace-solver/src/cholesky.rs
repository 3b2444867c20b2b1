//! Sparse Cholesky factors in `f64`, by faer: one thread, so the answer is always the same.

use std::fmt;
use std::ops::Range;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::perm::PermRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::supernodal::SupernodalLltRef;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, MatRef, Par, Side};

use crate::SolverError;

/// The lower triangle of a symmetric matrix, compressed by columns: which entries there are.
#[derive(Debug, Clone, Default)]
pub(crate) struct Pattern {
    /// Column j: `offsets[j]..offsets[j + 1]`.
    pub(crate) offsets: Vec<u32>,
    /// The rows, ascending in each column, the diagonal first.
    pub(crate) rows: Vec<u32>,
}

impl Pattern {
    /// How many columns there are.
    pub(crate) fn len(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    fn view(&self) -> SymbolicSparseColMatRef<'_, u32> {
        SymbolicSparseColMatRef::new_checked(self.len(), self.len(), &self.offsets, None, &self.rows)
    }
}

/// `P A Pᵀ = L Lᵀ`.
pub(crate) struct Cholesky {
    pattern: Pattern,
    symbolic: SymbolicCholesky<u32>,
    values: Vec<f64>,
    memory: MemBuffer,
    n_columns: usize,
}

impl fmt::Debug for Cholesky {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Cholesky")
            .field("rows", &self.pattern.len())
            .field("entries", &self.values.len())
            .finish()
    }
}

/// Columns that are eliminated together.
#[derive(Debug, Clone)]
pub(crate) struct Supernode {
    /// The columns, and rows of the same numbers.
    pub(crate) columns: Range<u32>,
    /// The rows below that any of them has, ascending.
    pub(crate) below: Vec<u32>,
}

/// L by columns.
#[derive(Debug, Clone, Default)]
pub(crate) struct Columns {
    /// Row i of the permuted matrix is row `order[i]` of A.
    pub(crate) order: Vec<u32>,
    /// Column j below the diagonal: `offsets[j]..offsets[j + 1]`.
    pub(crate) offsets: Vec<u32>,
    /// The rows.
    pub(crate) rows: Vec<u32>,
    /// The entries.
    pub(crate) values: Vec<f64>,
    /// The diagonal.
    pub(crate) diagonal: Vec<f64>,
}

impl Cholesky {
    /// Analyses `pattern` for right-hand sides of `n_columns` columns. Rows are eliminated in the order of approximate minimum
    /// degree, or `order`.
    ///
    /// # Errors
    /// Not enough memory; more entries than 32 bits can number.
    pub(crate) fn new(
        pattern: Pattern,
        n_columns: usize,
        order: Option<&[u32]>,
    ) -> Result<Self, SolverError> {
        let params = CholeskySymbolicParams {
            // Below 0, which a diagonal matrix does not exceed: it would be stored in another way.
            supernodal_flop_ratio_threshold: SupernodalThreshold(-1.0),
            ..CholeskySymbolicParams::default()
        };
        let n = pattern.len();
        let symbolic = match order {
            None => factorize_symbolic_cholesky(pattern.view(), Side::Lower, SymmetricOrdering::Amd, params),
            Some(order) => {
                let mut inverse = vec![0; n];
                for (k, &row) in (0..).zip(order) {
                    inverse[row as usize] = k;
                }
                let order = SymmetricOrdering::Custom(PermRef::new_checked(order, &inverse, n));
                factorize_symbolic_cholesky(pattern.view(), Side::Lower, order, params)
            }
        };
        let symbolic = symbolic.map_err(failed)?;
        let scratch = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, faer::prelude::default());
        let scratch = scratch.or(symbolic.solve_in_place_scratch::<f64>(n_columns, Par::Seq));
        let memory = MemBuffer::try_new(scratch).map_err(failed)?;
        let values = vec![0.0; symbolic.len_val()];
        Ok(Self { pattern, symbolic, values, memory, n_columns })
    }

    /// Factors the matrix whose entries, in the order of the pattern, are `values`.
    ///
    /// # Errors
    /// The matrix is not positive definite.
    pub(crate) fn factor(&mut self, values: &[f64]) -> Result<(), SolverError> {
        let matrix = SparseColMatRef::new(self.pattern.view(), values);
        self.symbolic
            .factorize_numeric_llt(
                &mut self.values,
                matrix,
                Side::Lower,
                faer::prelude::default(),
                Par::Seq,
                MemStack::new(&mut self.memory),
                faer::prelude::default(),
            )
            .map_err(failed)?;
        if self.values.iter().all(|value| value.is_finite()) {
            Ok(())
        } else {
            Err(SolverError::Factor { reason: "an entry is not finite".into() })
        }
    }

    /// Solves for `x`, one column after the other.
    pub(crate) fn solve_in_place(&mut self, x: &mut [f64]) {
        let x = MatMut::from_column_major_slice_mut(x, self.pattern.len(), self.n_columns);
        let factor = LltRef::new(&self.symbolic, &self.values);
        factor.solve_in_place_with_conj(Conj::No, x, Par::Seq, MemStack::new(&mut self.memory));
    }

    /// The order in which rows are eliminated.
    pub(crate) fn order(&self) -> Vec<u32> {
        match self.symbolic.perm() {
            Some(order) => order.arrays().0.to_vec(),
            None => (0..).take(self.pattern.len()).collect(),
        }
    }

    /// What is eliminated together, in order.
    pub(crate) fn supernodes(&self) -> Vec<Supernode> {
        let SymbolicCholeskyRaw::Supernodal(symbolic) = self.symbolic.raw() else { return Vec::new() };
        let ends = symbolic.supernode_begin().iter().zip(symbolic.supernode_end());
        let all = ends.enumerate().map(|(s, (&begin, &end))| Supernode {
            columns: begin..end,
            below: symbolic.supernode(s).pattern().to_vec(),
        });
        all.collect()
    }

    /// The entries of each supernode: its own rows, then those below.
    pub(crate) fn blocks(&self) -> Vec<MatRef<'_, f64>> {
        let SymbolicCholeskyRaw::Supernodal(symbolic) = self.symbolic.raw() else { return Vec::new() };
        let factor = SupernodalLltRef::new(symbolic, &self.values);
        (0..symbolic.n_supernodes()).map(|s| factor.supernode(s).val()).collect()
    }

    /// L, without the zeros that only blocks need.
    pub(crate) fn columns(&self) -> Columns {
        let mut columns = Columns { order: self.order(), offsets: vec![0], ..Columns::default() };
        for (supernode, block) in self.supernodes().iter().zip(self.blocks()) {
            let numbers: Vec<u32> =
                supernode.columns.clone().chain(supernode.below.iter().copied()).collect();
            for j in 0..block.ncols() {
                columns.diagonal.push(block[(j, j)]);
                for i in j + 1..block.nrows() {
                    if block[(i, j)] != 0.0 {
                        columns.rows.push(numbers[i]);
                        columns.values.push(block[(i, j)]);
                    }
                }
                columns.offsets.push(u32::try_from(columns.rows.len()).unwrap_or(u32::MAX));
            }
        }
        columns
    }
}

fn failed(error: impl fmt::Debug) -> SolverError {
    SolverError::Factor { reason: format!("{error:?}") }
}
