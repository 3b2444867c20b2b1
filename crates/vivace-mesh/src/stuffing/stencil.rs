//! The stencils: how the part of one lattice tetrahedron inside the surface is cut into tetrahedra
//! (Labelle and Shewchuk 2007, step 4 and Figure 3).
//!
//! Corners are numbered so that edges 01 and 23 are long (along axes) and the other four short. Where an outside corner `d`
//! is cut off a face with inside corners `a` and `b`, the quadrilateral a, b, cut(bd), cut(ad) has to get the same diagonal
//! from both sides, see [`Stencil::first_wins`].

use super::lattice::Side;

/// What a stencil asks for, and where it puts its tetrahedra.
pub(super) trait Corners {
    /// The mesh vertex at an inside or surface corner.
    fn corner(&mut self, corner: usize) -> u32;
    /// The mesh vertex where the edge between an inside and an outside corner is cut.
    fn cut(&mut self, inside: usize, outside: usize) -> u32;
    /// Takes a positively oriented tetrahedron.
    fn put(&mut self, tet: [u32; 4]);
}

/// One lattice tetrahedron, positively oriented.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stencil {
    pub(super) sides: [Side; 4],
    /// Whether corner 0 has an even number of coordinates greater than those of corner 2. Exchanging a corner for the
    /// other end of its long edge changes one of them, and so the parity.
    pub(super) is_even: bool,
}

impl Stencil {
    /// Fills the inside part.
    pub(super) fn fill(self, mesh: &mut impl Corners) {
        let (order, is_odd) = self.inside_first();
        let [a, b, c, d] = order;
        let n_inside = self.sides.iter().filter(|&&side| side == Side::Inside).count();
        let n_outside = self.sides.iter().filter(|&&side| side == Side::Outside).count();
        match (n_inside, n_outside) {
            (0, _) => {}
            (_, 0) => {
                let tet = order.map(|corner| mesh.corner(corner));
                mesh.put(oriented(tet, is_odd));
            }
            (1, _) => {
                let mut tip = |corner: usize| match self.sides[corner] {
                    Side::Outside => mesh.cut(a, corner),
                    _ => mesh.corner(corner),
                };
                let tet = order.map(&mut tip);
                mesh.put(oriented(tet, is_odd));
            }
            (2, 1) => {
                let [va, vb, vc] = [a, b, c].map(|corner| mesh.corner(corner));
                let (ad, bd) = (mesh.cut(a, d), mesh.cut(b, d));
                if self.first_wins(a, b, d) {
                    mesh.put(oriented([va, vb, vc, bd], is_odd));
                    mesh.put(oriented([va, bd, vc, ad], is_odd));
                } else {
                    mesh.put(oriented([va, vb, vc, ad], is_odd));
                    mesh.put(oriented([ad, vb, vc, bd], is_odd));
                }
            }
            (2, _) => {
                for tet in self.wedge(mesh, order) {
                    mesh.put(oriented(tet, is_odd));
                }
            }
            (_, _) => {
                let (order, is_swapped) = self.winners_first(order);
                let [a, b, c, _] = order;
                let [va, vb, vc] = [a, b, c].map(|corner| mesh.corner(corner));
                let [ad, bd, cd] = [a, b, c].map(|corner| mesh.cut(corner, d));
                for [p, q, r, s] in [[va, vb, vc, cd], [va, vb, cd, bd], [va, bd, cd, ad]] {
                    mesh.put(oriented([p, q, r, s], is_odd != is_swapped));
                }
            }
        }
    }

    /// The corners, those inside first and those outside last, and whether that turned the orientation around.
    fn inside_first(self) -> ([usize; 4], bool) {
        let mut order = [0, 1, 2, 3];
        let mut is_odd = false;
        for end in 1..4 {
            for at in (0..end).rev() {
                if self.sides[order[at]] > self.sides[order[at + 1]] {
                    order.swap(at, at + 1);
                    is_odd = !is_odd;
                }
            }
        }
        (order, is_odd)
    }

    /// Whether the quadrilateral a, b, cut(bd), cut(ad) is cut from `a` to cut(bd) and not from `b` to cut(ad).
    ///
    /// With one long and one short cut edge, the end of the short one wins, so that the diagonal meets the cut of the long
    /// one. With two short ones the parity rule decides: the winner has an even number of coordinates greater than those
    /// of `d`. Two long ones do not occur.
    fn first_wins(self, a: usize, b: usize, d: usize) -> bool {
        match (is_long(a, d), is_long(b, d)) {
            (true, _) => false,
            (_, true) => true,
            // Three coordinates differ, so the parity of 2 against 0 is not that of 0 against 2.
            _ => self.is_even ^ (a % 2 == 1) ^ (d % 2 == 1) ^ (a >= 2),
        }
    }

    /// Two corners inside, `a` and `b`, and two outside: a wedge with triangles at `a` and `b`. The rules let `a` win
    /// against one of `c` and `d` and `b` against the other, and then only one diagonal on the surface goes with them.
    fn wedge(self, mesh: &mut impl Corners, [a, b, c, d]: [usize; 4]) -> [[u32; 4]; 3] {
        let first_wins = self.first_wins(a, b, c);
        debug_assert_ne!(first_wins, self.first_wins(a, b, d), "one win each");
        let [a, b] = if first_wins { [a, b] } else { [b, a] };
        let (va, vb) = (mesh.corner(a), mesh.corner(b));
        let [ac, ad, bc, bd] = [mesh.cut(a, c), mesh.cut(a, d), mesh.cut(b, c), mesh.cut(b, d)];
        [[va, vb, bc, ad], [va, bc, ac, ad], [ad, vb, bc, bd]].map(|tet| oriented(tet, !first_wins))
    }

