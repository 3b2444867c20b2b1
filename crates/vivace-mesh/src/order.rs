//! Numbering for locality: vertices along a Morton curve, tetrahedra by their lowest vertex.

use glam::DVec3;

use crate::mesh::index32;

/// Drops the vertices that no tetrahedron uses and renumbers the rest along a Morton curve, tetrahedra by their lowest vertex.
/// Corners keep their order, so orientation stays.
pub(crate) fn renumber(positions: &[DVec3], tets: &mut [[u32; 4]]) -> Vec<DVec3> {
    let mut is_used = vec![false; positions.len()];
    tets.iter().flatten().for_each(|&v| is_used[v as usize] = true);
    let used = || positions.iter().zip(&is_used).filter(|(_, used)| **used).map(|(p, _)| *p);
    let low = used().fold(DVec3::INFINITY, DVec3::min);
    let high = used().fold(DVec3::NEG_INFINITY, DVec3::max);
    let extent = (high - low).max_element();

    let mut curve: Vec<(u64, u32)> = Vec::with_capacity(positions.len());
    for (vertex, position) in positions.iter().enumerate() {
        if is_used[vertex] {
            curve.push((morton((*position - low) / extent), index32(vertex)));
        }
    }
    curve.sort_unstable();

    let mut new_number = vec![0; positions.len()];
    for (new, &(_, old)) in curve.iter().enumerate() {
        new_number[old as usize] = index32(new);
    }
    for corner in tets.iter_mut().flatten() {
        *corner = new_number[*corner as usize];
    }
    tets.sort_unstable_by_key(|tet| (tet.iter().min().copied(), *tet));
    curve.iter().map(|&(_, old)| positions[old as usize]).collect()
}

/// The Morton code of a point of the unit cube: 21 bits of each coordinate, interleaved.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a float-to-integer cast saturates, and 21 bits of the result are kept"
)]
fn morton(unit: DVec3) -> u64 {
    const STEPS: f64 = ((1 << 21) - 1) as f64;
    let spread = |coordinate: f64| {
        // Each step doubles the gaps between groups of bits until single bits stand three apart.
        let mut bits = ((coordinate * STEPS) as u64).min(0x1f_ffff);
        for (shift, mask) in [
            (32, 0x001f_0000_0000_ffff),
            (16, 0x001f_0000_ff00_00ff),
            (8, 0x100f_00f0_0f00_f00f),
            (4, 0x10c3_0c30_c30c_30c3),
            (2, 0x1249_2492_4924_9249),
        ] {
            bits = (bits | bits << shift) & mask;
        }
        bits
    };
    spread(unit.x) | spread(unit.y) << 1 | spread(unit.z) << 2
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_interleave_bits() {
        assert_eq!(morton(DVec3::ZERO), 0);
        assert_eq!(morton(DVec3::ONE), u64::MAX >> 1);
        assert_eq!(morton(DVec3::X), 0x1249_2492_4924_9249);
        assert_eq!(morton(DVec3::Z), 0x4924_9249_2492_4924);
    }

    #[test]
    fn unused_vertices_go_and_corners_keep_their_order() {
        let positions = [DVec3::ONE, DVec3::splat(0.5), DVec3::ZERO, DVec3::X, DVec3::Y];
        let mut tets = [[0, 3, 4, 2]];
        let renumbered = renumber(&positions, &mut tets);
        assert_eq!(renumbered, [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE]);
        assert_eq!(tets, [[3, 1, 2, 0]]);
    }
}
