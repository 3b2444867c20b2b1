//! How rows of neighbors are made: every vertex gathers its own, so no row depends on another or on the threads.

use rayon::prelude::*;

use crate::num::{check_items, to_u32};
use crate::{Csr, GraphError};

/// Vertices gathered by one task.
const CHUNK: usize = 4096;

/// Rows made by one task: their lengths, and their items one after the other.
type Chunk = (Vec<u32>, Vec<u32>);

/// Makes `n` rows: `gather(v, row)` pushes what row `v` should hold, in any order and with repeats, `v` itself included; rows
/// come out strictly ascending and without `v`.
///
/// Fails when the rows hold more than 32-bit offsets can count.
pub(crate) fn gather_rows<G>(n: usize, gather: G) -> Result<Csr, GraphError>
where
    G: Fn(u32, &mut Row<'_>) + Sync,
{
    let chunks = gather_chunks(n, gather);
    check_items("stored neighbors (two for each edge)", chunks.iter().map(|(_, items)| items.len()).sum())?;
    Ok(concatenate(n, &chunks))
}

/// [`gather_rows`] where no more is pushed than some structure already holds, so that it cannot fail.
pub(crate) fn regather_rows<G>(n: usize, gather: G) -> Csr
where
    G: Fn(u32, &mut Row<'_>) + Sync,
{
    concatenate(n, &gather_chunks(n, gather))
}

fn gather_chunks<G>(n: usize, gather: G) -> Vec<Chunk>
where
    G: Fn(u32, &mut Row<'_>) + Sync,
{
    let gather_chunk = |chunk| {
        let vertices = chunk * CHUNK..n.min((chunk + 1) * CHUNK);
        let mut lengths = Vec::with_capacity(vertices.len());
        let (mut items, mut filter) = (Vec::new(), Filter::new());
        for v in vertices {
            let (v, start) = (to_u32(v), items.len());
            gather(v, &mut Row { v, items: &mut items, filter: &mut filter });
            finish_row(&mut items, start);
            lengths.push(to_u32(items.len() - start));
        }
        (lengths, items)
    };
    (0..n.div_ceil(CHUNK)).into_par_iter().map(gather_chunk).collect()
}

fn concatenate(n: usize, chunks: &[Chunk]) -> Csr {
    let mut offsets = Vec::with_capacity(n + 1);
    offsets.push(0);
    let mut end = 0;
    for length in chunks.iter().flat_map(|(lengths, _)| lengths) {
        end += length;
        offsets.push(end);
    }

    let mut items = vec![0; end as usize];
    let mut rest = items.as_mut_slice();
    let mut targets = Vec::with_capacity(chunks.len());
    for (_, part) in chunks {
        let (target, after) = rest.split_at_mut(part.len());
        targets.push((target, part));
        rest = after;
    }
    targets.into_par_iter().for_each(|(target, part)| target.copy_from_slice(part));
    Csr::from_parts_unchecked(offsets, items)
}

/// Sorts what was pushed since `start` and drops what the filter let through twice.
fn finish_row(items: &mut Vec<u32>, start: usize) {
    items[start..].sort_unstable();
    let mut end = start;
    for i in start..items.len() {
        if i == start || items[i] != items[end - 1] {
            items[end] = items[i];
            end += 1;
        }
    }
    items.truncate(end);
}

/// A row being gathered.
pub(crate) struct Row<'a> {
    v: u32,
    items: &'a mut Vec<u32>,
    filter: &'a mut Filter,
}

impl Row<'_> {
    /// Adds a neighbor unless it is the vertex itself or was seen lately.
    #[inline]
    pub(crate) fn push(&mut self, neighbor: u32) {
        if neighbor != self.v && self.filter.is_news(self.v, neighbor) {
            self.items.push(neighbor);
        }
    }

    /// [`Row::push`] for each.
    #[inline]
    pub(crate) fn extend(&mut self, neighbors: &[u32]) {
        for &neighbor in neighbors {
            self.push(neighbor);
        }
    }
}

/// Remembers the pairs seen last, one to a slot, so that most repeats (a hinge cloth names each neighbor 3 or 4 times) are
/// dropped before the sort. It may forget, never invent.
struct Filter {
    seen: Box<[u64; Self::SLOTS]>,
}

impl Filter {
    const BITS: u32 = 8;
    const SLOTS: usize = 1 << Self::BITS;

    fn new() -> Self {
        // No pair is (MAX, MAX): a vertex is not its own neighbor.
        Self { seen: Box::new([u64::MAX; Self::SLOTS]) }
    }

    #[inline]
    fn is_news(&mut self, v: u32, neighbor: u32) -> bool {
        let pair = u64::from(v) << 32 | u64::from(neighbor);
        let slot = &mut self.seen[(neighbor.wrapping_mul(0x9E37_79B1) >> (32 - Self::BITS)) as usize];
        std::mem::replace(slot, pair) != pair
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_sorted_and_distinct_even_past_the_filter() {
        // 3,000 neighbors pushed twice, descending: far more than the filter holds.
        let rows = gather_rows(3001, |v, row| {
            if v == 0 {
                row.extend(&(0..3001).rev().collect::<Vec<_>>());
                row.extend(&(0..3001).rev().collect::<Vec<_>>());
            }
        })
        .unwrap();
        assert_eq!(rows.row(0), (1..3001).collect::<Vec<_>>());
        assert_eq!(rows.len(), 3000);
    }

    #[test]
    fn rows_cross_chunks() {
        let n = 2 * CHUNK + 3;
        let rows = gather_rows(n, |v, row| row.extend(&[v, v / 2])).unwrap();
        assert_eq!(rows.n_rows(), n);
        for v in 1..to_u32(n) {
            assert_eq!(rows.row(v), [v / 2]);
        }
    }
}