    /// Inside corners sorted so that the first wins against both others and the second against the third; and whether that
    /// turned the orientation around. No cycle can occur: the face opposite to a long edge's end has it win or lose twice.
    fn winners_first(self, order: [usize; 4]) -> ([usize; 4], bool) {
        let [mut a, mut b, mut c, d] = order;
        let mut is_swapped = false;
        if !self.first_wins(a, b, d) {
            (a, b, is_swapped) = (b, a, !is_swapped);
        }
        if !self.first_wins(b, c, d) {
            (b, c, is_swapped) = (c, b, !is_swapped);
        }
        if !self.first_wins(a, b, d) {
            (a, b, is_swapped) = (b, a, !is_swapped);
        }
        ([a, b, c, d], is_swapped)
    }
}

/// A tetrahedron, turned around if asked to.
fn oriented([a, b, c, d]: [u32; 4], turn: bool) -> [u32; 4] {
    if turn { [a, b, d, c] } else { [a, b, c, d] }
}

/// Corner pairs 01 and 23.
fn is_long(a: usize, b: usize) -> bool {
    a ^ b == 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    use crate::TetMesh;

    const LONG: f64 = 0.24999;
    const SHORT: f64 = 0.41189;

    /// One tetrahedron on its own: vertices 0 to 3 are its corners, 4 + 4 i + j the cut of edge i j.
    struct Alone {
        positions: Vec<DVec3>,
        tets: Vec<[u32; 4]>,
    }

    impl Corners for Alone {
        fn corner(&mut self, corner: usize) -> u32 {
            u32::try_from(corner).unwrap()
        }

        fn cut(&mut self, inside: usize, outside: usize) -> u32 {
            u32::try_from(4 + 4 * inside + outside).unwrap()
        }

        fn put(&mut self, tet: [u32; 4]) {
            self.tets.push(tet);
        }
    }

    fn sides_of(mut code: u32) -> [Side; 4] {
        [0; 4].map(|_| {
            let side = [Side::Inside, Side::Surface, Side::Outside][(code % 3) as usize];
            code /= 3;
            side
        })
    }

    /// Cuts at both ends of what warping leaves, in all combinations, without warped corners: the bounds of the paper.
    #[test]
    fn all_stencils_are_upright_and_well_shaped() {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::new(0.5, -0.5, -0.5), DVec3::new(0.5, 0.5, -0.5)];
        let mut n_filled = 0;
        for code in 0..81 * 64 * 2 {
            let (sides, ends, is_even) = (sides_of(code % 81), code / 81 % 64, code / 81 / 64 == 1);
            let mut alone = Alone { positions: vec![DVec3::ZERO; 20], tets: Vec::new() };
            alone.positions[..4].copy_from_slice(&corners);
            for (edge, [i, j]) in [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]].into_iter().enumerate() {
                let alpha = if is_long(i, j) { LONG } else { SHORT };
                let share = if ends >> edge & 1 == 0 { alpha } else { 1.0 - alpha };
                alone.positions[4 + 4 * i + j] = corners[i].lerp(corners[j], share);
                alone.positions[4 + 4 * j + i] = alone.positions[4 + 4 * i + j];
            }
            Stencil { sides, is_even }.fill(&mut alone);
            assert_eq!(alone.tets.is_empty(), !sides.contains(&Side::Inside));
            n_filled += alone.tets.len();
            for tet in alone.tets {
                let points = tet.map(|v| (1000.0 * alone.positions[v as usize]).as_vec3());
                let mesh = TetMesh::new(points.to_vec(), vec![[0, 1, 2, 3]]).unwrap();
                let [low, high] = mesh.dihedral_angles()[0];
                assert!(low > 10.78 && high < 164.8, "{low} .. {high} for {sides:?}");
            }
        }
        assert!(n_filled > 10_000);
    }

    /// The part inside has the volume that is left after cutting: one corner off, one corner on, half and half.
    #[test]
    fn parts_fill_the_volume_inside() {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::new(0.5, -0.5, -0.5), DVec3::new(0.5, 0.5, -0.5)];
        let filled = |sides: [Side; 4], is_even: bool| -> f64 {
            let mut alone = Alone { positions: vec![DVec3::ZERO; 20], tets: Vec::new() };
            for i in 0..4 {
                alone.positions[i] = corners[i];
                for j in 0..4 {
                    alone.positions[4 + 4 * i + j] = 0.5 * (corners[i] + corners[j]);
                }
            }
            Stencil { sides, is_even }.fill(&mut alone);
            let six = |tet: &[u32; 4]| {
                let [a, b, c, d] = tet.map(|v| alone.positions[v as usize]);
                (b - a).dot((c - a).cross(d - a))
            };
            alone.tets.iter().map(six).sum::<f64>() / 6.0
        };
        let whole = filled([Side::Inside; 4], true);
        assert!((whole - 1.0 / 12.0).abs() < 1e-15);
        for code in 0..162 {
            let sides = sides_of(code % 81);
            let count = |side: Side| sides.iter().filter(|&&other| other == side).count();
            let share = match (count(Side::Inside), count(Side::Surface), count(Side::Outside)) {
                (0, ..) => 0.0,
                (_, _, 0) => 1.0,
                (1, _, n_cut) => 0.5_f64.powi(i32::try_from(n_cut).unwrap()),
                (2, _, 1) => 0.75,
                (2, ..) => 0.5,
                _ => 0.875,
            };
            assert!((filled(sides, code < 81) - share * whole).abs() < 1e-12, "{sides:?}");
        }
    }
}
