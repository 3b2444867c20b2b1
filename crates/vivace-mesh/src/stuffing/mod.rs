//! Isosurface stuffing: tetrahedra of good shape inside a signed distance function, at any resolution.
//!
//! F. Labelle and J. R. Shewchuk, *Isosurface Stuffing: Fast Tetrahedral Meshes with Good Dihedral Angles*, SIGGRAPH 2007, in
//! its uniform form: (1) sample the function on a body-centered cubic lattice, (2) find where it cuts the edges, (3) move
//! lattice points onto cut points that are too close, (4) fill each lattice tetrahedron from a stencil. The paper bounds all
//! dihedral angles by 10.7 and 164.8 degrees. Here that bound is measured, not proven: warped corners can leave smaller
//! angles, and those are lifted afterwards (see `lift.rs`, which has the numbers). Added, too, are the repair to a manifold,
//! the choice of one component and a numbering for locality.

mod lattice;
mod lift;
mod repair;
mod stencil;
mod target;
mod warp;

use std::collections::HashMap;

use glam::{DVec3, IVec3};

pub use repair::Repairs;

use crate::irregularity::{Irregularity, IrregularityReport};
use crate::mesh::index32;
use crate::order::renumber;
use crate::sdf::SignedDistance;
use crate::{MeshError, TetMesh};
use lattice::{Lattice, Side, Site};
use stencil::{Corners, Stencil};
use warp::Cuts;

/// How a shape is to be filled with tetrahedra.
///
/// ```
/// use vivace_mesh::sdf::Sphere;
/// use vivace_mesh::stuffing::Stuffing;
///
/// let ball = Sphere { center: glam::DVec3::ZERO, radius: 1.0 };
/// let (mesh, report) = Stuffing::with_cell_size(0.25).fill(&ball)?;
/// assert!(mesh.tets().len() > 1_000);
/// assert!(report.dropped.is_empty());
/// # Ok::<(), vivace_mesh::MeshError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stuffing {
    resolution: Resolution,
    irregularity: Option<Irregularity>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Resolution {
    CellSize(f64),
    AboutTets(usize),
    AboutVertices(usize),
}

/// What the filling did.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct StuffingReport {
    /// Edge length of the lattice's cubes \[m\]; tetrahedra inside have edges of 1 and 0.87 of it.
    pub cell_size: f64,
    /// How many values of the function were asked for, all trials together.
    pub n_values: usize,
    /// How many cell sizes were tried to come close to the wanted number.
    pub n_trials: usize,
    /// What was cut back to make the boundary a manifold.
    pub repairs: Repairs,
    /// Inner vertices moved to lift the dihedral angles that warping left below 12 degrees.
    pub n_lifted: usize,
    /// Numbers of tetrahedra of the components left out, largest first: the mesh is the largest component.
    pub dropped: Vec<usize>,
    /// What [`Stuffing::with_irregularity`] did.
    pub irregularity: Option<IrregularityReport>,
}

impl Stuffing {
    /// Cells of a given edge length \[m\]. Costs memory and time in proportion to the inverse cube of it.
    pub fn with_cell_size(cell_size: f64) -> Self {
        Self { resolution: Resolution::CellSize(cell_size), irregularity: None }
    }

    /// Cells such that there are about so many tetrahedra: the cell size is searched for until the number is within 2 %, or as
    /// near as it got in a few trials.
    pub fn with_about_tets(n_tets: usize) -> Self {
        Self { resolution: Resolution::AboutTets(n_tets), irregularity: None }
    }

    /// As [`Stuffing::with_about_tets`], for the number of vertices.
    pub fn with_about_vertices(n_vertices: usize) -> Self {
        Self { resolution: Resolution::AboutVertices(n_vertices), irregularity: None }
    }

    /// Makes the mesh irregular afterwards; wanted numbers are those of the irregular mesh.
    #[must_use]
    pub fn with_irregularity(self, irregularity: Irregularity) -> Self {
        Self { irregularity: Some(irregularity), ..self }
    }

