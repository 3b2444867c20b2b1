//! A sampled signed distance.

/// A signed distance, sampled on a grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    values: Vec<f32>,
}
