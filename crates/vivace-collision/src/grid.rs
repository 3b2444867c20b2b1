//! Which boxes meet: a uniform grid, wrapped around, in levels.
//!
//! Boxes are sorted into cells by their centers, by counting (Teschner et al. 2003 hash cells; here a cell's number is its
//! coordinates modulo the size of the table, which keeps cells along x side by side and costs no more when something flies
//! off: what is taken for a neighbor across the seam fails the test of the boxes). A box lies on the first level whose cells
//! are as large as it; a search visits on each level the cells in which the center of a box that meets it may lie. So one box
//! of a thousand metres among small ones does not coarsen their cells.

use glam::Vec3;
use wide::f32x8;

use crate::boxes::Aabb;

/// Boxes tested at a time.
const LANES: usize = 8;
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
    /// Least x, y, z, then greatest x, y, z, in this order, and some that nothing meets.
    bounds: [Vec<f32>; 6],
    cells: Vec<u32>,
    levels_of: Vec<u8>,
    samples: Vec<f32>,
}

/// Cells of one size.
#[derive(Debug, Clone, Copy)]
struct Level {
    /// Edge of a cell \[m\].
    size: f32,
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
        (point / self.size).floor().to_array().map(|x| x as i32)
    }

    fn index(&self, cell: [i32; 3]) -> usize {
        let [x, y, z] = [0, 1, 2].map(|k| wrapped(cell[k], self.mask[k]));
        let [nx, ny] = [self.mask[0] + 1, self.mask[1] + 1];
        self.first + (z * ny + y) * nx + x
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
        let smallest = if self.samples.is_empty() {
            1.0
        } else {
            let rank = self.samples.len() * 3 / 4;
            *self.samples.select_nth_unstable_by(rank, f32::total_cmp).1
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
            self.levels.push(Level { size, mask, first, end });
            first += table(&self.levels[self.levels.len() - 1]);
        }
        for level in &mut self.levels_of {
            #[expect(clippy::cast_possible_truncation, reason = "below 16")]
            let place = places[*level as usize] as u8;
            *level = place;
        }
    }

    fn copy_bounds(&mut self, boxes: &[Aabb]) {
        let n_padded = boxes.len() + LANES;
        for (axis, bounds) in self.bounds.iter_mut().enumerate() {
            bounds.clear();
            let of = |b: &Aabb| if axis < 3 { b.min[axis] } else { b.max[axis - 3] };
            bounds.extend(self.order.iter().map(|&idx| of(&boxes[idx as usize])));
            bounds.resize(n_padded, f32::NAN);
        }
    }

    /// How many boxes there are.
    pub(crate) fn len(&self) -> usize {
        self.order.len()
    }

    /// Calls `found` with each box that meets `query`.
    pub(crate) fn meeting(&self, query: Aabb, mut found: impl FnMut(u32)) {
        self.search(query, 0, 0, &mut |place| found(self.order[place]));
    }

    /// Calls `found` with each box that meets the one at `place` of the grid's order and comes later in it, so with each pair
    /// once if all places are asked.
    pub(crate) fn later_ones(&self, place: usize, mut found: impl FnMut(u32, u32)) {
        let [x, y, z, x1, y1, z1] = [0, 1, 2, 3, 4, 5].map(|k| self.bounds[k][place]);
        let query = Aabb { min: Vec3::new(x, y, z), max: Vec3::new(x1, y1, z1) };
        let own = self.levels.partition_point(|level| level.end <= place);
        let this = self.order[place];
        self.search(query, own, place + 1, &mut |other| found(this, self.order[other]));
    }

    fn search(&self, query: Aabb, first_level: usize, after: usize, found: &mut impl FnMut(usize)) {
        let query8 = [query.max, query.min].map(|v| v.to_array().map(f32x8::splat));
        for level in &self.levels[first_level..] {
            let [low, high] = self.cells_around(level, query);
            let [(x, nx), (y, ny), (z, nz)] = [0, 1, 2].map(|k| level.span(low[k], high[k], k));
            let [width, height, depth] = level.mask.map(|mask| mask + 1);
            for k in 0..nz {
                for j in 0..ny {
                    let row = ((z + k) & (depth - 1)) * height + ((y + j) & (height - 1));
                    let row = level.first + row * width;
                    let mut run = |from: usize, to: usize| {
                        let start = (self.starts[row + from] as usize).max(after);
                        self.scan(start, self.starts[row + to] as usize, &query8, found);
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
        // Half a cell, and what rounding may add.
        let wider = Aabb::around(query.min, query.max, 0.501 * level.size);
        [level.cell(wider.min), level.cell(wider.max)]
    }

    fn scan(&self, start: usize, end: usize, query: &[[f32x8; 3]; 2], found: &mut impl FnMut(usize)) {
        let at = |k: usize, place: usize| {
            let lanes = self.bounds[k][place..].first_chunk::<LANES>();
            f32x8::new(*lanes.expect("padded"))
        };
        let [max, min] = query;
        let mut place = start;
        while place < end {
            let below =
                at(0, place).simd_le(max[0]) & at(1, place).simd_le(max[1]) & at(2, place).simd_le(max[2]);
            let above =
                at(3, place).simd_ge(min[0]) & at(4, place).simd_ge(min[1]) & at(5, place).simd_ge(min[2]);
            let mut bits = (below & above).to_bitmask();
            if end - place < LANES {
                bits &= (1 << (end - place)) - 1;
            }
            while bits != 0 {
                found(place + bits.trailing_zeros() as usize);
                bits &= bits - 1;
            }
            place += LANES;
        }
    }
}

/// How many cells the table of a level has.
fn table(level: &Level) -> usize {
    level.mask.iter().map(|mask| mask + 1).product()
}

/// The shape of a table for `n` boxes whose centers lie in `centers`: as the box is, but with at most about four cells a box.
fn masks(centers: Aabb, size: f32, n: usize) -> [usize; 3] {
    let extent = (centers.max - centers.min) / size;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates")]
    let mut bits =
        extent.to_array().map(|x| (x as u32).saturating_add(2).min(1 << 30).next_power_of_two().ilog2());
    let limit = (4 * n).next_power_of_two().ilog2();
    while bits.iter().sum::<u32>() > limit {
        let longest = (0..3).max_by_key(|&k| bits[k]).unwrap_or(0);
        bits[longest] -= 1;
    }
    bits.map(|bits| (1 << bits) - 1)
}
