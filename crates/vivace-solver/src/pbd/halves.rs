//! The particles cut into halves, again and again, so that threads may move those of their own constraints.
//!
//! A constraint belongs to the smallest stretch that holds all its particles. What belongs to the left half of a stretch and what belongs
//! to its right one touch different particles and may run at once; what belongs to the stretch itself follows. Where neighbors have near
//! numbers that is little. Stretches are numbered from the left half to the right half to the whole.

use glam::Vec4;
use vivace_kernels::constraint::{BATCH, Constraint, Xpbd};

/// Constraints of a color that are worth a stretch of their own.
const GRAIN: usize = 256;
/// 2³ threads find something to do; more stretches leave more remainders of fewer than four constraints.
const MOST_DEPTH: u32 = 3;

/// How often particles are cut.
#[derive(Debug, Clone, Copy)]
pub(super) struct Halves {
    n_particles: u32,
    depth: u32,
}

/// How many stretches a stretch that is cut so often has, itself among them.
fn n_stretches(depth: u32) -> u32 {
    (2 << depth) - 1
}

impl Halves {
    /// Of `n_particles`, for colors of so many constraints.
    pub(super) fn new(n_particles: u32, n_constraints: usize) -> Self {
        let depth = (n_constraints / GRAIN).checked_ilog2().unwrap_or(0).min(MOST_DEPTH);
        Self { n_particles, depth }
    }

    /// How many stretches there are.
    pub(super) fn len(self) -> u32 {
        n_stretches(self.depth)
    }

    /// The stretch of a constraint, and its first particle.
    pub(super) fn of(self, particles: &[u32]) -> (u32, u32) {
        let (mut start, mut end, mut depth, mut number) = (0, self.n_particles, self.depth, 0);
        while depth > 0 {
            let middle = start + (end - start) / 2;
            if particles.iter().all(|&p| p < middle) {
                end = middle;
            } else if particles.iter().all(|&p| p >= middle) {
                start = middle;
                number += n_stretches(depth - 1);
            } else {
                break;
            }
            depth -= 1;
        }
        (number + n_stretches(depth) - 1, start)
    }
}

/// The constraints of a color in a stretch, and the particles of the stretch.
#[derive(Debug)]
pub(super) struct Stretch<'a, C: Constraint<N, R>, const N: usize, const R: usize> {
    /// How often it is cut.
    depth: u32,
    /// Where the constraints of each stretch in it end, counted from the first of them all.
    ends: &'a [usize],
    first: usize,
    rest: &'a [C],
    /// Particles, by their place in the stretch of their constraint.
    places: &'a [[u32; N]],
    lambdas: &'a mut [C::Multiplier],
    q: &'a mut [Vec4],
}

impl<'a, C: Constraint<N, R>, const N: usize, const R: usize> Stretch<'a, C, N, R> {
    /// All particles and all constraints of a color.
    pub(super) fn whole(
        halves: Halves,
        first: usize,
        ends: &'a [usize],
        (rest, places): (&'a [C], &'a [[u32; N]]),
        lambdas: &'a mut [C::Multiplier],
        q: &'a mut [Vec4],
    ) -> Self {
        Self { depth: halves.depth, ends, first, rest, places, lambdas, q }
    }

    /// Projects all constraints, on up to 2^`forks` threads.
    pub(super) fn relax(self, xpbd: &Xpbd, forks: u32) {
        let Self { depth, ends, first, rest, places, lambdas, q } = self;
        if rest.is_empty() {
            return;
        }
        if depth == 0 {
            return relax(rest, places, xpbd, q, lambdas);
        }
        let half = n_stretches(depth - 1) as usize;
        let (n_left, n_both) = (ends[half - 1] - first, ends[2 * half - 1] - first);
        {
            let (left_q, right_q) = q.split_at_mut(q.len() / 2);
            let (left_lambdas, right_lambdas) = lambdas[..n_both].split_at_mut(n_left);
            let part = |range: std::ops::Range<usize>, ends, first, lambdas, q| Stretch::<C, N, R> {
                depth: depth - 1,
                ends,
                first,
                rest: &rest[range.clone()],
                places: &places[range],
                lambdas,
                q,
            };
            let left = part(0..n_left, &ends[..half], first, left_lambdas, left_q);
            let right = part(n_left..n_both, &ends[half..2 * half], first + n_left, right_lambdas, right_q);
            if forks > 0 && n_left.min(n_both - n_left) >= GRAIN / 2 {
                rayon::join(|| left.relax(xpbd, forks - 1), || right.relax(xpbd, forks - 1));
            } else {
                left.relax(xpbd, forks);
                right.relax(xpbd, forks);
            }
        }
        relax(&rest[n_both..], &places[n_both..], xpbd, q, &mut lambdas[n_both..]);
    }
}

/// Projects constraints that share no particle, four at a time.
fn relax<C: Constraint<N, R>, const N: usize, const R: usize>(
    rest: &[C],
    particles: &[[u32; N]],
    xpbd: &Xpbd,
    q: &mut [Vec4],
    lambdas: &mut [C::Multiplier],
) {
    let (some_rest, rest) = rest.as_chunks::<BATCH>();
    let (some_particles, particles) = particles.as_chunks();
    let (some_lambdas, lambdas) = lambdas.as_chunks_mut();
    for ((rest, particles), lambdas) in some_rest.iter().zip(some_particles).zip(some_lambdas) {
        if let Some(moves) = C::correct_batch(rest, particles, xpbd, q, lambdas) {
            for slot in 0..N {
                for (particles, step) in particles.iter().zip(moves[slot]) {
                    q[particles[slot] as usize] += step;
                }
            }
        } else {
            relax_each(rest, particles, xpbd, q, lambdas);
        }
    }
    relax_each(rest, particles, xpbd, q, lambdas);
}

/// Projects one constraint after another.
pub(super) fn relax_each<C: Constraint<N, R>, const N: usize, const R: usize>(
    rest: &[C],
    particles: &[[u32; N]],
    xpbd: &Xpbd,
    q: &mut [Vec4],
    lambdas: &mut [C::Multiplier],
) {
    for ((rest, particles), lambda) in rest.iter().zip(particles).zip(lambdas) {
        let moves = rest.correct(particles, xpbd, q, lambda);
        for (&particle, step) in particles.iter().zip(moves) {
            q[particle as usize] += step;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A constraint's stretch holds its particles, its halves do not, and the numbers go from left to right to whole.
    #[test]
    fn a_stretch_holds_its_constraints() {
        let halves = Halves { n_particles: 21, depth: 2 };
        assert_eq!(halves.len(), 7);
        // 0..5, 5..10, 0..10, 10..15, 15..21, 10..21, 0..21.
        for (particles, expected) in [
            ([0, 4], (0, 0)),
            ([9, 5], (1, 5)),
            ([4, 5], (2, 0)),
            ([10, 14], (3, 10)),
            ([20, 15], (4, 15)),
            ([14, 15], (5, 10)),
            ([9, 10], (6, 0)),
            ([20, 0], (6, 0)),
        ] {
            assert_eq!(halves.of(&particles), expected, "{particles:?}");
        }
        let few = Halves::new(21, 100);
        assert_eq!((few.len(), few.of(&[0, 20])), (1, (0, 0)));
    }
}
