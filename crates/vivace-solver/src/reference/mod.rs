//! Reference answers in `f64`.

pub(crate) mod cholesky;
