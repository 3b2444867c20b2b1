//! Loops over all threads of the pool: what they write does not depend on how many there are.

/// Calls `f` for each item with its number, in pieces of up to `grain`.
pub(crate) fn for_each<T: Send>(items: &mut [T], grain: usize, f: &(impl Fn(usize, &mut T) + Sync)) {
    let grain = if rayon::current_num_threads() == 1 { usize::MAX } else { grain };
    halves(0, items, grain, f);
}

fn halves<T: Send>(first: usize, items: &mut [T], grain: usize, f: &(impl Fn(usize, &mut T) + Sync)) {
    if items.len() <= grain {
        items.iter_mut().enumerate().for_each(|(k, item)| f(first + k, item));
        return;
    }
    let middle = items.len() / 2;
    let (left, right) = items.split_at_mut(middle);
    rayon::join(|| halves(first, left, grain, f), || halves(first + middle, right, grain, f));
}

/// The part of `0..n` that piece `k` of `n_pieces` has.
pub(crate) fn piece(n: usize, k: usize, n_pieces: usize) -> std::ops::Range<usize> {
    n * k / n_pieces..n * (k + 1) / n_pieces
}
