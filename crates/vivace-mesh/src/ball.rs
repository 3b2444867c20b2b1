//! Balls of tetrahedra: a rounded cube in the middle, and layers from its six faces out to the sphere.
//!
//! A cube mapped onto a ball as a whole flattens the cells along its edges (two of their faces come to lie in the sphere).
//! With layers around a core each cell has one face there at most, and all cells are well shaped.

use glam::DVec3;

use crate::mesh::index32;
use crate::size::{check_count, check_length, check_total};
use crate::{MeshError, TetMesh, hex};

/// Half the edge of the core over the radius: chosen for the best worst quality.
const CORE: f64 = 0.32;

/// How far the core's faces bulge from the cube (0) towards the sphere through its corners (1): as above.
const BULGE: f64 = 0.4;

/// A ball about the origin with a core of `n`³ cells and `ceil(n / 2)` layers around it; radius in metres.
///
/// It has `(n + 1)³ + ceil(n / 2)·(6·n² + 2)` vertices and `6·(n³ + 6·n²·ceil(n / 2))` tetrahedra (n = 14: about 12 thousand and 66
/// thousand). Every quality is above 0.3 and every dihedral angle between 20 and 130 degrees (n = 1: above 0.2, and 16 to 136).
///
/// # Errors
/// [`MeshError::Size`] if `n` is 0 or above 2^20, or the radius is not finite, below 10⁻¹² m or above
/// [`MAX_COORDINATE`](crate::MAX_COORDINATE); [`MeshError::TooLarge`] if 32-bit indices do not suffice; [`MeshError::TinyTet`] if the
/// radius is too small for `f32` volumes.
pub fn layered(n: usize, radius: f32) -> Result<TetMesh, MeshError> {
    check_count("the number of cells along the core", n, 1)?;
    check_length("the radius [m]", radius, 1)?;
    let layers = n.div_ceil(2);
    // A core of n cells and its layers on both sides: an upper bound of everything.
    check_total("tetrahedra", &[24, n, n, n])?;

    let lattice = Lattice::new(n);
    let n_core = (n + 1).pow(3);
    let n_shell = lattice.shell.len();
    let mut positions = Vec::with_capacity(n_core + layers * n_shell);
    for [i, j, k] in lattice.points() {
        positions.push(core_point(n, [i, j, k]));
    }
    for layer in 1..=layers {
        let share = layer as f64 / layers as f64;
        for &point in &lattice.shell {
            let inner = core_point(n, point);
            positions.push(inner.lerp(sphere_point(n, point), share));
        }
    }
    let positions = positions.into_iter().map(|p| (p * f64::from(radius)).as_vec3()).collect();

    let mut tets = Vec::new();
    for [i, j, k] in lattice.cells() {
        tets.extend(hex::split(hex::corners(|[x, y, z]| lattice.vertex([i + x, j + y, k + z]))));
    }
    let on_layer = |point: [usize; 3], layer: usize| match layer {
        0 => lattice.vertex(point),
        _ => index32(n_core + (layer - 1) * n_shell) + lattice.on_shell[lattice.vertex(point) as usize],
    };
    for quad in lattice.quads() {
        for layer in 0..layers {
            tets.extend(hex::split(hex::corners(|[x, y, z]| on_layer(quad[x + 2 * y], layer + z))));
        }
    }
    TetMesh::new(positions, tets)
}

/// A lattice point as a point of the cube [-1, 1]³, spread so that the lines through the centre are at equal angles.
fn cube_point(n: usize, point: [usize; 3]) -> DVec3 {
    let angle = |i: usize| (i as f64 / n as f64 - 0.5) * std::f64::consts::FRAC_PI_2;
    DVec3::from_array(point.map(|i| angle(i).tan()))
}

/// Where a lattice point of the cube's surface goes on the unit sphere.
fn sphere_point(n: usize, point: [usize; 3]) -> DVec3 {
    cube_point(n, point).normalize()
}

/// Where a lattice point goes in the core.
fn core_point(n: usize, point: [usize; 3]) -> DVec3 {
    let p = cube_point(n, point);
    let ball = if p == DVec3::ZERO { p } else { p.normalize() * p.abs().max_element() * 3f64.sqrt() };
    CORE * p.lerp(ball, BULGE)
}

