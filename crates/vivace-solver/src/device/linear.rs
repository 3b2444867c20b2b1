//! What solves the linear system of a global step on a device.

use vivace_kernels::Backend;

use super::conjugate_gradient::ConjugateGradient;
#[cfg(feature = "direct")]
use super::direct::Direct;
use crate::pd::rows::Rows;
use crate::{Relaxation, SolverError};

/// What solves `Y δ = r`.
pub(super) enum Linear<B: Backend> {
    ConjugateGradient(ConjugateGradient<B>),
    #[cfg(feature = "direct")]
    Direct(Box<Direct<B>>),
}

impl<B: Backend> Linear<B> {
    /// What `relaxation` asks for, if it is of the linear system.
    #[cfg_attr(not(feature = "direct"), expect(unused_variables, reason = "a factor alone needs the rows"))]
    pub(super) fn of(
        backend: &B,
        relaxation: Relaxation,
        rows: &Rows,
        [n, n_free]: [u32; 2],
    ) -> Result<Option<Self>, SolverError> {
        Ok(match relaxation {
            Relaxation::ConjugateGradient { .. } => {
                Some(Self::ConjugateGradient(ConjugateGradient::new(backend, n, n_free)))
            }
            #[cfg(feature = "direct")]
            Relaxation::Direct => Some(Self::Direct(Box::new(Direct::new(backend, rows, n_free)?))),
            _ => None,
        })
    }
}
