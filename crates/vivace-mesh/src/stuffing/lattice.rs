//! The body-centered cubic lattice: which of its points lie inside the shape.
//!
//! Two cubic lattices of one cell size, the second moved by half a cell along all axes. Points are kept in blocks of 4 x 4 x 4
//! cells with two points each, and only blocks near the shape are kept, so memory follows the shape and not its box.

use glam::{DVec3, IVec3};

use crate::MeshError;
use crate::mesh::index32;
use crate::sdf::{Bounds, SignedDistance};

/// Where a lattice point lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Side {
    /// The function is negative.
    Inside,
    /// The point was moved onto the surface.
    Surface,
    /// The function is zero or positive.
    Outside,
}

/// A lattice point: cell, and 0 for its corner, 1 for its center.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Site {
    pub(super) cell: IVec3,
    pub(super) sub: usize,
}

impl Site {
    /// Its coordinates in half cells.
    #[expect(clippy::cast_possible_truncation, clippy::cast_possible_wrap, reason = "0 or 1")]
    pub(super) fn halves(self) -> IVec3 {
        2 * self.cell + self.sub as i32
    }
}

/// Lattice points near a shape, numbered.
pub(super) struct Lattice {
    origin: DVec3,
    cell_size: f64,
    /// Blocks along each axis.
    blocks: IVec3,
    /// Kept block at a place in the box, or [`NONE`].
    kept_at: Vec<u32>,
    /// Place in the box of each kept block.
    place_of: Vec<usize>,
    side: Vec<Side>,
    /// How often the function was asked for a value.
    pub(super) n_values: usize,
}

const NONE: u32 = u32::MAX;
const BLOCK: i32 = 4;
const SITES: usize = 128;
/// Beyond this many blocks in the box, the table of blocks alone would take gigabytes.
const MAX_BLOCKS: f64 = (1_u64 << 28) as f64;

/// The way to the 14 neighbors of a site: 6 long edges (one cell), then 8 short ones (half a cell along each axis). Each is
/// the cell offset for a corner site, and, for the short ones, the neighbor is of the other kind; for a center site the
/// short offsets are one higher (see [`Lattice::neighbor`]).
const STEPS: [IVec3; 14] = [
    IVec3::NEG_X,
    IVec3::X,
    IVec3::NEG_Y,
    IVec3::Y,
    IVec3::NEG_Z,
    IVec3::Z,
    IVec3::new(-1, -1, -1),
    IVec3::new(0, -1, -1),
    IVec3::new(-1, 0, -1),
    IVec3::new(0, 0, -1),
    IVec3::new(-1, -1, 0),
    IVec3::new(0, -1, 0),
    IVec3::new(-1, 0, 0),
    IVec3::new(0, 0, 0),
];

impl Lattice {
    /// Sorts the lattice points of `shape` into inside and outside.
    ///
    /// # Errors
    /// Bounds that are no box, a value that is not finite, cells too small for the numbering, no point inside.
    pub(super) fn new(shape: &dyn SignedDistance, cell_size: f64) -> Result<Self, MeshError> {
        let bounds = shape.bounds();
        let blocks = count_blocks(bounds, cell_size)?;
        let n_places = [blocks.x, blocks.y, blocks.z].map(to_index).iter().product();
        let mut lattice = Self {
            origin: bounds.min,
            cell_size,
            blocks,
            kept_at: vec![NONE; n_places],
            place_of: Vec::new(),
            side: Vec::new(),
            n_values: 0,
        };
        let mut sides = [Side::Outside; SITES];
        for place in 0..n_places {
            lattice.evaluate(shape, place, &mut sides)?;
            if sides.contains(&Side::Inside) {
                lattice.keep(place, &sides)?;
            }
        }
        if lattice.place_of.is_empty() {
            return Err(MeshError::EmptyShape { cell_size });
        }
        lattice.keep_neighborhood()?;
        lattice.check_count()?;
        Ok(lattice)
    }

    /// Six tetrahedra come with each lattice point inside.
    fn check_count(&self) -> Result<(), MeshError> {
        let needed = 6.0 * self.side.iter().filter(|&&side| side == Side::Inside).count() as f64;
        let limit = f64::from(u32::MAX);
        if needed < limit {
            return Ok(());
        }
        Err(MeshError::CellTooFine { cell_size: self.cell_size, what: "tetrahedra", needed, limit })
    }

    /// How many points are kept.
    pub(super) fn len(&self) -> usize {
        self.side.len()
    }

    pub(super) fn side(&self, point: u32) -> Side {
        self.side[point as usize]
    }

    pub(super) fn set_side(&mut self, point: u32, side: Side) {
        self.side[point as usize] = side;
    }

    /// Where a lattice point lies before any warping \[m\].
    pub(super) fn position(&self, site: Site) -> DVec3 {
        let shift = if site.sub == 1 { 0.5 } else { 0.0 };
        self.origin + self.cell_size * (site.cell.as_dvec3() + shift)
    }

    /// The kept point at a site, if there is one. Points that are not kept lie outside.
    pub(super) fn point(&self, site: Site) -> Option<u32> {
        let cell = site.cell + BLOCK;
        let block = cell / BLOCK;
        if cell.min_element() < 0 || !block.cmplt(self.blocks).all() {
            return None;
        }
        let kept = self.kept_at[self.place(block)];
        if kept == NONE {
            return None;
        }
        let within = cell - block * BLOCK;
        let local = to_index(((within.z * BLOCK + within.y) * BLOCK + within.x) * 2) + site.sub;
        Some(index32(kept as usize * SITES + local))
    }

