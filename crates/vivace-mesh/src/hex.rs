//! Hexahedra split into tetrahedra.

use crate::mesh::repeated;

/// The faces of a hexahedron whose corner number is x + 2·y + 4·z: each a cycle, counter-clockwise seen from outside.
const FACES: [[usize; 4]; 6] =
    [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];

/// The corners of a hexahedron in the order of this module, from the vertex at each corner of the unit cube.
pub(crate) fn corners(mut vertex: impl FnMut([usize; 3]) -> u32) -> [u32; 8] {
    [0, 1, 2, 3, 4, 5, 6, 7].map(|k| vertex([k & 1, k >> 1 & 1, k >> 2]))
}

/// Six tetrahedra that fill a hexahedron with the corners `x + 2·y + 4·z`, x, y, z in {0, 1}.
///
/// Each face is cut by the diagonal from its lowest vertex, so that neighbors agree on it whatever their own corner order: all
/// tetrahedra are cones from the lowest vertex to the triangles of the three faces without it. On a row-major grid these are
/// the six of Kuhn (1960), which share the main diagonal.
pub(crate) fn split(corners: [u32; 8]) -> impl Iterator<Item = [u32; 4]> {
    debug_assert!(repeated(&corners).is_none());
    let apex = corners.iter().copied().min().unwrap_or_default();
    let opposite = FACES.into_iter().map(move |f| f.map(|k| corners[k])).filter(move |f| !f.contains(&apex));
    opposite.flat_map(move |face| {
        let lowest = (0..4).min_by_key(|&k| face[k]).unwrap_or_default();
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| face[(lowest + k) % 4]);
        // Outward faces have the apex behind them, where a tetrahedron's first corner belongs.
        [[apex, a, b, c], [apex, a, c, d]]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::TetMesh;
    use glam::Vec3;

    #[test]
    fn any_numbering_fills_the_cube_with_positive_tetrahedra() {
        let numbering = |shift: u32, step: u32| [0, 1, 2, 3, 4, 5, 6, 7].map(|k| (shift + step * k) % 8);
        for (shift, step) in (0..8).flat_map(|shift| [1, 3, 5, 7].map(|step| (shift, step))) {
            let corners = numbering(shift, step);
            let mut positions = vec![Vec3::ZERO; 8];
            for (k, &v) in (0_u8..).zip(&corners) {
                positions[v as usize] = Vec3::new(f32::from(k & 1), f32::from(k >> 1 & 1), f32::from(k >> 2));
            }
            let mesh = TetMesh::new(positions, split(corners).collect()).unwrap();
            assert_eq!(mesh.tets().len(), 6);
            let report = mesh.report();
            assert!((report.volume - 1.0).abs() < 1e-12 && report.n_boundary_triangles == 12);
            assert!(report.has_manifold_boundary());
        }
    }

    #[test]
    fn neighbors_agree_on_their_diagonal_whatever_the_numbering() {
        // Powers of a primitive root of 13 number the twelve corners out of order.
        for (root, start) in
            [2_u32, 6, 7, 11].into_iter().flat_map(|root| (1..13).map(move |start| (root, start)))
        {
            let number = |x: usize, y: usize, z: usize| {
                (0..x + 3 * y + 6 * z).fold(start, |power, _| power * root % 13)
            };
            let mut positions = vec![Vec3::ZERO; 13];
            for (x, y, z) in (0..12).map(|k| (k % 3, k / 3 % 2, k / 6)) {
                positions[number(x, y, z) as usize] = Vec3::new(x as f32, y as f32, z as f32);
            }
            let tets = (0..2).flat_map(|i| split(corners(|[x, y, z]| number(i + x, y, z)))).collect();
            let report = TetMesh::new(positions, tets).unwrap().report();
            assert_eq!((report.n_tets, report.n_boundary_triangles), (12, 20), "{root} {start}");
            assert!(report.has_manifold_boundary() && (report.volume - 2.0).abs() < 1e-12);
        }
    }

    #[test]
    fn in_grid_order_all_six_share_the_main_diagonal() {
        assert!(split([0, 1, 2, 3, 4, 5, 6, 7]).all(|tet| tet.contains(&0) && tet.contains(&7)));
    }
}
