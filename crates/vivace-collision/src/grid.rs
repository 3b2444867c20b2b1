//! Which boxes meet: a uniform grid, wrapped around, in levels.
//!
//! Boxes are sorted into cells by their centers, by counting (Teschner et al. 2003 hash cells; here a cell's number is its
//! coordinates modulo the size of the table, which keeps cells along x side by side and costs no more when something flies
//! off: what is taken for a neighbor across the seam fails the test of the boxes). A box lies on the first level whose cells
//! are as large as it; a search visits on each level the cells in which the center of a box that meets it may lie. So one box
//! of a thousand metres among small ones does not coarsen their cells.

use glam::Vec3;
use wide::f32x4;

use crate::boxes::{Aabb, ROUNDING};

/// Each level's cells are twice as large as those of the one before; the last takes all that is larger, in one cell.
const N_LEVELS: usize = 16;
/// Boxes that are looked at to choose the size of cells.
const N_SAMPLES: usize = 512;

/// Boxes, sorted.
#[derive(Default)]
pub(crate) struct Grid {
    levels: Vec<Level>,
    /// Where each cell's boxes start in `order`; one more than cells.
    starts: Vec<u32>,
    /// The numbers of the boxes, cell by cell.
    order: Vec<u32>,
    /// The boxes, in this order.
    bounds: Vec<[f32x4; 2]>,
    cells: Vec<u32>,
    levels_of: Vec<u8>,
    samples: Vec<f32>,
}

/// Cells of one size.
#[derive(Debug, Clone, Copy)]
struct Level {
    /// Edge of a cell \[m\].
    size: f32,
    inverse: f32,
    /// Cells along each axis of the table, less one: the axes have powers of two.
    mask: [usize; 3],
    /// Its first cell among all levels'.
    first: usize,
    /// Where its boxes end in `order`.
    end: usize,
}

impl Level {
    #[expect(clippy::cast_possible_truncation, reason = "cells beyond 32 bits saturate, in order")]
    fn cell(&self, point: Vec3) -> [i32; 3] {
        let floor = |x: f32| {
            let toward_zero = x as i32;
            toward_zero.saturating_sub(i32::from(x < toward_zero as f32))
        };
        let scaled = point * self.inverse;
        [floor(scaled.x), floor(scaled.y), floor(scaled.z)]
    }

    fn index(&self, cell: [i32; 3]) -> usize {
        let at = |k: usize| wrapped(cell[k], self.mask[k]);
        self.first + (at(2) * (self.mask[1] + 1) + at(1)) * (self.mask[0] + 1) + at(0)
    }

    /// First cell and number of cells of the table along one axis in which centers between `low` and `high` lie.
    fn span(&self, low: i32, high: i32, axis: usize) -> (usize, usize) {
        let mask = self.mask[axis];
        let beyond = high.abs_diff(low) as usize;
        if beyond >= mask { (0, mask + 1) } else { (wrapped(low, mask), beyond + 1) }
    }
}

/// A cell's coordinate in a table of `mask` + 1, a power of two.
#[expect(clippy::cast_sign_loss, reason = "two's complement is congruent")]
fn wrapped(cell: i32, mask: usize) -> usize {
    cell as usize & mask
}

impl Grid {
    /// Sorts `boxes`. Allocates only where there are more than ever before.
    #[expect(clippy::cast_possible_truncation, reason = "primitives are numbered in 32 bits")]
    pub(crate) fn build(&mut self, boxes: &[Aabb]) {
        self.choose_levels(boxes);
        let n_cells = self.levels.last().map_or(0, |last| last.first + table(last));
        self.starts.clear();
        self.starts.resize(n_cells + 1, 0);
        self.cells.clear();
        for (b, &level) in boxes.iter().zip(&self.levels_of) {
            let level = &self.levels[level as usize];
            let cell = level.index(level.cell(b.center()));
            self.starts[cell + 1] += 1;
            self.cells.push(cell as u32);
        }
        for cell in 0..n_cells {
            self.starts[cell + 1] += self.starts[cell];
        }
        self.order.clear();
        self.order.resize(boxes.len(), 0);
        // Each start moves to the next one's place, and all are moved back by one cell afterwards.
        for (idx, &cell) in self.cells.iter().enumerate() {
            let place = &mut self.starts[cell as usize];
            self.order[*place as usize] = idx as u32;
            *place += 1;
        }
        self.starts.copy_within(0..n_cells, 1);
        self.starts[0] = 0;
        self.copy_bounds(boxes);
    }