    /// The site of a kept point.
    pub(super) fn site(&self, point: u32) -> Site {
        let place = self.place_of[point as usize / SITES];
        site_in(self.block_at(place), point as usize % SITES)
    }

    /// The end of edge `step` (0..6 long, 6..14 short) of a site.
    pub(super) fn neighbor(site: Site, step: usize) -> Site {
        if step < 6 {
            return Site { cell: site.cell + STEPS[step], sub: site.sub };
        }
        if site.sub == 0 {
            Site { cell: site.cell + STEPS[step], sub: 1 }
        } else {
            Site { cell: site.cell + STEPS[step] + 1, sub: 0 }
        }
    }

    fn place(&self, block: IVec3) -> usize {
        (to_index(block.z) * to_index(self.blocks.y) + to_index(block.y)) * to_index(self.blocks.x)
            + to_index(block.x)
    }

    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_possible_wrap,
        reason = "each factor came from an i32"
    )]
    fn block_at(&self, place: usize) -> IVec3 {
        let (nx, ny) = (to_index(self.blocks.x), to_index(self.blocks.y));
        IVec3::new((place % nx) as i32, (place / nx % ny) as i32, (place / nx / ny) as i32)
    }

    fn evaluate(
        &mut self,
        shape: &dyn SignedDistance,
        place: usize,
        sides: &mut [Side; SITES],
    ) -> Result<(), MeshError> {
        let block = self.block_at(place);
        let first = site_in(block, 0).cell;
        // The points of a block span 3.5 cells along each axis.
        let half = 1.75 * self.cell_size;
        let center = self.position(Site { cell: first, sub: 0 }) + half;
        let (low, high) = shape.range(center, 1.001 * half * 3.0_f64.sqrt());
        if low > 0.0 || high < 0.0 {
            sides.fill(if low > 0.0 { Side::Outside } else { Side::Inside });
            return Ok(());
        }
        for (local, side) in sides.iter_mut().enumerate() {
            let value = finite_value(shape, self.position(site_in(block, local)))?;
            *side = if value < 0.0 { Side::Inside } else { Side::Outside };
        }
        self.n_values += SITES;
        Ok(())
    }

    fn keep(&mut self, place: usize, sides: &[Side; SITES]) -> Result<(), MeshError> {
        let kept = self.place_of.len();
        if (kept + 1) * SITES >= u32::MAX as usize {
            return Err(MeshError::CellTooFine {
                cell_size: self.cell_size,
                what: "lattice points (or more)",
                needed: ((kept + 1) * SITES) as f64,
                limit: f64::from(u32::MAX),
            });
        }
        self.kept_at[place] = index32(kept);
        self.place_of.push(place);
        self.side.extend_from_slice(sides);
        Ok(())
    }

    /// Keeps the blocks around those with inside points: the outside ends of cut edges need a number, too.
    fn keep_neighborhood(&mut self) -> Result<(), MeshError> {
        for index in 0..self.place_of.len() {
            let block = self.block_at(self.place_of[index]);
            for code in 0..27 {
                let near = block + IVec3::new(code % 3, code / 3 % 3, code / 9) - 1;
                if near.min_element() < 0 || !near.cmplt(self.blocks).all() {
                    continue;
                }
                let place = self.place(near);
                if self.kept_at[place] == NONE {
                    self.keep(place, &[Side::Outside; SITES])?;
                }
            }
        }
        Ok(())
    }
}

/// The value at a point, or the error that it is none.
pub(super) fn finite_value(shape: &dyn SignedDistance, point: DVec3) -> Result<f64, MeshError> {
    let value = shape.value(point);
    if value.is_finite() {
        Ok(value)
    } else {
        Err(MeshError::NonFiniteDistance { point: point.to_array(), value })
    }
}

/// Sites of a block in order: cell by cell (x fastest), corner before center. Block 0 begins one block before the origin.
#[expect(clippy::cast_possible_truncation, clippy::cast_possible_wrap, reason = "`local` is below 128")]
fn site_in(block: IVec3, local: usize) -> Site {
    let cell = (local / 2) as i32;
    let within = IVec3::new(cell % BLOCK, cell / BLOCK % BLOCK, cell / (BLOCK * BLOCK));
    Site { cell: (block - 1) * BLOCK + within, sub: local % 2 }
}

/// Blocks along each axis: the box, and one block more on either side.
fn count_blocks(bounds: Bounds, cell_size: f64) -> Result<IVec3, MeshError> {
    let blocks = (bounds.size() / (cell_size * f64::from(BLOCK))).floor() + 3.0;
    let needed = blocks.x * blocks.y * blocks.z;
    // Written so that NaN and infinity fail, too.
    if needed <= MAX_BLOCKS {
        return Ok(blocks.as_ivec3());
    }
    let per_block = SITES as f64;
    Err(MeshError::CellTooFine {
        cell_size,
        what: "lattice points in the shape's box",
        needed: needed * per_block,
        limit: MAX_BLOCKS * per_block,
    })
}

/// A coordinate that is known not to be negative.
fn to_index(coordinate: i32) -> usize {
    coordinate.unsigned_abs() as usize
}
