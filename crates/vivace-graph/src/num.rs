//! Between `usize` and the 32 bits that indices are stored in.

use rayon::prelude::*;

use crate::GraphError;

/// Most vertices a graph may have: `u32::MAX` itself is left free to mean "none".
pub(crate) const MAX_VERTICES: usize = u32::MAX as usize - 1;

/// Most items a compressed row structure may hold: the last offset is the number of items.
pub(crate) const MAX_ITEMS: usize = u32::MAX as usize;

/// Narrows an index whose range was checked where its structure was made (see [`check_vertices`], [`check_items`]).
#[expect(clippy::cast_possible_truncation, reason = "every count is checked against 32 bits at construction")]
pub(crate) fn to_u32(index: usize) -> u32 {
    debug_assert!(index <= MAX_ITEMS, "{index} does not fit 32 bits");
    index as u32
}

/// Refuses more vertices than can be numbered.
pub(crate) fn check_vertices(count: usize) -> Result<(), GraphError> {
    check("vertices", count, MAX_VERTICES)
}

/// Refuses more items (neighbors, incidences) than offsets can count.
pub(crate) fn check_items(what: &'static str, count: usize) -> Result<(), GraphError> {
    check(what, count, MAX_ITEMS)
}

fn check(what: &'static str, count: usize, limit: usize) -> Result<(), GraphError> {
    if count > limit { Err(GraphError::TooLarge { what, count, limit }) } else { Ok(()) }
}

/// Position of the first index that is not below `n`, if there is one.
///
/// Good lists are the rule: they are only compared with their maximum, which vectorises.
pub(crate) fn first_out_of_range(indices: &[u32], n: usize) -> Option<usize> {
    let is_out = |&index: &u32| index as usize >= n;
    let max = |chunk: &[u32]| chunk.iter().fold(0, |max, &index| max.max(index));
    let is_bad = indices.par_chunks(1 << 16).any(|chunk| is_out(&max(chunk)));
    if is_bad { indices.iter().position(is_out) } else { None }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_name_the_number() {
        assert!(check_vertices(u32::MAX as usize - 1).is_ok());
        let error = check_vertices(u32::MAX as usize).unwrap_err();
        assert!(error.to_string().contains("4294967295 vertices"), "{error}");
        assert!(check_items("neighbors", u32::MAX as usize).is_ok());
        assert!(check_items("neighbors", u32::MAX as usize + 1).is_err());
    }

    #[test]
    fn the_first_out_of_range_is_found() {
        let mut indices = vec![4; 200_000];
        assert_eq!(first_out_of_range(&indices, 5), None);
        (indices[150_000], indices[100_001]) = (5, u32::MAX);
        assert_eq!(first_out_of_range(&indices, 5), Some(100_001));
        assert_eq!(first_out_of_range(&[0], 0), Some(0));
        assert_eq!(first_out_of_range(&[], 0), None);
    }
}