/// A cube of n³ cells, and the points of its surface numbered on their own.
struct Lattice {
    n: usize,
    shell: Vec<[usize; 3]>,
    /// The number within `shell` of each lattice point that is there.
    on_shell: Vec<u32>,
}

impl Lattice {
    fn new(n: usize) -> Self {
        let mut lattice = Self { n, shell: Vec::new(), on_shell: vec![0; (n + 1).pow(3)] };
        for (vertex, point) in lattice.points().enumerate() {
            if point.iter().any(|&i| i == 0 || i == n) {
                lattice.on_shell[vertex] = index32(lattice.shell.len());
                lattice.shell.push(point);
            }
        }
        lattice
    }

    fn vertex(&self, [i, j, k]: [usize; 3]) -> u32 {
        index32((k * (self.n + 1) + j) * (self.n + 1) + i)
    }

    fn points(&self) -> impl Iterator<Item = [usize; 3]> + use<> {
        triples(self.n + 1)
    }

    fn cells(&self) -> impl Iterator<Item = [usize; 3]> + use<> {
        triples(self.n)
    }

    /// The corners `x + 2·y` of each square of the surface, such that x, y and outwards are right-handed.
    fn quads(&self) -> impl Iterator<Item = [[usize; 3]; 4]> + use<> {
        let n = self.n;
        let sides = (0..3).flat_map(|axis| [(axis, false), (axis, true)]);
        sides.flat_map(move |(axis, is_far)| {
            (0..n * n).map(move |square| {
                let (u, v) = (square % n, square / n);
                [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[x, y]| {
                    let (u, v) = if is_far { (u + x, v + y) } else { (u + y, v + x) };
                    let mut point = [if is_far { n } else { 0 }; 3];
                    point[(axis + 1) % 3] = u;
                    point[(axis + 2) % 3] = v;
                    point
                })
            })
        })
    }
}

/// All `[i, j, k]` below n, i running fastest.
fn triples(n: usize) -> impl Iterator<Item = [usize; 3]> {
    (0..n).flat_map(move |k| (0..n).flat_map(move |j| (0..n).map(move |i| [i, j, k])))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn balls_are_round_whole_and_well_shaped() {
        for n in [1, 2, 3, 6, 14, 25] {
            let mesh = layered(n, 2.0).unwrap();
            let report = mesh.report();
            let layers = n.div_ceil(2);
            assert_eq!(report.n_vertices, (n + 1).pow(3) + layers * (6 * n * n + 2));
            assert_eq!(report.n_tets, 6 * (n.pow(3) + 6 * n * n * layers));
            assert_eq!((report.n_components, report.n_isolated_vertices), (1, 0));
            assert_eq!((report.n_boundary_triangles, report.has_manifold_boundary()), (12 * n * n, true));
            let [worst, _] = report.quality.unwrap();
            let [low, high] = report.dihedral_angles.unwrap();
            let (quality, angles) = if n == 1 { (0.2, 16.0..136.0) } else { (0.3, 20.0..130.0) };
            assert!(worst > quality && angles.contains(&low) && angles.contains(&high));
            let (surface, _) = mesh.boundary_mesh().unwrap();
            assert!(surface.positions().iter().all(|p| (p.length() - 2.0).abs() < 1e-6));
            assert_eq!((surface.check_volume_boundary(), surface.report().euler_characteristic), (Ok(()), 2));
        }
    }

    #[test]
    fn the_volume_tends_to_that_of_a_ball() {
        let exact = 4.0 / 3.0 * std::f64::consts::PI;
        let missing = [4, 8].map(|n| exact - layered(n, 1.0).unwrap().report().volume);
        // Chords: the missing volume falls with the square of the cell size.
        assert!(missing[1] > 0.0 && (missing[0] / missing[1] - 4.0).abs() < 0.4, "{missing:?}");
    }

    #[test]
    fn impossible_balls_are_refused() {
        for (n, radius) in
            [(0, 1.0), (usize::MAX, 1.0), (1, 0.0), (1, -1.0), (1, f32::NAN), (1, f32::INFINITY), (1, 1e13)]
        {
            assert!(matches!(layered(n, radius), Err(MeshError::Size { .. })), "{n} {radius}");
        }
        assert!(matches!(layered(1 << 20, 1.0), Err(MeshError::TooLarge { .. })));
        assert!(matches!(layered(3, 1e-12), Err(MeshError::TinyTet { .. })));
    }
}
