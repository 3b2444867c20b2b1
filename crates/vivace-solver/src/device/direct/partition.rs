//! The partitioned inverse of a sparse Cholesky factor (Alvarado, Pothen and Schreiber 1993): substitution in as many steps as the tree of
//! its supernodes is high.
//!
//! With L_ss the diagonal block of supernode s, forward substitution is x_s = L_ss⁻¹ b_s − Σ_d (L_ss⁻¹ L_sd) x_d over those below it
//! in the tree, backward z_s = L_ss⁻ᵀ x_s − Σ_a (L_ss⁻ᵀ L_asᵀ) z_a over those above. The products are made here, in `f64`, so that each
//! unknown is one sum, and all supernodes of a level go at once.

use std::ops::Range;

use faer::{Mat, MatRef};
use glam::Vec3;
use vivace_kernels::pd::{Row, SLICE, Tap};

use crate::SolverError;
use crate::cholesky::{Cholesky, Supernode};
use crate::error::narrow;

/// Which sums there are. Vectors b, x and z follow one another in one array, unknown by unknown in order of levels.
#[derive(Debug)]
pub(super) struct Partition {
    supernodes: Vec<Supernode>,
    /// Of each supernode, those that have rows below in its columns, and which of their rows these are.
    within: Vec<Vec<(usize, Range<usize>)>>,
    /// The unknowns of each level, from the leaves on.
    levels: Vec<Range<u32>>,
    /// Where each column of L is in this order.
    place: Vec<u32>,
    /// The row of Y that each unknown is of.
    pub(super) order: Vec<u32>,
    /// The sums: of each x, then of each z.
    pub(super) rows: Vec<Row>,
    /// Room for their entries.
    pub(super) n_taps: u32,
}

impl Partition {
    /// # Errors
    /// More entries than 32 bits can number.
    pub(super) fn new(cholesky: &Cholesky) -> Result<Self, SolverError> {
        let supernodes = cholesky.supernodes();
        let n = supernodes.last().map_or(0, |last| last.columns.end);
        let mut of_column = vec![0; n as usize];
        for (s, supernode) in supernodes.iter().enumerate() {
            supernode.columns.clone().for_each(|column| of_column[column as usize] = s);
        }
        let mut within = vec![Vec::new(); supernodes.len()];
        let mut heights = vec![0; supernodes.len()];
        for (d, supernode) in supernodes.iter().enumerate() {
            let mut first = 0;
            for rows in supernode.below.chunk_by(|&a, &b| of_column[a as usize] == of_column[b as usize]) {
                let s = of_column[rows[0] as usize];
                within[s].push((d, first..first + rows.len()));
                heights[s] = heights[s].max(heights[d] + 1);
                first += rows.len();
            }
        }
        let mut by_height: Vec<usize> = (0..supernodes.len()).collect();
        by_height.sort_by_key(|&s| heights[s]);
        let eliminated = cholesky.order();
        let (mut levels, mut place, mut order) = (Vec::new(), vec![0; n as usize], Vec::new());
        for level in by_height.chunk_by(|&a, &b| heights[a] == heights[b]) {
            let start = narrow("unknowns", order.len())?;
            for column in level.iter().flat_map(|&s| supernodes[s].columns.clone()) {
                place[column as usize] = narrow("unknowns", order.len())?;
                order.push(eliminated[column as usize]);
            }
            levels.push(start..narrow("unknowns", order.len())?);
        }
        let mut lengths = vec![0; 2 * n as usize];
        for (supernode, within) in supernodes.iter().zip(&within) {
            let columns = &supernode.columns;
            let before: usize = within.iter().map(|(d, _)| supernodes[*d].columns.len()).sum();
            for (i, column) in columns.clone().enumerate() {
                let at = place[column as usize] as usize;
                lengths[at] = i + 1 + before;
                lengths[n as usize + at] = columns.len() - i + supernode.below.len();
            }
        }
        let (rows, n_taps) = laid_out(&lengths)?;
        Ok(Self { supernodes, within, levels, place, order, rows, n_taps })
    }

    /// The elements of each level, in the order in which they are solved.
    pub(super) fn levels(&self) -> impl Iterator<Item = Range<u32>> {
        let n = self.n();
        let from = move |first: u32| move |level: &Range<u32>| first + level.start..first + level.end;
        self.levels.iter().map(from(n)).chain(self.levels.iter().rev().map(from(2 * n)))
    }

    /// Where the solution of each row of Y is.
    pub(super) fn solutions(&self) -> Vec<u32> {
        let mut places = vec![0; self.order.len()];
        for (place, &row) in (2 * self.n()..).zip(&self.order) {
            places[row as usize] = place;
        }
        places
    }

    fn n(&self) -> u32 {
        self.supernodes.last().map_or(0, |last| last.columns.end)
    }

