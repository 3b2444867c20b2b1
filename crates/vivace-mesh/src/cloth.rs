//! Rectangles of cloth in the xz plane, y up: every normal is +y, the first vertex lies in the origin.

use glam::Vec3;
use rand_pcg::Pcg32;
use rand_pcg::rand_core::{Rng, SeedableRng};
use spade::{DelaunayTriangulation, Point2, Triangulation};

use crate::mesh::index32;
use crate::size::{check_count, check_length, check_total};
use crate::{MeshError, TriMesh};

/// The largest jitter [1, in spacings]: neighbors stay a tenth of a spacing apart.
pub const MAX_JITTER: f32 = 0.45;

/// A grid of `width` × `height` vertices, each square cut by the same diagonal.
///
/// Vertex `j·width + i` lies at `(i, 0, j)·spacing` \[m\].
///
/// ```text
///     a ------ a+1         x →
///     |  \      |          z ↓
///    a+w --- a+w+1
/// ```
///
/// # Errors
/// [`MeshError::Size`] if a count is below 2 or above 2^20, or the spacing is below 10⁻¹² m, not finite, or makes the cloth
/// larger than [`MAX_COORDINATE`](crate::MAX_COORDINATE); [`MeshError::TooLarge`] if 32-bit indices do not suffice.
pub fn regular(width: usize, height: usize, spacing: f32) -> Result<TriMesh, MeshError> {
    grid(width, height, spacing, |_, _| true)
}

/// As [`regular`], but the diagonals of neighboring squares run differently, so that degrees alternate between 4 and 8.
///
/// # Errors
/// Those of [`regular`].
pub fn alternating(width: usize, height: usize, spacing: f32) -> Result<TriMesh, MeshError> {
    grid(width, height, spacing, |i, j| (i + j) % 2 == 0)
}

/// A jittered grid, Delaunay-triangulated: the irregular mesh that a cloth from a modelling tool has.
///
/// Vertices are numbered as in [`regular`]; each is moved uniformly by up to `jitter` spacings \[1\] in x and in z. Those of the
/// border move along it and the corners stay, so that the rectangle is kept. The same seed gives the same mesh. Triangles
/// ascend by their vertices, and each starts with its lowest.
///
/// # Errors
/// Those of [`regular`], and [`MeshError::Size`] for a jitter that is not between 0 and [`MAX_JITTER`];
/// [`MeshError::Delaunay`] if the triangulation fails.
pub fn irregular(
    width: usize,
    height: usize,
    spacing: f32,
    jitter: f32,
    seed: u64,
) -> Result<TriMesh, MeshError> {
    check_grid(width, height, spacing)?;
    if !(0.0..=MAX_JITTER).contains(&jitter) {
        let (what, need) = ("the jitter [spacings]", "between 0 and 0.45");
        return Err(MeshError::Size { what, value: f64::from(jitter), need });
    }
    let mut random = Pcg32::seed_from_u64(seed);
    // The draw comes before the test, so that a vertex's offset depends on its number alone.
    let mut moved = |i: usize, n: usize| {
        let offset = jitter * (2.0 * unit(&mut random) - 1.0);
        if i == 0 || i + 1 == n { i as f32 } else { i as f32 + offset }
    };
    let mut positions = Vec::with_capacity(width * height);
    for j in 0..height {
        for i in 0..width {
            let (x, z) = (moved(i, width), moved(j, height));
            positions.push(Vec3::new(x, 0.0, z) * spacing);
        }
    }
    let triangles = delaunay(&positions)?;
    TriMesh::new(positions, triangles)
}

fn check_grid(width: usize, height: usize, spacing: f32) -> Result<(), MeshError> {
    check_count("the number of vertices along the width", width, 2)?;
    check_count("the number of vertices along the height", height, 2)?;
    check_length("the spacing [m]", spacing, width.max(height))?;
    check_total("triangles", &[2, width, height])
}