    /// Fills the inside of `shape`.
    ///
    /// The mesh is one component with a manifold boundary, its tetrahedra positively oriented. One shape and one setting give
    /// one mesh, bit for bit.
    ///
    /// # Errors
    /// - [`MeshError::Size`]: a cell size that is not positive, a wanted number of zero, a setting of the irregularity;
    /// - [`MeshError::BadBounds`], [`MeshError::NonFiniteDistance`]: the function is not usable;
    /// - [`MeshError::EmptyShape`]: no lattice point inside, or nothing left after the repair;
    /// - [`MeshError::CellTooFine`], [`MeshError::CellBelowPrecision`], [`MeshError::TooLarge`]: beyond 32-bit indices or coordinates.
    pub fn fill(&self, shape: &dyn SignedDistance) -> Result<(TetMesh, StuffingReport), MeshError> {
        let bounds = shape.bounds();
        bounds.check()?;
        let extent = bounds.size().max_element();
        let fill = |cell_size| self.fill_with(shape, cell_size);
        match self.resolution {
            Resolution::CellSize(cell_size) => fill(cell_size),
            Resolution::AboutTets(wanted) => target::search(extent, wanted, fill, |mesh| mesh.tets().len()),
            Resolution::AboutVertices(wanted) => {
                target::search(extent, wanted, fill, |mesh| mesh.positions().len())
            }
        }
    }

    fn fill_with(
        &self,
        shape: &dyn SignedDistance,
        cell_size: f64,
    ) -> Result<(TetMesh, StuffingReport), MeshError> {
        let (mesh, report) = fill_cells(shape, cell_size)?;
        let Some(irregularity) = self.irregularity else { return Ok((mesh, report)) };
        let (mesh, changed) = irregularity.apply(&mesh)?;
        Ok((mesh, StuffingReport { irregularity: Some(changed), ..report }))
    }
}

/// Fills a shape with cells of one size.
fn fill_cells(shape: &dyn SignedDistance, cell_size: f64) -> Result<(TetMesh, StuffingReport), MeshError> {
    check_cell_size(shape, cell_size)?;
    let mut lattice = Lattice::new(shape, cell_size)?;
    let cuts = warp::warp(shape, &mut lattice)?;
    let n_values = lattice.n_values + cuts.n_values;

    let mut filling = Filling::new(&lattice, cuts);
    filling.fill();
    let Filling { mut positions, on_surface, mut tets, .. } = filling;
    let repairs = repair::make_manifold(&mut tets, on_surface.clone());
    let dropped = repair::keep_largest_component(&mut tets, positions.len());
    if tets.is_empty() {
        return Err(MeshError::EmptyShape { cell_size });
    }
    let n_lifted = lift::lift(&mut positions, &tets, &on_surface, cell_size);
    let positions = renumber(&positions, &mut tets);
    let mesh = TetMesh::new(positions.iter().map(|p| p.as_vec3()).collect(), tets)?;
    Ok((
        mesh,
        StuffingReport { cell_size, n_values, n_trials: 1, repairs, n_lifted, dropped, irregularity: None },
    ))
}

/// `f32` coordinates must resolve a cell well enough for its angles: a thousandth of it.
fn check_cell_size(shape: &dyn SignedDistance, cell_size: f64) -> Result<(), MeshError> {
    if !(cell_size > 0.0 && cell_size.is_finite()) {
        return Err(MeshError::Size {
            what: "the cell size [m]",
            value: cell_size,
            need: "positive and finite",
        });
    }
    let bounds = shape.bounds();
    let coordinate = bounds.min.abs().max(bounds.max.abs()).max_element();
    if cell_size < coordinate / 16_384.0 {
        return Err(MeshError::CellBelowPrecision { cell_size, coordinate });
    }
    Ok(())
}