    /// Writes the entries of all sums to `taps`, for the factor with these `blocks`.
    pub(super) fn invert(&self, blocks: &[MatRef<'_, f64>], taps: &mut [Tap]) {
        let n = self.n();
        for (s, supernode) in self.supernodes.iter().enumerate() {
            let (first, size) = (supernode.columns.start, supernode.columns.len());
            let inverse = inverse(blocks[s], size);
            for (i, column) in supernode.columns.clone().enumerate() {
                let at = self.place[column as usize];
                let mut forward = Entries::of(&self.rows[at as usize], taps);
                for j in 0..=i {
                    forward.push(self.place[first as usize + j], inverse[(i, j)]);
                }
                for (d, rows) in &self.within[s] {
                    let (below, block) = (&self.supernodes[*d], blocks[*d]);
                    let rows = || rows.clone().map(|k| (k, (below.below[k] - first) as usize));
                    for (c, column) in below.columns.clone().enumerate() {
                        let entry = |k: usize| block[(below.columns.len() + k, c)];
                        let product: f64 = rows().map(|(k, j)| inverse[(i, j)] * entry(k)).sum();
                        forward.push(n + self.place[column as usize], -product);
                    }
                }
                let mut backward = Entries::of(&self.rows[(n + at) as usize], taps);
                for j in i..size {
                    backward.push(n + self.place[first as usize + j], inverse[(j, i)]);
                }
                for (k, &row) in supernode.below.iter().enumerate() {
                    let product: f64 = (i..size).map(|j| inverse[(j, i)] * blocks[s][(size + k, j)]).sum();
                    backward.push(2 * n + self.place[row as usize], -product);
                }
            }
        }
    }

    /// Makes x \[N\] the solution \[m\] of `Y δ = x`, as a device does.
    pub(super) fn solve_in_place(&self, taps: &[Tap], x: &mut [Vec3]) {
        let n = self.n();
        let mut vectors: Vec<Vec3> = self.order.iter().map(|&row| x[row as usize]).collect();
        vectors.resize(3 * n as usize, Vec3::ZERO);
        for element in self.levels().flatten() {
            let row = &self.rows[(element - n) as usize];
            let entries = taps[row.first as usize..].iter().step_by(SLICE as usize).take(row.n as usize);
            vectors[element as usize] = entries.map(|tap| vectors[tap.column as usize] * tap.weight).sum();
        }
        for (place, &row) in (2 * n as usize..).zip(&self.order) {
            x[row as usize] = vectors[place];
        }
    }
}

/// Rows of so many entries, side by side in slices, and the room that these take.
fn laid_out(lengths: &[usize]) -> Result<(Vec<Row>, u32), SolverError> {
    let (mut rows, mut end) = (Vec::with_capacity(lengths.len()), 0);
    for slice in lengths.chunks(SLICE as usize) {
        for (lane, &length) in slice.iter().enumerate() {
            let [first, n] = [end + lane, length].map(|number| narrow("entries of the factor", number));
            rows.push(Row { first: first?, n: n?, ..Row::default() });
        }
        end += SLICE as usize * slice.iter().max().copied().unwrap_or(0);
    }
    Ok((rows, narrow("entries of the factor", end)?))
}

/// Of the lower triangle of the first `n` rows.
fn inverse(block: MatRef<'_, f64>, n: usize) -> Mat<f64> {
    let mut inverse = Mat::<f64>::identity(n, n);
    for column in 0..n {
        for i in column..n {
            let sum: f64 = (column..i).map(|k| block[(i, k)] * inverse[(k, column)]).sum();
            inverse[(i, column)] = (inverse[(i, column)] - sum) / block[(i, i)];
        }
    }
    inverse
}

/// The entries of a row, one after the other.
struct Entries<'a> {
    taps: &'a mut [Tap],
    next: usize,
}

impl<'a> Entries<'a> {
    fn of(row: &Row, taps: &'a mut [Tap]) -> Self {
        Self { taps, next: row.first as usize }
    }

    fn push(&mut self, column: u32, weight: f64) {
        #[expect(clippy::cast_possible_truncation, reason = "the factor is kept in f32")]
        let weight = weight as f32;
        self.taps[self.next] = Tap { column, weight };
        self.next += SLICE as usize;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pd::conjugate_gradient::tests::grid;
    use crate::pd::direct::{Factor, lower_triangle};
    use crate::pd::rows::Rows;

    /// Level by level it comes to what substitution column by column comes to, in few levels.
    #[test]
    fn solves_as_the_factor_does() {
        for size in [1, 2, 5, 40] {
            let (rows, anchor_weights, mut expected) = grid(size);
            let mut x = expected.clone();
            Factor::new(&rows, &anchor_weights).unwrap().solve_in_place(&mut expected);
            let (pattern, values) = lower_triangle(&rows, &anchor_weights);
            let mut cholesky = Cholesky::new(pattern, 3, None).unwrap();
            cholesky.factor(&values).unwrap();
            let partition = Partition::new(&cholesky).unwrap();
            let mut taps = vec![Tap::default(); partition.n_taps as usize];
            partition.invert(&cholesky.blocks(), &mut taps);
            partition.solve_in_place(&taps, &mut x);
            for (a, b) in x.iter().zip(&expected) {
                assert!(a.distance(*b) < 1e-5 * (1.0 + b.length()), "{a} {b}");
            }
            for level in partition.levels() {
                let rows = level.clone().map(|element| &partition.rows[(element - partition.n()) as usize]);
                let entries = rows.flat_map(|row| (0..row.n).map(|k| row.first + k * SLICE));
                // A level is solved at once: it knows nothing of itself, nor of what comes later.
                for column in entries.map(|entry| taps[entry as usize].column) {
                    assert!(column < level.start || column >= level.end);
                }
            }
            let mut solved: Vec<u32> = partition.levels().flatten().collect();
            solved.sort_unstable();
            let n = partition.n();
            assert!(solved.into_iter().eq(n..3 * n));
            assert!(partition.levels().count() < 2 * size + 2);
        }
    }

    #[test]
    fn no_unknowns_need_no_level() {
        let (pattern, _) = lower_triangle(&Rows { offsets: vec![0], ..Rows::default() }, &[]);
        let cholesky = Cholesky::new(pattern, 3, None);
        let partition = Partition::new(&cholesky.unwrap()).unwrap();
        assert_eq!((partition.levels().count(), partition.n_taps), (0, 0));
    }
}
