//! Makes a lattice-like tetrahedral mesh irregular, as meshes from scans and from Delaunay refinement are.
//!
//! Inside a stuffed shape every vertex has 14 neighbors, which makes a coloring too easy and a solver's errors too even. Here
//! vertices inside are moved a little, and faces and edges are flipped (2-3 and 3-2 flips), each only where all dihedral
//! angles stay within limits. Flips prefer to join vertices with a large random appetite, so that some become hubs.
//! The boundary keeps its vertices and its triangles.

mod complex;
mod shape;

use glam::DVec3;
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::{Rng, SeedableRng};

use crate::mesh::index32;
use crate::order::renumber;
use crate::{MeshError, TetMesh};
use complex::Complex;
use shape::Limits;

/// How irregular a mesh shall become.
///
/// ```
/// use vivace_mesh::irregularity::Irregularity;
/// use vivace_mesh::sdf::Sphere;
/// use vivace_mesh::stuffing::Stuffing;
///
/// let ball = Sphere { center: glam::DVec3::ZERO, radius: 1.0 };
/// let (regular, _) = Stuffing::with_cell_size(0.2).fill(&ball)?;
/// let (irregular, report) = Irregularity { seed: 7, ..Irregularity::default() }.apply(&regular)?;
/// assert!(report.n_face_flips > 0);
/// assert!(irregular.report().degrees.max > regular.report().degrees.max);
/// # Ok::<(), vivace_mesh::MeshError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Irregularity {
    /// From 0 (the mesh stays as it is) to 1: the share of all flips and of the longest move that are tried.
    pub strength: f64,
    /// One seed gives one mesh, bit for bit.
    pub seed: u64,
    /// No move and no flip makes a smaller dihedral angle than this \[deg\]; 0 to 60.
    pub min_dihedral: f64,
    /// No move and no flip makes a larger dihedral angle than this \[deg\]; 90 to 180.
    pub max_dihedral: f64,
}

/// What was done.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct IrregularityReport {
    /// Moves of vertices that were accepted.
    pub n_moves: usize,
    /// Faces replaced by edges (2-3 flips).
    pub n_face_flips: usize,
    /// Edges replaced by faces (3-2 flips).
    pub n_edge_flips: usize,
}

/// Rounds of one pass over all vertices and one over all tetrahedra.
const ROUNDS: usize = 10;
/// The longest move along each axis, as a share of the shortest edge at the vertex.
const LONGEST_MOVE: f64 = 0.4;
/// A move that is refused is tried again at half its length, this often.
const MOVE_TRIALS: usize = 3;
/// The chance of an edge flip against that of a face flip, so that the mean degree rises a little. Together with the rounds and the fourth power of the
/// appetites this gives, on a limbed shape of 10 thousand vertices, 55 thousand tetrahedra and a largest degree of 33 to 35.
const EDGE_FLIPS: f64 = 0.3;
/// The six edges of a tetrahedron, by its corners.
const EDGES: [[usize; 2]; 6] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];

impl Default for Irregularity {
    /// Full strength, seed 0, dihedral angles from 10 to 165 degrees.
    fn default() -> Self {
        Self { strength: 1.0, seed: 0, min_dihedral: 10.0, max_dihedral: 165.0 }
    }
}

impl Irregularity {
    /// Gives an irregular version of `mesh`; costs about 6 s for a million tetrahedra on one core.
    ///
    /// # Errors
    /// [`MeshError::Size`] for a setting outside its range; [`MeshError::NotAVolumeBoundary`] for a face of more than two
    /// tetrahedra.
    pub fn apply(&self, mesh: &TetMesh) -> Result<(TetMesh, IrregularityReport), MeshError> {
        self.check()?;
        let positions: Vec<DVec3> = mesh.positions().iter().map(|p| p.as_dvec3()).collect();
        let limits = Limits::new(self.min_dihedral, self.max_dihedral);
        let mut report = IrregularityReport::default();
        if self.strength == 0.0 || mesh.tets().is_empty() {
            return Ok((mesh.clone(), report));
        }
        let mut complex = Complex::new(positions, mesh.tets().to_vec(), limits)?;
        let on_boundary = complex.on_boundary();
        let mut random = Random(Pcg64Mcg::seed_from_u64(self.seed));
        let appetite: Vec<f64> = on_boundary.iter().map(|_| random.unit()).map(|u| u * u * u * u).collect();
        for _ in 0..ROUNDS {
            self.move_vertices(&mut complex, &on_boundary, &mut random, &mut report);
            self.flip(&mut complex, &appetite, &mut random, &mut report);
        }
        let mut tets: Vec<[u32; 4]> = complex.tets().collect();
        let positions = renumber(&complex.positions, &mut tets);
        Ok((TetMesh::new(positions.iter().map(|p| p.as_vec3()).collect(), tets)?, report))
    }

