//! Smooth normals that keep sharp edges.

use glam::{DVec3, Vec3};

/// Cosine of the angle up to which neighboring triangles are shaded as one surface: the edges of a box stay sharp.
const CREASE: f64 = 0.5;

/// The positions of a triangle, if they all exist and are finite.
pub(super) fn corners(positions: &[Vec3], triangle: [u32; 3]) -> Option<[Vec3; 3]> {
    let mut found = [Vec3::ZERO; 3];
    for (place, vertex) in found.iter_mut().zip(triangle) {
        *place = *positions.get(vertex as usize)?;
    }
    found.iter().all(|position| position.is_finite()).then_some(found)
}

/// A unit normal for each corner of each triangle; zero where the triangle has none.
pub(super) fn smooth(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<[DVec3; 3]> {
    let areas: Vec<DVec3> = triangles
        .iter()
        .map(|&triangle| {
            corners(positions, triangle).map_or(DVec3::ZERO, |at| {
                let [a, b, c] = at.map(DVec3::from);
                (b - a).cross(c - a)
            })
        })
        .collect();
    let units: Vec<DVec3> = areas.iter().map(|area| area.normalize_or_zero()).collect();
    let mut around: Vec<Vec<usize>> = vec![Vec::new(); positions.len()];
    for (idx, triangle) in triangles.iter().enumerate() {
        for &vertex in triangle {
            if let Some(list) = around.get_mut(vertex as usize) {
                list.push(idx);
            }
        }
    }
    let at_corner = |idx: usize, vertex: u32| {
        let list = around.get(vertex as usize).map_or(&[][..], Vec::as_slice);
        let near = list.iter().filter(|&&other| units[other].dot(units[idx]) > CREASE);
        near.map(|&other| areas[other]).sum::<DVec3>().normalize_or(units[idx])
    };
    triangles
        .iter()
        .enumerate()
        .map(|(idx, triangle)| triangle.map(|vertex| at_corner(idx, vertex)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shallow_edges_are_smooth_and_steep_edges_sharp() {
        for (height, sharp) in [(0.3, false), (5.0, true)] {
            let positions = [
                Vec3::ZERO,
                Vec3::new(0.0, 0.0, 1.0),
                Vec3::new(1.0, -height, 0.5),
                Vec3::new(-1.0, -height, 0.5),
            ];
            let normals = smooth(&positions, &[[0, 1, 2], [1, 0, 3]]);
            assert_eq!(normals[0][0].abs_diff_eq(normals[1][1], 1e-9), !sharp, "{height}");
            assert!(normals[0][0].is_normalized() && normals[0][0].y > 0.0);
        }
    }

    #[test]
    fn what_has_no_normal_gets_zero() {
        let positions = [Vec3::ZERO, Vec3::X, Vec3::NAN, Vec3::splat(1e30)];
        let normals = smooth(&positions, &[[0, 1, 2], [0, 1, 1], [0, 1, 9], [0, 1, 3]]);
        assert_eq!(normals[..3], [[DVec3::ZERO; 3]; 3]);
        assert!(normals[3][2].is_normalized());
    }
}
