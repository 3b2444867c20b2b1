//! Tetrahedra that know their neighbors, so that a flip touches nothing but a few of them.

use glam::DVec3;

use super::shape::Limits;
use crate::MeshError;
use crate::mesh::index32;

/// No tetrahedron.
pub(super) const NONE: u32 = u32::MAX;

/// The even orders of four corners that begin with each of them.
const EVEN: [[usize; 4]; 4] = [[0, 1, 2, 3], [1, 0, 3, 2], [2, 3, 0, 1], [3, 2, 1, 0]];

/// A tetrahedral mesh under change. Slots of removed tetrahedra are used again.
pub(super) struct Complex {
    /// Positions \[m\], values of `f32`: what is checked here is what the mesh gets.
    pub(super) positions: Vec<DVec3>,
    tets: Vec<[u32; 4]>,
    /// The tetrahedron across the face opposite to each corner, or [`NONE`].
    across: Vec<[u32; 4]>,
    free: Vec<u32>,
    limits: Limits,
}

impl Complex {
    /// # Errors
    /// A face of more than two tetrahedra.
    pub(super) fn new(positions: Vec<DVec3>, tets: Vec<[u32; 4]>, limits: Limits) -> Result<Self, MeshError> {
        let across = neighbors(&tets, positions.len())?;
        Ok(Self { positions, tets, across, free: Vec::new(), limits })
    }

    /// How many slots there are, in use or not.
    pub(super) fn n_slots(&self) -> usize {
        self.tets.len()
    }

    /// The corners of a tetrahedron; `None` for an unused slot.
    pub(super) fn tet(&self, slot: u32) -> Option<[u32; 4]> {
        Some(self.tets[slot as usize]).filter(|tet| tet[0] != NONE)
    }

    /// The tetrahedra in use.
    pub(super) fn tets(&self) -> impl Iterator<Item = [u32; 4]> {
        self.tets.iter().copied().filter(|tet| tet[0] != NONE)
    }

    /// Vertices on the boundary.
    pub(super) fn on_boundary(&self) -> Vec<bool> {
        let mut on_boundary = vec![false; self.positions.len()];
        for (tet, across) in self.tets.iter().zip(&self.across).filter(|(tet, _)| tet[0] != NONE) {
            for corner in 0..4 {
                if across[corner] == NONE {
                    EVEN[corner][1..].iter().for_each(|&other| on_boundary[tet[other] as usize] = true);
                }
            }
        }
        on_boundary
    }

    /// Whether a tetrahedron with these corners is good enough.
    pub(super) fn is_good(&self, tet: [u32; 4]) -> bool {
        self.limits.hold(tet.map(|v| self.positions[v as usize]))
    }

    /// The two vertices that a 2-3 flip across the face opposite to `corner` would join.
    pub(super) fn ends_across(&self, slot: u32, corner: usize) -> Option<(u32, u32)> {
        let other = self.across[slot as usize][corner];
        (other != NONE).then(|| (self.tets[slot as usize][corner], self.apex(other, slot)))
    }

    /// 2-3 flip: replaces the face opposite to `corner` by an edge. Does nothing where that would be no better than the limits.
    ///
    /// ```text
    ///        p                 p
    ///       /|\               /|\       before: (p, a, b, c) and (q, a, c, b) share the face abc
    ///      a-|-b     ->      a | b      after:  (p, a, b, q), (p, b, c, q), (p, c, a, q) share the edge pq
    ///       \c/               \c/
    ///        q                 q
    /// ```
    pub(super) fn flip_face(&mut self, slot: u32, corner: usize) -> bool {
        let other = self.across[slot as usize][corner];
        if other == NONE {
            return false;
        }
        let [p, a, b, c] = EVEN[corner].map(|k| self.tets[slot as usize][k]);
        let q = self.apex(other, slot);
        let new = [[p, a, b, q], [p, b, c, q], [p, c, a, q]];
        if !new.iter().all(|&tet| self.is_good(tet)) {
            return false;
        }
        let above = [a, b, c].map(|v| self.across_from(slot, v));
        let below = [a, b, c].map(|v| self.across_from(other, v));
        let third = self.take_slot();
        let slots = [slot, other, third];
        for (turn, (&slot, tet)) in slots.iter().zip(new).enumerate() {
            let (next, previous) = ((turn + 1) % 3, (turn + 2) % 3);
            // Corners p, a, b, q: across from a lies the next one, from b the previous one.
            self.tets[slot as usize] = tet;
            self.across[slot as usize] = [below[previous], slots[next], slots[previous], above[previous]];
        }
        for (turn, &new_slot) in slots.iter().enumerate() {
            let previous = (turn + 2) % 3;
            self.relink(below[previous], other, new_slot);
            self.relink(above[previous], slot, new_slot);
        }
        true
    }

