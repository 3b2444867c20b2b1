//! Beams: boxes of cubes, each cube split into six tetrahedra.

use glam::Vec3;

use crate::mesh::index32;
use crate::size::{check_count, check_length, check_total};
use crate::{MeshError, TetMesh, hex};

/// A box of `cells` = `[nx, ny, nz]` cubes with edges of `spacing` \[m\], its lowest corner in the origin.
///
/// Vertex `(k·(ny + 1) + j)·(nx + 1) + i` lies at `spacing·(i, j, k)`; six tetrahedra per cube share its diagonal from the lowest
/// to the highest corner (Kuhn 1960), so that inner vertices have degree 14.
///
/// # Errors
/// [`MeshError::Size`] if a count is 0 or above 2^20, or the spacing is not finite, below 10⁻¹² m or makes the box larger than
/// [`MAX_COORDINATE`](crate::MAX_COORDINATE); [`MeshError::TooLarge`] if 32-bit indices do not suffice.
pub fn regular(cells: [usize; 3], spacing: f32) -> Result<TetMesh, MeshError> {
    for (n, what) in cells.iter().zip([
        "the number of cells along x",
        "the number of cells along y",
        "the number of cells along z",
    ]) {
        check_count(what, *n, 1)?;
    }
    let [nx, ny, nz] = cells;
    check_length("the spacing [m]", spacing, nx.max(ny).max(nz))?;
    check_total("vertices", &[nx + 1, ny + 1, nz + 1])?;
    check_total("tetrahedra", &[6, nx, ny, nz])?;

    let vertex = |i: usize, j: usize, k: usize| index32((k * (ny + 1) + j) * (nx + 1) + i);
    let mut positions = Vec::with_capacity((nx + 1) * (ny + 1) * (nz + 1));
    for (k, j, i) in grid(nz + 1, ny + 1, nx + 1) {
        positions.push(Vec3::new(i as f32, j as f32, k as f32) * spacing);
    }
    let mut tets = Vec::with_capacity(6 * nx * ny * nz);
    for (k, j, i) in grid(nz, ny, nx) {
        tets.extend(hex::split(hex::corners(|[x, y, z]| vertex(i + x, j + y, k + z))));
    }
    TetMesh::new(positions, tets)
}

/// All triples below the counts, the last running fastest.
fn grid(n0: usize, n1: usize, n2: usize) -> impl Iterator<Item = (usize, usize, usize)> {
    (0..n0).flat_map(move |a| (0..n1).flat_map(move |b| (0..n2).map(move |c| (a, b, c))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_cube() {
        let mesh = regular([1, 1, 1], 2.0).unwrap();
        assert_eq!((mesh.positions().len(), mesh.tets().len()), (8, 6));
        let report = mesh.report();
        assert_eq!((report.n_edges, report.n_boundary_triangles), (19, 12));
        assert!((report.volume - 8.0).abs() < 1e-12);
    }

    #[test]
    fn a_beam_fits_together() {
        let mesh = regular([5, 3, 2], 0.1).unwrap();
        let report = mesh.report();
        assert_eq!((report.n_vertices, report.n_tets), (6 * 4 * 3, 6 * 30));
        assert_eq!(report.n_boundary_triangles, 4 * (5 * 3 + 3 * 2 + 2 * 5));
        assert!(report.has_manifold_boundary() && report.n_components == 1);
        assert!((report.volume - 0.030).abs() < 1e-8);
        assert_eq!(regular([4, 4, 4], 1.0).unwrap().report().degrees.max, 14);
    }

    #[test]
    fn impossible_beams_are_refused() {
        for (cells, spacing) in [
            ([0, 1, 1], 1.0),
            ([1, 1, 0], 1.0),
            ([1, usize::MAX, 1], 1.0),
            ([1, 1, 1], 0.0),
            ([1, 1, 1], -1.0),
            ([1, 1, 1], 1e-13),
            ([1, 1, 1], f32::NAN),
            ([1, 1, 1], f32::INFINITY),
            ([1000, 1, 1], 1e11),
        ] {
            let error = regular(cells, spacing).unwrap_err();
            assert!(matches!(error, MeshError::Size { .. }), "{cells:?} {spacing}: {error}");
        }
        assert!(matches!(regular([1 << 20; 3], 1.0), Err(MeshError::TooLarge { .. })));
        assert!(regular([1, 1, 1], 1e-12).is_ok());
    }
}
