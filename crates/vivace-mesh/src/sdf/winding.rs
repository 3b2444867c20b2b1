//! How often a closed surface winds around a point: the sign of [`super::ClosedSurface`].
//!
//! A ray in +x counts the triangles that it leaves the solid through, less those that it enters through. The projected
//! orientation tests are exact (coordinates are `f32`, so their products fit into `f64`), and a ray through a vertex or an
//! edge is decided alike for all triangles that share it; so a closed surface never miscounts, whatever the point.

use glam::{DVec3, Vec3};

/// The triangles of a closed surface, sorted into a grid of the y-z plane.
#[derive(Debug, Clone)]
pub(super) struct Winding {
    corners: Vec<[Vec3; 3]>,
    /// First corner of the grid, and grid cells per length, in y and z.
    origin: [f32; 2],
    per_length: [f32; 2],
    n_cells: [usize; 2],
    /// Triangles of cell `c`: `members[start[c]..start[c + 1]]`.
    start: Vec<usize>,
    members: Vec<u32>,
}

impl Winding {
    /// `corners`: the triangles, counter-clockwise seen from outside, coordinates within about [-1, 1].
    #[expect(clippy::cast_possible_truncation, reason = "triangles are numbered in 32 bits by their mesh")]
    pub(super) fn new(corners: Vec<[Vec3; 3]>) -> Self {
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for corner in corners.iter().flatten() {
            low = low.min(*corner);
            high = high.max(*corner);
        }
        // About one triangle of a smooth closed surface to a cell.
        let side = corners.len().isqrt().clamp(1, 2048);
        let per_cell = |extent: f32| if extent > 0.0 { side as f32 / extent } else { 0.0 };
        let size = high - low;
        let mut winding = Self {
            corners,
            origin: [low.y, low.z],
            per_length: [per_cell(size.y), per_cell(size.z)],
            n_cells: [side, side],
            start: vec![0; side * side + 1],
            members: Vec::new(),
        };
        let mut entries: Vec<(usize, u32)> = Vec::new();
        for (index, triangle) in winding.corners.iter().enumerate() {
            let [a, b, c] = *triangle;
            let (least, most) = (a.min(b).min(c), a.max(b).max(c));
            for row in winding.cell(1, least.z)..=winding.cell(1, most.z) {
                for column in winding.cell(0, least.y)..=winding.cell(0, most.y) {
                    entries.push((row * side + column, index as u32));
                }
            }
        }
        entries.sort_unstable();
        for &(cell, _) in &entries {
            winding.start[cell + 1] += 1;
        }
        for cell in 0..side * side {
            winding.start[cell + 1] += winding.start[cell];
        }
        winding.members = entries.into_iter().map(|(_, triangle)| triangle).collect();
        winding
    }

    /// The winding number around `point`: 1 inside a simple closed surface, 0 outside.
    pub(super) fn around(&self, point: Vec3) -> i32 {
        let cell = self.cell(1, point.z) * self.n_cells[0] + self.cell(0, point.y);
        let members = &self.members[self.start[cell]..self.start[cell + 1]];
        members.iter().map(|&triangle| crossing(self.corners[triangle as usize], point)).sum()
    }

    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a float-to-integer cast saturates, and the result is then held inside the grid"
    )]
    fn cell(&self, axis: usize, coordinate: f32) -> usize {
        let cell = (coordinate - self.origin[axis]) * self.per_length[axis];
        (cell as usize).min(self.n_cells[axis] - 1)
    }
}

/// +1 where the ray from `point` in +x leaves through the triangle, -1 where it enters, 0 where it misses.
fn crossing(triangle: [Vec3; 3], point: Vec3) -> i32 {
    let [a, b, c] = triangle;
    let turns = edge_turn(a, b, point) + edge_turn(b, c, point) + edge_turn(c, a, point);
    if turns == 0 {
        return 0;
    }
    // Beyond the ray's start? The plane of the triangle at (y, z), its normal having an x component since it was hit.
    let [a, b, c, p] = [a, b, c, point].map(DVec3::from);
    let normal = (b - a).cross(c - a);
    let ahead = normal.dot(a - p) * normal.x > 0.0;
    if ahead { turns } else { 0 }
}

/// One edge's share of the winding number of the projected triangle around `point`: +1 for an edge that passes on the
/// right (greater y) going up (greater z), -1 going down. Levels are half-open, so that a corner counts once.
fn edge_turn(from: Vec3, to: Vec3, point: Vec3) -> i32 {
    let (lower, upper, turn) = if from.z <= to.z { (from, to, 1) } else { (to, from, -1) };
    if !(lower.z <= point.z && point.z < upper.z) {
        return 0;
    }
    let [lower, upper, point] = [lower, upper, point].map(DVec3::from);
    // Both products are exact, so their comparison is; both triangles of an edge make the same one.
    let is_right = (upper.y - lower.y) * (point.z - lower.z) > (point.y - lower.y) * (upper.z - lower.z);
    if is_right { turn } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tetrahedron() -> Winding {
        let [o, x, y, z] = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
        Winding::new(vec![[o, y, x], [o, x, z], [o, z, y], [x, y, z]])
    }

    #[test]
    fn tetrahedron_by_hand() {
        let winding = tetrahedron();
        assert_eq!(winding.around(Vec3::splat(0.1)), 1);
        assert_eq!(winding.around(Vec3::splat(0.4)), 0);
        assert_eq!(winding.around(Vec3::new(-0.1, 0.1, 0.1)), 0);
        assert_eq!(winding.around(Vec3::new(0.1, -0.1, 0.1)), 0);
        assert_eq!(winding.around(Vec3::new(0.1, 0.1, 5.0)), 0);
    }

    #[test]
    fn rays_through_vertices_and_edges_count_once() {
        // An octahedron: from outside on -x, rays hit its +-y, +-z corners, its edges, and both tips on the axis.
        let tips = [Vec3::X, Vec3::Y, Vec3::Z];
        let mut faces = Vec::new();
        for signs in 0..8 {
            let [x, y, z] =
                [0, 1, 2].map(|axis| if signs >> axis & 1 == 0 { tips[axis] } else { -tips[axis] });
            let flipped = (0..3).filter(|axis| signs >> axis & 1 == 1).count() % 2 == 1;
            faces.push(if flipped { [x, z, y] } else { [x, y, z] });
        }
        let winding = Winding::new(faces);
        for step_y in -8_i8..=8 {
            for step_z in -8_i8..=8 {
                let (y, z) = (f32::from(step_y) / 8.0, f32::from(step_z) / 8.0);
                assert_eq!(winding.around(Vec3::new(-2.0, y, z)), 0, "from the left of ({y}, {z})");
                let inside = y.abs() + z.abs() < 1.0;
                assert_eq!(winding.around(Vec3::new(0.0, y, z)), i32::from(inside), "at ({y}, {z})");
            }
        }
    }
}