    /// The three tetrahedra around the edge between two corners, as slots and corners (p, a, b, c, q) of [`Complex::flip_face`],
    /// if there are three.
    fn three_around(&self, slot: u32, [from, to]: [usize; 2]) -> Option<([u32; 3], [u32; 5])> {
        let [i, j, k, l] = EVEN[from];
        let order = match to {
            _ if to == l => [i, j, k, l],
            _ if to == k => [i, l, j, k],
            _ => [i, k, l, j],
        };
        let [p, a, b, q] = order.map(|corner| self.tets[slot as usize][corner]);
        let (next, previous) = (self.across[slot as usize][order[1]], self.across[slot as usize][order[2]]);
        if next == NONE || previous == NONE || self.across_from(next, b) != previous {
            return None;
        }
        let c = self.apex(next, slot);
        Some(([slot, next, previous], [p, a, b, c, q]))
    }

    /// The ends of an edge that a 3-2 flip would remove.
    pub(super) fn ends_of(&self, slot: u32, [from, to]: [usize; 2]) -> Option<(u32, u32)> {
        self.three_around(slot, [from, to]).map(|(_, [p, _, _, _, q])| (p, q))
    }

    /// 3-2 flip: replaces the edge between two corners, if just three tetrahedra share it, by a face; the reverse of
    /// [`Complex::flip_face`].
    pub(super) fn flip_edge(&mut self, slot: u32, corners: [usize; 2]) -> bool {
        let Some((slots, [p, a, b, c, q])) = self.three_around(slot, corners) else { return false };
        let new = [[p, a, b, c], [q, a, c, b]];
        if !new.iter().all(|&tet| self.is_good(tet)) {
            return false;
        }
        // Slot k holds (p, x, y, q) with (x, y) = ab, bc, ca; its outer faces lie across from q and p, and miss c, a, b.
        let above = slots.map(|s| self.across_from(s, q));
        let below = slots.map(|s| self.across_from(s, p));
        let [upper, lower, unused] = slots;
        self.tets[upper as usize] = new[0];
        self.across[upper as usize] = [lower, above[1], above[2], above[0]];
        self.tets[lower as usize] = new[1];
        self.across[lower as usize] = [upper, below[1], below[0], below[2]];
        for turn in 0..3 {
            self.relink(above[turn], slots[turn], upper);
            self.relink(below[turn], slots[turn], lower);
        }
        self.tets[unused as usize] = [NONE; 4];
        self.across[unused as usize] = [NONE; 4];
        self.free.push(unused);
        true
    }

    /// The corner of `slot` across from `other`.
    fn apex(&self, slot: u32, other: u32) -> u32 {
        let across = self.across[slot as usize];
        let corner = (0..4).find(|&k| across[k] == other);
        debug_assert!(corner.is_some(), "neighbors know each other");
        self.tets[slot as usize][corner.unwrap_or(0)]
    }

    /// The tetrahedron across the face of `slot` opposite to `vertex`.
    fn across_from(&self, slot: u32, vertex: u32) -> u32 {
        let tet = self.tets[slot as usize];
        let corner = (0..4).find(|&k| tet[k] == vertex);
        debug_assert!(corner.is_some(), "the vertex is a corner");
        self.across[slot as usize][corner.unwrap_or(0)]
    }

    /// Tells `slot` that the neighbor it knew as `old` is now `new`.
    fn relink(&mut self, slot: u32, old: u32, new: u32) {
        if slot != NONE {
            for neighbor in &mut self.across[slot as usize] {
                if *neighbor == old {
                    *neighbor = new;
                    return;
                }
            }
        }
    }

    fn take_slot(&mut self) -> u32 {
        self.free.pop().unwrap_or_else(|| {
            self.tets.push([NONE; 4]);
            self.across.push([NONE; 4]);
            index32(self.tets.len() - 1)
        })
    }
}

