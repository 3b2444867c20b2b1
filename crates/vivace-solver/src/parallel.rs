//! Loops over all threads of the pool whose results do not depend on how many there are.

use std::ops::Range;

/// Sums `f` over `range`: by halves, in a tree that depends on the range alone. Allocates nothing.
pub(crate) fn sum(range: Range<usize>, f: &(impl Fn(usize) -> f64 + Sync)) -> f64 {
    const PIECE: usize = 512;
    if range.len() <= PIECE {
        return range.map(f).sum();
    }
    let middle = range.start + range.len() / 2;
    let (left, right) = (range.start..middle, middle..range.end);
    let (left, right) = if rayon::current_num_threads() == 1 {
        (sum(left, f), sum(right, f))
    } else {
        rayon::join(|| sum(left, f), || sum(right, f))
    };
    left + right
}

/// What can be cut in two: mutable slices, and tuples of them that are cut at the same place.
pub(crate) trait Split: Send + Sized {
    /// How many elements there are.
    fn len(&self) -> usize;
    /// The first `at` elements, and the others.
    fn split(self, at: usize) -> (Self, Self);
}

impl<T: Send> Split for &mut [T] {
    fn len(&self) -> usize {
        <[T]>::len(self)
    }

    fn split(self, at: usize) -> (Self, Self) {
        self.split_at_mut(at)
    }
}

/// Elements that stay together: what is computed several at a time.
const UNIT: usize = 8;

/// Hands `out` to `f` in as many pieces as there are threads, each with the number of its first element; all but the last have at least
/// `grain` elements, a multiple of [`UNIT`].
pub(crate) fn in_pieces<S: Split>(first: usize, out: S, grain: usize, f: &(impl Fn(usize, S) + Sync)) {
    let even = out.len().div_ceil(rayon::current_num_threads());
    let piece = even.max(grain).next_multiple_of(UNIT);
    pieces_of(piece, first, out, f);
}

fn pieces_of<S: Split>(piece: usize, first: usize, out: S, f: &(impl Fn(usize, S) + Sync)) {
    if out.len() <= piece {
        return f(first, out);
    }
    let middle = (out.len().div_ceil(piece) / 2) * piece;
    let (left, right) = out.split(middle);
    rayon::join(|| pieces_of(piece, first, left, f), || pieces_of(piece, first + middle, right, f));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_and_pieces_are_the_same_on_any_number_of_threads() {
        let n = 10_000;
        let run = |n_threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
            pool.install(|| {
                let mut out = vec![0; n];
                in_pieces(7, out.as_mut_slice(), 64, &|first, piece: &mut [usize]| {
                    assert_eq!((first - 7) % UNIT, 0);
                    piece.iter_mut().enumerate().for_each(|(k, out)| *out = first + k);
                });
                (out, sum(0..n, &|i| 1.0 / (1.0 + i as f64)))
            })
        };
        let (out, total) = run(1);
        assert!(out.iter().enumerate().all(|(k, out)| *out == k + 7));
        assert!((total - 9.787_606).abs() < 1e-5, "{total}");
        for n_threads in [2, 3, 7] {
            assert_eq!(run(n_threads), (out.clone(), total));
        }
    }
}