/// The mesh under construction: vertices are numbered when a tetrahedron first needs them.
struct Filling<'a> {
    lattice: &'a Lattice,
    cuts: Cuts,
    positions: Vec<DVec3>,
    on_surface: Vec<bool>,
    tets: Vec<[u32; 4]>,
    /// Mesh vertex of each lattice point, or [`NONE`].
    vertex_of: Vec<u32>,
    cut_vertex: HashMap<(u32, u32), u32>,
    /// Lattice points at the corners of the tetrahedron in work.
    points: [u32; 4],
}

const NONE: u32 = u32::MAX;

impl<'a> Filling<'a> {
    fn new(lattice: &'a Lattice, cuts: Cuts) -> Self {
        Self {
            lattice,
            cuts,
            positions: Vec::new(),
            on_surface: Vec::new(),
            tets: Vec::new(),
            vertex_of: vec![NONE; lattice.len()],
            cut_vertex: HashMap::new(),
            points: [NONE; 4],
        }
    }

    fn fill(&mut self) {
        for point in 0..index32(self.lattice.len()) {
            let site = self.lattice.site(point);
            if site.sub == 0 {
                self.fill_around(point, site.cell);
            }
        }
    }

    /// The 12 lattice tetrahedra on the three long edges that leave a cell's corner in positive direction. Around each edge,
    /// the centers of the four cells that share it form a ring, and each two in turn complete a tetrahedron.
    fn fill_around(&mut self, corner: u32, cell: IVec3) {
        let centers: [Option<u32>; 8] = std::array::from_fn(|code| {
            let behind = [1, 2, 4].map(|bit| i32::from(code & bit != 0));
            self.lattice.point(Site { cell: cell - IVec3::from_array(behind), sub: 1 })
        });
        for axis in 0..3 {
            let mut next_cell = cell;
            next_cell[axis] += 1;
            let Some(next) = self.lattice.point(Site { cell: next_cell, sub: 0 }) else { continue };
            let (second, third) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
            // Counter-clockwise around the axis.
            let ring = [second | third, third, 0, second].map(|code: usize| centers[code]);
            for turn in 0..4 {
                let (Some(one), Some(other)) = (ring[turn], ring[(turn + 1) % 4]) else { continue };
                self.fill_tet([corner, next, one, other]);
            }
        }
    }

    fn fill_tet(&mut self, points: [u32; 4]) {
        let sides = points.map(|point| self.lattice.side(point));
        if sides.contains(&Side::Inside) {
            self.points = points;
            let [first, _, third, _] = points.map(|point| self.lattice.site(point).halves());
            let is_even = first.cmpgt(third).bitmask().count_ones() % 2 == 0;
            Stencil { sides, is_even }.fill(self);
        }
    }

    fn add_vertex(&mut self, position: DVec3, on_surface: bool) -> u32 {
        self.positions.push(position);
        self.on_surface.push(on_surface);
        index32(self.positions.len() - 1)
    }
}

impl Corners for Filling<'_> {
    fn corner(&mut self, corner: usize) -> u32 {
        let point = self.points[corner];
        if self.vertex_of[point as usize] == NONE {
            self.vertex_of[point as usize] = match self.cuts.warped.get(&point) {
                Some(&position) => self.add_vertex(position, true),
                None => self.add_vertex(self.lattice.position(self.lattice.site(point)), false),
            };
        }
        self.vertex_of[point as usize]
    }

    fn cut(&mut self, inside: usize, outside: usize) -> u32 {
        let edge = (self.points[inside], self.points[outside]);
        if let Some(&vertex) = self.cut_vertex.get(&edge) {
            return vertex;
        }
        let vertex = self.add_vertex(self.cuts.on_edge[&edge], true);
        self.cut_vertex.insert(edge, vertex);
        vertex
    }

    fn put(&mut self, tet: [u32; 4]) {
        self.tets.push(tet);
    }
}
