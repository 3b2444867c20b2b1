//! Compressed rows of `u32`: the one layout behind graphs, incidences and color partitions.

use crate::GraphError;
use crate::num::{MAX_ITEMS, check_items, check_vertices, to_u32};

/// Rows of `u32` in one array: row `i` is `items[offsets[i]..offsets[i + 1]]`.
///
/// `offsets` has one entry more than there are rows, starts at 0, never falls and ends at the number of items.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Csr {
    offsets: Vec<u32>,
    items: Vec<u32>,
}

impl Default for Csr {
    fn default() -> Self {
        Self { offsets: vec![0], items: Vec::new() }
    }
}

impl Csr {
    /// Takes the two arrays as they are. O(rows).
    ///
    /// # Errors
    /// Offsets that are empty, do not start at 0, fall, or do not end at the number of items; more rows or items than 32 bits
    /// can number.
    pub fn from_parts(offsets: Vec<u32>, items: Vec<u32>) -> Result<Self, GraphError> {
        let wrong = |index, found: usize, why| Err(GraphError::Offsets { index, found: found as u64, why });
        check_vertices(offsets.len().saturating_sub(1))?;
        check_items("items", items.len())?;
        match offsets.first() {
            None => return wrong(0, 0, "is missing (no rows are written as one offset, 0)"),
            Some(0) => {}
            Some(&first) => return wrong(0, first as usize, "should be 0"),
        }
        if let Some(row) = offsets.windows(2).position(|pair| pair[0] > pair[1]) {
            return wrong(row + 1, offsets[row + 1] as usize, "is less than the one before");
        }
        let last = offsets.len() - 1;
        if offsets[last] as usize != items.len() {
            return wrong(last, offsets[last] as usize, "is the last one but not the number of items");
        }
        Ok(Self { offsets, items })
    }

    /// For parts that hold the invariant by the way they were made.
    pub(crate) fn from_parts_unchecked(offsets: Vec<u32>, items: Vec<u32>) -> Self {
        debug_assert_eq!(offsets.first(), Some(&0));
        debug_assert_eq!(offsets.last().map(|&end| end as usize), Some(items.len()));
        Self { offsets, items }
    }

    /// Row `k` holds, ascending, each `i` with `keys[i] == k`: a counting sort, O(`n_groups` + keys).
    ///
    /// A key that is no group (`>= n_groups`, such as `u32::MAX` for "none yet") leaves its index out of every row.
    ///
    /// # Panics
    /// When there are more than `u32::MAX` keys.
    pub fn group_by(n_groups: usize, keys: &[u32]) -> Self {
        assert!(keys.len() <= MAX_ITEMS, "{} keys cannot be numbered in 32 bits", keys.len());
        let mut offsets = vec![0; n_groups + 1];
        for &key in keys.iter().filter(|&&key| (key as usize) < n_groups) {
            offsets[key as usize + 1] += 1;
        }
        let mut cursors = prefix_sum(&mut offsets);
        let mut items = vec![0; offsets[n_groups] as usize];
        for (i, &key) in keys.iter().enumerate() {
            if let Some(cursor) = cursors.get_mut(key as usize) {
                items[*cursor as usize] = to_u32(i);
                *cursor += 1;
            }
        }
        Self::from_parts_unchecked(offsets, items)
    }

    /// The two arrays, offsets first.
    pub fn into_parts(self) -> (Vec<u32>, Vec<u32>) {
        (self.offsets, self.items)
    }

    /// Number of rows.
    pub fn n_rows(&self) -> usize {
        self.offsets.len() - 1
    }

    /// Number of items in all rows.
    pub fn len(&self) -> usize {
        self.items.len()
    }

    /// Whether no row holds anything.
    pub fn is_empty(&self) -> bool {
        self.items.is_empty()
    }

    /// Row `i`.
    ///
    /// # Panics
    /// When `i` is not below `n_rows()`.
    #[inline]
    pub fn row(&self, i: u32) -> &[u32] {
        let i = i as usize;
        &self.items[self.offsets[i] as usize..self.offsets[i + 1] as usize]
    }

    /// The rows in order.
    pub fn rows(&self) -> impl ExactSizeIterator<Item = &[u32]> {
        self.offsets.windows(2).map(|ends| &self.items[ends[0] as usize..ends[1] as usize])
    }

    /// Where each row starts, then the number of items: `n_rows() + 1` entries.
    pub fn offsets(&self) -> &[u32] {
        &self.offsets
    }

    /// All rows, one after the other.
    pub fn items(&self) -> &[u32] {
        &self.items
    }
}

/// Turns counts, kept one place to the right (`offsets[i + 1]` counts row `i`), into offsets; returns a copy of the starts.
pub(crate) fn prefix_sum(offsets: &mut [u32]) -> Vec<u32> {
    let mut sum = 0;
    for offset in offsets.iter_mut() {
        sum += *offset;
        *offset = sum;
    }
    offsets[..offsets.len() - 1].to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_are_ascending_and_skip_what_has_none() {
        let groups = Csr::group_by(3, &[2, 0, 2, u32::MAX, 0, 3]);
        assert_eq!(groups.offsets(), [0, 2, 2, 4]);
        assert_eq!(groups.row(0), [1, 4]);
        assert!(groups.row(1).is_empty());
        assert_eq!(groups.row(2), [0, 2]);
        assert_eq!(Csr::group_by(0, &[]), Csr::default());
        assert_eq!(groups.rows().map(<[u32]>::len).collect::<Vec<_>>(), [2, 0, 2]);
    }

    #[test]
    fn parts_are_checked() {
        let offset_of = |offsets: &[u32], n_items| match Csr::from_parts(offsets.to_vec(), vec![7; n_items]) {
            Err(GraphError::Offsets { index, .. }) => Some(index),
            Ok(_) => None,
            Err(other) => panic!("{other}"),
        };
        assert_eq!(offset_of(&[], 0), Some(0));
        assert_eq!(offset_of(&[1, 2], 2), Some(0));
        assert_eq!(offset_of(&[0, 3, 2], 2), Some(2));
        assert_eq!(offset_of(&[0, 1, 3], 2), Some(2));
        assert_eq!(offset_of(&[0, 1], 2), Some(1));
        assert_eq!(offset_of(&[0, 1, 3], 3), None);
        let parts = (vec![0, 2], vec![5, 6]);
        assert_eq!(Csr::from_parts(parts.0.clone(), parts.1.clone()).unwrap().into_parts(), parts);
    }
}