    fn check(&self) -> Result<(), MeshError> {
        for (what, value, range, need) in [
            ("the strength of the irregularity", self.strength, 0.0..=1.0, "from 0 to 1"),
            ("the smallest dihedral angle [deg]", self.min_dihedral, 0.0..=60.0, "from 0 to 60"),
            ("the largest dihedral angle [deg]", self.max_dihedral, 90.0..=180.0, "from 90 to 180"),
        ] {
            if !range.contains(&value) {
                return Err(MeshError::Size { what, value, need });
            }
        }
        Ok(())
    }

    /// Tries to move each vertex inside.
    fn move_vertices(
        &self,
        complex: &mut Complex,
        on_boundary: &[bool],
        random: &mut Random,
        report: &mut IrregularityReport,
    ) {
        let stars = Stars::of(complex);
        for vertex in 0..index32(complex.positions.len()) {
            let star = stars.around(vertex);
            if on_boundary[vertex as usize] || star.is_empty() {
                continue;
            }
            let old = complex.positions[vertex as usize];
            let shortest = star
                .iter()
                .flat_map(|tet| tet.iter().filter(|&&v| v != vertex))
                .map(|&v| complex.positions[v as usize].distance(old))
                .fold(f64::INFINITY, f64::min);
            let direction = DVec3::new(random.signed(), random.signed(), random.signed());
            let mut step = direction * (shortest * LONGEST_MOVE * self.strength);
            for _ in 0..MOVE_TRIALS {
                complex.positions[vertex as usize] = (old + step).as_vec3().as_dvec3();
                if star.iter().all(|&tet| complex.is_good(tet)) {
                    report.n_moves += 1;
                    break;
                }
                complex.positions[vertex as usize] = old;
                step *= 0.5;
            }
        }
    }

    /// Tries one face and one edge of each tetrahedron.
    fn flip(
        &self,
        complex: &mut Complex,
        appetite: &[f64],
        random: &mut Random,
        report: &mut IrregularityReport,
    ) {
        let hunger = |(p, q): (u32, u32)| appetite[p as usize].max(appetite[q as usize]);
        for slot in 0..index32(complex.n_slots()) {
            if complex.tet(slot).is_none() {
                continue;
            }
            let face = random.below(4);
            if complex
                .ends_across(slot, face)
                .is_some_and(|ends| random.unit() < self.strength * hunger(ends))
                && complex.flip_face(slot, face)
            {
                report.n_face_flips += 1;
            }
            let edge = EDGES[random.below(6)];
            if complex
                .ends_of(slot, edge)
                .is_some_and(|ends| random.unit() < self.strength * EDGE_FLIPS * (1.0 - hunger(ends)))
                && complex.flip_edge(slot, edge)
            {
                report.n_edge_flips += 1;
            }
        }
    }
}

/// The tetrahedra around each vertex, as they were when this was made.
struct Stars {
    start: Vec<usize>,
    tets: Vec<[u32; 4]>,
}

impl Stars {
    fn of(complex: &Complex) -> Self {
        let n_vertices = complex.positions.len();
        let mut start = vec![0; n_vertices + 1];
        complex.tets().flatten().for_each(|v| start[v as usize + 1] += 1);
        for vertex in 0..n_vertices {
            start[vertex + 1] += start[vertex];
        }
        let mut next = start.clone();
        let mut tets = vec![[0; 4]; start[n_vertices]];
        for tet in complex.tets() {
            for corner in tet {
                tets[next[corner as usize]] = tet;
                next[corner as usize] += 1;
            }
        }
        Self { start, tets }
    }

    fn around(&self, vertex: u32) -> &[[u32; 4]] {
        &self.tets[self.start[vertex as usize]..self.start[vertex as usize + 1]]
    }
}

/// Random numbers for one pass after the other.
struct Random(Pcg64Mcg);

impl Random {
    /// From 0 up to, not including, 1.
    fn unit(&mut self) -> f64 {
        f64::from(self.0.next_u32()) / (f64::from(u32::MAX) + 1.0)
    }

    /// From -1 up to 1.
    fn signed(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    /// 0 .. n, for small n.
    fn below(&mut self, n: u32) -> usize {
        ((u64::from(self.0.next_u32()) * u64::from(n)) >> 32) as usize
    }
}
