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
    /// Whether the quadrilateral is better cut along its first and third vertex than along the others.
    fn prefers_first_diagonal(&self, quadrilateral: [u32; 4]) -> bool;
    /// Takes a positively oriented tetrahedron.
    fn put(&mut self, tet: [u32; 4]);
}

/// One lattice tetrahedron, positively oriented.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stencil {
    pub(super) sides: [Side; 4],
    /// The parity of each corner in its own cubic lattice: the two ends of a long edge differ.
    pub(super) is_even: [bool; 4],
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
    /// one; the other way around, angles fall below 9 degrees. With two short ones `a` and `b` are neighbors in one cubic
    /// lattice, and the even one wins: the parity rule. Two long ones do not occur.
    fn first_wins(self, a: usize, b: usize, d: usize) -> bool {
        match (is_long(a, d), is_long(b, d)) {
            (true, _) => false,
            (_, true) => true,
            _ => self.is_even[a],
        }
    }

    /// Two corners inside, `a` and `b`, and two outside: a wedge with triangles at `a` and `b`.
    fn wedge(self, mesh: &mut impl Corners, order: [usize; 4]) -> [[u32; 4]; 3] {
        let [a, b, c, d] = order;
        match (self.first_wins(a, b, c), self.first_wins(a, b, d)) {
            (true, true) => wedge_from(mesh, order),
            // Exchanging both pairs keeps the orientation.
            (false, false) => wedge_from(mesh, [b, a, d, c]),
            (true, false) => wedge_across(mesh, order),
            (false, true) => wedge_across(mesh, [b, a, c, d]).map(|tet| oriented(tet, true)),
        }
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

/// The wedge whose two inner diagonals both start at `a`; the one on the surface is free.
fn wedge_from(mesh: &mut impl Corners, [a, b, c, d]: [usize; 4]) -> [[u32; 4]; 3] {
    let (va, vb) = (mesh.corner(a), mesh.corner(b));
    let [ac, ad, bc, bd] = [mesh.cut(a, c), mesh.cut(a, d), mesh.cut(b, c), mesh.cut(b, d)];
    if mesh.prefers_first_diagonal([ac, bc, bd, ad]) {
        [[va, vb, bc, bd], [va, bd, ac, ad], [va, bc, ac, bd]]
    } else {
        [[va, vb, bc, bd], [va, bc, ac, ad], [va, bd, bc, ad]]
    }
}

/// The wedge with inner diagonals a-cut(bc) and b-cut(ad): only bc-ad on the surface goes with them.
fn wedge_across(mesh: &mut impl Corners, [a, b, c, d]: [usize; 4]) -> [[u32; 4]; 3] {
    let (va, vb) = (mesh.corner(a), mesh.corner(b));
    let [ac, ad, bc, bd] = [mesh.cut(a, c), mesh.cut(a, d), mesh.cut(b, c), mesh.cut(b, d)];
    [[va, vb, bc, ad], [va, bc, ac, ad], [ad, vb, bc, bd]]
}
