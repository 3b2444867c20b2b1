//! A list of element indices, ascending. Because it ascends, a piece of it owns a stretch of any array, and pieces can write to
//! their stretches at the same time without locks, atomics or `unsafe`.

use std::ops::Range;

/// Element indices in strictly ascending order.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct List {
    indices: Vec<u32>,
}

impl List {
    /// All indices below `len`.
    ///
    /// # Panics
    /// Where `len` does not fit 32 bits; graphs are checked for that when they are made.
    #[must_use]
    pub fn all(len: usize) -> Self {
        let len = u32::try_from(len).unwrap_or_else(|_| panic!("{len} elements: indices are 32-bit"));
        Self { indices: (0..len).collect() }
    }

    /// All indices in `range`.
    #[must_use]
    pub fn range(range: Range<u32>) -> Self {
        Self { indices: range.collect() }
    }

    /// The indices in any order, sorted and each once.
    #[must_use]
    pub fn from_unsorted(mut indices: Vec<u32>) -> Self {
        indices.sort_unstable();
        indices.dedup();
        Self { indices }
    }

    /// The indices, ascending.
    #[must_use]
    pub fn indices(&self) -> &[u32] {
        &self.indices
    }

    /// How many there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.indices.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.indices.is_empty()
    }

    /// Calls `f(i, &mut array[i])` for each index.
    pub(crate) fn for_each_element<T: Send>(
        &self,
        n_pieces: usize,
        array: &mut [T],
        f: impl Fn(u32, &mut T) + Sync,
    ) {
        pieces(&self.indices, n_pieces, array, 0, 0, &|_, indices, stretch, first| {
            for &i in indices {
                f(i, &mut stretch[i as usize - first]);
            }
        });
    }

    /// Writes `values[k]` to element `indices[k]`.
    pub(crate) fn scatter<T: Copy + Send + Sync>(&self, n_pieces: usize, values: &[T], array: &mut [T]) {
        pieces(&self.indices, n_pieces, array, 0, 0, &|start, indices, stretch, first| {
            for (&i, &value) in indices.iter().zip(&values[start..]) {
                stretch[i as usize - first] = value;
            }
        });
    }

    /// Removes the indices that `selects(i, &mut array[i])` and returns them; both keep their order.
    pub(crate) fn split_off<T: Send>(
        &mut self,
        n_pieces: usize,
        array: &mut [T],
        selects: impl Fn(u32, &mut T) -> bool + Sync,
    ) -> Self {
        if n_pieces == 1 {
            let (selected, n_kept) = split_piece(&mut self.indices, array, 0, &selects);
            self.indices.truncate(n_kept);
            return Self { indices: selected };
        }
        let piece_len = self.indices.len().div_ceil(n_pieces);
        let ends: Vec<usize> = self.indices.iter().step_by(piece_len).map(|&i| i as usize).skip(1).collect();
        let ends = ends.into_iter().chain([array.len()]);
        let mut parts = vec![(Vec::new(), 0); self.indices.len().div_ceil(piece_len)];
        rayon::scope(|scope| {
            let (mut rest, mut first) = (array, 0);
            for ((piece, part), end) in self.indices.chunks_mut(piece_len).zip(&mut parts).zip(ends) {
                let (stretch, after) = rest.split_at_mut(end - first);
                let selects = &selects;
                scope.spawn(move |_| *part = split_piece(piece, stretch, first, selects));
                (rest, first) = (after, end);
            }
        });
        let mut selected = Vec::with_capacity(parts.iter().map(|part| part.0.len()).sum());
        let mut n_kept = 0;
        for (k, part) in parts.iter().enumerate() {
            selected.extend_from_slice(&part.0);
            self.indices.copy_within(k * piece_len..k * piece_len + part.1, n_kept);
            n_kept += part.1;
        }
        self.indices.truncate(n_kept);
        Self { indices: selected }
    }
}

/// Takes what is selected out of `piece`; returns it, and how many are left at the front of `piece`. `stretch` begins at element
/// `first` of its array.
fn split_piece<T>(
    piece: &mut [u32],
    stretch: &mut [T],
    first: usize,
    selects: &impl Fn(u32, &mut T) -> bool,
) -> (Vec<u32>, usize) {
    let mut selected = Vec::new();
    let mut n_kept = 0;
    for k in 0..piece.len() {
        let i = piece[k];
        if selects(i, &mut stretch[i as usize - first]) {
            selected.push(i);
        } else {
            piece[n_kept] = i;
            n_kept += 1;
        }
    }
    (selected, n_kept)
}

/// Cuts `indices` into `n_pieces` and `array` into the stretches they own, and calls
/// `f(position of the piece in the list, piece, stretch, index of the stretch's first element)` for each, in parallel.
fn pieces<T: Send>(
    indices: &[u32],
    n_pieces: usize,
    array: &mut [T],
    start: usize,
    first: usize,
    f: &(impl Fn(usize, &[u32], &mut [T], usize) + Sync),
) {
    if n_pieces < 2 || indices.len() < 2 {
        return f(start, indices, array, first);
    }
    let middle = indices.len() / 2;
    let (left, right) = indices.split_at(middle);
    let boundary = right[0] as usize;
    let (left_array, right_array) = array.split_at_mut(boundary - first);
    rayon::join(
        || pieces(left, n_pieces / 2, left_array, start, first, f),
        || pieces(right, n_pieces - n_pieces / 2, right_array, start + middle, boundary, f),
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn splitting_keeps_order_whatever_the_pieces() {
        for n_pieces in [1, 2, 7, 64] {
            let mut list = List::all(1000);
            let mut seen = vec![false; 1000];
            let threes = list.split_off(n_pieces, &mut seen, |i, seen| {
                *seen = true;
                i % 3 == 0
            });
            assert!(seen.iter().all(|&seen| seen));
            assert_eq!(threes.indices(), (0..1000).step_by(3).collect::<Vec<_>>());
            assert_eq!(list.indices(), (0..1000).filter(|i| i % 3 != 0).collect::<Vec<_>>());
        }
    }

    #[test]
    fn scattering_touches_its_elements_only() {
        for n_pieces in [1, 2, 7, 64] {
            let list = List::from_unsorted(vec![9, 4, 4, 7, 0]);
            let mut array = vec![1; 11];
            list.scatter(n_pieces, &[10, 20, 30, 40], &mut array);
            assert_eq!(array, [10, 1, 1, 1, 20, 1, 1, 30, 1, 40, 1]);
            list.for_each_element(n_pieces, &mut array, |i, element| *element += i);
            assert_eq!(array, [10, 1, 1, 1, 24, 1, 1, 37, 1, 49, 1]);
        }
    }
}