fn grid(
    width: usize,
    height: usize,
    spacing: f32,
    is_main_diagonal: impl Fn(usize, usize) -> bool,
) -> Result<TriMesh, MeshError> {
    check_grid(width, height, spacing)?;
    let mut positions = Vec::with_capacity(width * height);
    let mut triangles = Vec::with_capacity(2 * (width - 1) * (height - 1));
    for j in 0..height {
        for i in 0..width {
            positions.push(Vec3::new(i as f32, 0.0, j as f32) * spacing);
            if i + 1 < width && j + 1 < height {
                let a = j * width + i;
                let [a, right, below, opposite] = [a, a + 1, a + width, a + width + 1].map(index32);
                triangles.extend(if is_main_diagonal(i, j) {
                    [[a, opposite, right], [a, below, opposite]]
                } else {
                    [[a, below, right], [right, below, opposite]]
                });
            }
        }
    }
    TriMesh::new(positions, triangles)
}

/// Uniform in [0, 1), 24 bits.
fn unit(random: &mut Pcg32) -> f32 {
    (random.next_u32() >> 8) as f32 / (1 << 24) as f32
}

/// Triangles with normals +y over points of the plane y = 0.
fn delaunay(positions: &[Vec3]) -> Result<Vec<[u32; 3]>, MeshError> {
    let failed = |reason: String| MeshError::Delaunay { reason };
    let points = positions.iter().map(|p| Point2::new(f64::from(p.x), f64::from(p.z))).collect();
    let triangulation =
        DelaunayTriangulation::<Point2<f64>>::bulk_load_stable(points).map_err(|e| failed(e.to_string()))?;
    if triangulation.num_vertices() != positions.len() {
        return Err(failed("two points coincide".to_owned()));
    }
    let upwards = |[a, b, c]: [u32; 3]| {
        // Counter-clockwise in (x, z) looks down.
        if b < a.min(c) {
            [b, a, c]
        } else if c < a {
            [c, b, a]
        } else {
            [a, c, b]
        }
    };
    let faces = triangulation.inner_faces().map(|face| face.vertices().map(|v| index32(v.fix().index())));
    let mut triangles: Vec<[u32; 3]> = faces.map(upwards).collect();
    triangles.sort_unstable();
    Ok(triangles)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::topology::distinct_edges;

    fn edges_of(triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
        let key = crate::topology::edge_key;
        distinct_edges(triangles.iter().flat_map(|&[a, b, c]| [key(a, b), key(b, c), key(c, a)]).collect())
    }

    fn normals_are_up(mesh: &TriMesh) -> bool {
        mesh.triangles().iter().all(|t| {
            let [a, b, c] = t.map(|v| mesh.positions()[v as usize]);
            let normal = (b - a).cross(c - a);
            normal.y > 0.0 && normal.x == 0.0 && normal.z == 0.0
        })
    }

    #[test]
    fn one_square() {
        let mesh = regular(2, 2, 0.5).unwrap();
        assert_eq!(mesh.positions()[3], Vec3::new(0.5, 0.0, 0.5));
        assert_eq!(mesh.edges(), edges_of(&[[0, 1, 3], [0, 3, 2]]));
        assert_eq!(mesh.hinges().len(), 1);
        assert!(normals_are_up(&mesh));
    }

    #[test]
    fn the_regular_grid_has_one_diagonal_everywhere() {
        let (w, h) = (5, 4);
        let mesh = regular(w, h, 1.0).unwrap();
        let mut expected = Vec::new();
        for a in (0..h - 1).flat_map(|j| (0..w - 1).map(move |i| j * w + i)) {
            let [a, right, opposite, below] = [a, a + 1, a + w + 1, a + w].map(index32);
            expected.extend([[a, right, opposite], [a, opposite, below]]);
        }
        assert_eq!(mesh.edges(), edges_of(&expected));
        assert_eq!(mesh.positions()[w + 2], Vec3::new(2.0, 0.0, 1.0));
        let report = mesh.report();
        assert_eq!((report.n_boundary_edges, report.euler_characteristic, report.degrees.max), (14, 1, 6));
        assert!(normals_are_up(&mesh) && report.is_manifold() && report.is_oriented());
    }

    #[test]
    fn alternating_diagonals_meet_in_every_second_vertex() {
        let mesh = alternating(5, 5, 1.0).unwrap();
        assert!(normals_are_up(&mesh) && mesh.report().is_oriented());
        let degrees = mesh.degrees();
        for (j, i) in (1..4).flat_map(|j| (1..4).map(move |i| (j, i))) {
            assert_eq!(degrees[j * 5 + i], if (i + j) % 2 == 0 { 8 } else { 4 }, "{i} {j}");
        }
        assert_eq!(mesh.report().n_edges, regular(5, 5, 1.0).unwrap().report().n_edges);
    }

    #[test]
    fn the_irregular_cloth_fills_its_rectangle() {
        let (w, h, spacing) = (40, 25, 0.02);
        for jitter in [0.0, 0.2, MAX_JITTER] {
            let mesh = irregular(w, h, spacing, jitter, 7).unwrap();
            let report = mesh.report();
            assert_eq!((report.n_vertices, report.n_triangles), (w * h, 2 * (w - 1) * (h - 1)));
            assert_eq!((report.n_boundary_edges, report.euler_characteristic), (2 * (w + h) - 4, 1));
            assert!(normals_are_up(&mesh) && report.is_manifold() && report.n_components == 1);
            assert!((report.area - 39.0 * 24.0 * 0.02 * 0.02).abs() < 1e-6);
            assert!(report.min_angle.unwrap() > 3.0, "{report:?}");
            let regular = regular(w, h, spacing).unwrap();
            let limit = (jitter + 1e-4) * spacing;
            for (p, q) in mesh.positions().iter().zip(regular.positions()) {
                assert!((p - q).abs().max_element() <= limit);
            }
            for corner in [0, w - 1, (h - 1) * w, h * w - 1] {
                assert_eq!(mesh.positions()[corner], regular.positions()[corner]);
            }
        }
    }

    #[test]
    fn no_point_lies_in_another_triangles_circle() {
        let mesh = irregular(12, 9, 1.0, 0.4, 3).unwrap();
        let at = |v: u32| mesh.positions()[v as usize].as_dvec3();
        for [e0, e1, o0, o1] in mesh.hinges() {
            // Delaunay locally, so Delaunay: the angles opposite to an edge add up to at most 180 degrees.
            let angle = |o: u32| (at(e0) - at(o)).angle_between(at(e1) - at(o)).to_degrees();
            assert!(angle(o0) + angle(o1) < 180.0 + 1e-3);
        }
    }

    #[test]
    fn the_seed_decides() {
        let cloth = |seed| irregular(20, 20, 1.0, 0.3, seed).unwrap();
        assert_eq!(cloth(1), cloth(1));
        assert_ne!(cloth(1), cloth(2));
        // Pinned, so that a mesh named by its seed in a figure stays the same mesh.
        assert_eq!(cloth(1).positions()[21], Vec3::new(0.914_905_4, 0.0, 1.172_474_1));
        assert!(cloth(1).report().degrees.deviation > 0.8);
    }

    #[test]
    fn impossible_cloths_are_refused() {
        for (w, h, spacing, jitter) in [
            (1, 5, 1.0, 0.1),
            (5, 0, 1.0, 0.1),
            (usize::MAX, 5, 1.0, 0.1),
            (5, 5, 0.0, 0.1),
            (5, 5, -0.0, 0.1),
            (5, 5, -1.0, 0.1),
            (5, 5, f32::NAN, 0.1),
            (5, 5, f32::INFINITY, 0.1),
            (5, 5, 1e-13, 0.1),
            (5, 5, 1e12, 0.1),
            (5, 5, 1.0, 0.5),
            (5, 5, 1.0, -0.1),
            (5, 5, 1.0, f32::NAN),
        ] {
            let error = irregular(w, h, spacing, jitter, 0).unwrap_err();
            assert!(matches!(error, MeshError::Size { .. }), "{w} {h} {spacing} {jitter}: {error}");
            if jitter == 0.1 {
                assert!(regular(w, h, spacing).is_err() && alternating(w, h, spacing).is_err());
            }
        }
        assert!(matches!(regular(1 << 20, 1 << 20, 1e-3), Err(MeshError::TooLarge { .. })));
    }
}