    fn choose_levels(&mut self, boxes: &[Aabb]) {
        self.samples.clear();
        let stride = boxes.len().div_ceil(N_SAMPLES).max(1);
        self.samples.extend(boxes.iter().step_by(stride).map(|b| b.extent()));
        // Almost all boxes on one level: each further one costs every search as much as the first.
        let smallest = if self.samples.is_empty() {
            1.0
        } else {
            let rank = self.samples.len() * 97 / 100;
            1.3 * *self.samples.select_nth_unstable_by(rank, f32::total_cmp).1
        }
        .max(f32::MIN_POSITIVE);

        let size = |level: usize| smallest * (1_u32 << level) as f32;
        let mut counts = [0_usize; N_LEVELS];
        let mut centers = [Aabb::EMPTY; N_LEVELS];
        self.levels_of.clear();
        for b in boxes {
            let extent = b.extent();
            let level = (0..N_LEVELS - 1).find(|&level| extent <= size(level)).unwrap_or(N_LEVELS - 1);
            counts[level] += 1;
            let center = b.center();
            centers[level] = centers[level].union(Aabb { min: center, max: center });
            #[expect(clippy::cast_possible_truncation, reason = "below 16")]
            self.levels_of.push(level as u8);
        }
        self.levels.clear();
        let (mut first, mut end, mut places) = (0, 0, [0; N_LEVELS]);
        for level in (0..N_LEVELS).filter(|&level| counts[level] > 0) {
            places[level] = self.levels.len();
            end += counts[level];
            let last = level == N_LEVELS - 1;
            let size = if last { f32::INFINITY } else { size(level) };
            let mask = if last { [0; 3] } else { masks(centers[level], size, counts[level]) };
            self.levels.push(Level { size, inverse: size.recip(), mask, first, end });
            first += table(&self.levels[self.levels.len() - 1]);
        }
        for level in &mut self.levels_of {
            #[expect(clippy::cast_possible_truncation, reason = "below 16")]
            let place = places[*level as usize] as u8;
            *level = place;
        }
    }

    fn copy_bounds(&mut self, boxes: &[Aabb]) {
        self.bounds.clear();
        self.bounds.extend(self.order.iter().map(|&idx| lanes(boxes[idx as usize])));
    }

    /// How many boxes there are.
    pub(crate) fn len(&self) -> usize {
        self.order.len()
    }

    /// The number of the box at `place` of the grid's order.
    pub(crate) fn at(&self, place: usize) -> usize {
        self.order[place] as usize
    }

    /// Calls `found` with each box that meets the one at `place` of the grid's order and comes later in it, so with each pair
    /// once if all places are asked.
    pub(crate) fn later_ones(&self, place: usize, mut found: impl FnMut(u32, u32)) {
        let [min, max] = self.bounds[place].map(|side| Vec3::from_slice(side.as_array()));
        let query = Aabb { min, max };
        let own = self.levels.partition_point(|level| level.end <= place);
        let this = self.order[place];
        self.search(query, own, place + 1, &mut |other| found(this, self.order[other]));
    }

    fn search(&self, query: Aabb, first_level: usize, after: usize, found: &mut impl FnMut(usize)) {
        let [min, max] = lanes(query);
        for level in &self.levels[first_level..] {
            let [low, high] = self.cells_around(level, query);
            let span = |k: usize| level.span(low[k], high[k], k);
            let [(x, nx), (y, ny), (z, nz)] = [span(0), span(1), span(2)];
            let [width, height, depth] = [level.mask[0] + 1, level.mask[1] + 1, level.mask[2] + 1];
            for k in 0..nz {
                for j in 0..ny {
                    let row = ((z + k) & (depth - 1)) * height + ((y + j) & (height - 1));
                    let row = level.first + row * width;
                    let mut run = |from: usize, to: usize| {
                        let start = (self.starts[row + from] as usize).max(after);
                        let end = self.starts[row + to] as usize;
                        let Some(boxes) = self.bounds.get(start..end) else { return };
                        for (k, [least, greatest]) in boxes.iter().enumerate() {
                            if (least.simd_le(max) & min.simd_le(*greatest)).all() {
                                found(start + k);
                            }
                        }
                    };
                    run(x, (x + nx).min(width));
                    if x + nx > width {
                        run(0, x + nx - width);
                    }
                }
            }
        }
    }

    /// Cells in which the center of a box of this level that meets `query` lies.
    fn cells_around(&self, level: &Level, query: Aabb) -> [[i32; 3]; 2] {
        if level.size.is_infinite() {
            return [[0; 3]; 2];
        }
        // Half a cell, and what rounding may take.
        let half = Vec3::splat(0.501 * level.size);
        let low = query.min - (half + ROUNDING * query.min.abs());
        let high = query.max + (half + ROUNDING * query.max.abs());
        [level.cell(low), level.cell(high)]
    }
}

/// A box as it is compared: the fourth lane always meets.
fn lanes(b: Aabb) -> [f32x4; 2] {
    [b.min, b.max].map(|v| f32x4::new([v.x, v.y, v.z, 0.0]))
}

/// How many cells the table of a level has.
fn table(level: &Level) -> usize {
    level.mask.iter().map(|mask| mask + 1).product()
}

/// The shape of a table for `n` boxes whose centers lie in `centers`: as the box is, but with at most about two cells a box.
fn masks(centers: Aabb, size: f32, n: usize) -> [usize; 3] {
    let extent = (centers.max - centers.min) / size;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates")]
    let mut bits =
        extent.to_array().map(|x| (x as u32).saturating_add(2).min(1 << 30).next_power_of_two().ilog2());
    let limit = n.next_power_of_two().ilog2();
    while bits.iter().sum::<u32>() > limit {
        let longest = (0..3).max_by_key(|&k| bits[k]).unwrap_or(0);
        bits[longest] -= 1;
    }
    bits.map(|bits| (1 << bits) - 1)
}