/// The tetrahedron across each face, found in buckets of faces with the same lowest vertex.
fn neighbors(tets: &[[u32; 4]], n_vertices: usize) -> Result<Vec<[u32; 4]>, MeshError> {
    let mut start = vec![0_usize; n_vertices + 1];
    let face = |tet: [u32; 4], corner: usize| {
        let mut face = [tet[EVEN[corner][1]], tet[EVEN[corner][2]], tet[EVEN[corner][3]]];
        face.sort_unstable();
        face
    };
    for &tet in tets {
        (0..4).for_each(|corner| start[face(tet, corner)[0] as usize + 1] += 1);
    }
    for vertex in 0..n_vertices {
        start[vertex + 1] += start[vertex];
    }
    let mut faces = vec![([0_u32; 2], 0_u32, 0_u8); 4 * tets.len()];
    let mut next = start.clone();
    for (slot, &tet) in tets.iter().enumerate() {
        for corner in 0_u8..4 {
            let [lowest, middle, highest] = face(tet, corner.into());
            let place = &mut next[lowest as usize];
            faces[*place] = ([middle, highest], index32(slot), corner);
            *place += 1;
        }
    }
    let mut across = vec![[NONE; 4]; tets.len()];
    for vertex in 0..n_vertices {
        let bucket = &mut faces[start[vertex]..start[vertex + 1]];
        bucket.sort_unstable();
        for group in bucket.chunk_by(|one, other| one.0 == other.0) {
            match *group {
                [_] => {}
                [(_, one, one_corner), (_, other, other_corner)] => {
                    across[one as usize][usize::from(one_corner)] = other;
                    across[other as usize][usize::from(other_corner)] = one;
                }
                _ => {
                    let ([middle, highest], ..) = group[0];
                    let n_tets = group.len();
                    let fault = format!(
                        "face ({vertex}, {middle}, {highest}) belongs to {n_tets} tetrahedra instead of at most 2"
                    );
                    return Err(MeshError::NotAVolumeBoundary { fault });
                }
            }
        }
    }
    Ok(across)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two tetrahedra on one face, `q` below and `p` above an equilateral triangle, and a third one on an outer face.
    fn bipyramid() -> Complex {
        let triangle = [(1.0, 0.0), (-0.5, 0.8), (-0.5, -0.8)].map(|(x, y)| DVec3::new(x, y, 0.0));
        let mut positions = vec![DVec3::Z, -DVec3::Z];
        positions.extend(triangle);
        positions.push(DVec3::new(1.5, 1.5, 1.5));
        // (p, a, b, c), (q, a, c, b), and one on the face (p, a, b).
        let tets = vec![[0, 2, 3, 4], [1, 2, 4, 3], [5, 0, 3, 2]];
        let tets = tets.into_iter().map(|tet: [u32; 4]| upright(&positions, tet)).collect();
        Complex::new(positions, tets, Limits::new(1.0, 179.0)).unwrap()
    }

    fn upright(positions: &[DVec3], tet: [u32; 4]) -> [u32; 4] {
        let [a, b, c, d] = tet.map(|v| positions[v as usize]);
        let [p, q, r, s] = tet;
        if (b - a).dot((c - a).cross(d - a)) > 0.0 { tet } else { [p, q, s, r] }
    }

    fn sorted(complex: &Complex) -> Vec<[u32; 4]> {
        let mut tets: Vec<_> = complex
            .tets()
            .map(|mut tet| {
                tet.sort_unstable();
                tet
            })
            .collect();
        tets.sort_unstable();
        tets
    }

    /// The neighbors must be what a fresh search finds.
    fn check(complex: &Complex) {
        let n_vertices = complex.positions.len();
        let used: Vec<usize> = (0..complex.n_slots()).filter(|&slot| complex.tets[slot][0] != NONE).collect();
        let fresh = neighbors(&complex.tets().collect::<Vec<_>>(), n_vertices).unwrap();
        for (index, &slot) in used.iter().enumerate() {
            let expected = fresh[index].map(|n| if n == NONE { NONE } else { index32(used[n as usize]) });
            assert_eq!(complex.across[slot], expected, "slot {slot}");
        }
    }

    #[test]
    fn a_face_flip_and_its_reverse() {
        let mut complex = bipyramid();
        let before = sorted(&complex);
        let apex = complex.tets[0].iter().position(|&v| v == 0).unwrap();
        assert_eq!(complex.ends_across(0, apex), Some((0, 1)));
        assert!(complex.flip_face(0, apex));
        assert_eq!(sorted(&complex), [[0, 1, 2, 3], [0, 1, 2, 4], [0, 1, 3, 4], [0, 2, 3, 5]]);
        check(&complex);
        for slot in 0..4 {
            let Some(tet) = complex.tet(slot) else { continue };
            let ends = [0, 1].map(|end| tet.iter().position(|&v| v == end));
            let [Some(p), Some(q)] = ends else { continue };
            assert_eq!(complex.ends_of(slot, [p, q]), Some((0, 1)));
            let mut again = bipyramid();
            assert!(again.flip_face(0, apex));
            assert!(again.flip_edge(slot, [p, q]));
            assert_eq!(sorted(&again), before);
            check(&again);
        }
    }

    #[test]
    fn flips_that_would_spoil_the_shape_are_refused() {
        let mut complex = bipyramid();
        complex.positions[1] = DVec3::new(4.0, 0.0, -0.1);
        let apex = complex.tets[0].iter().position(|&v| v == 0).unwrap();
        assert!(!complex.flip_face(0, apex));
        assert_eq!(sorted(&complex), sorted(&bipyramid()));
    }

    #[test]
    fn boundary_faces_and_edges_are_not_flipped() {
        let mut complex = bipyramid();
        for slot in 0..3 {
            for corner in 0..4 {
                if complex.across[slot as usize][corner] == NONE {
                    assert!(!complex.flip_face(slot, corner));
                }
            }
            for edge in [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]] {
                assert!(!complex.flip_edge(slot, edge));
            }
        }
    }

    #[test]
    fn three_tetrahedra_on_a_face_are_refused() {
        let positions = vec![DVec3::ZERO; 6];
        let tets = vec![[0, 1, 2, 3], [0, 1, 2, 4], [0, 1, 2, 5]];
        let error = Complex::new(positions, tets, Limits::new(1.0, 179.0)).err().unwrap();
        assert!(error.to_string().contains("face (0, 1, 2) belongs to 3"));
    }
}
