//! Whether a surface intersects itself: exact signs of volumes, and nothing of what the collisions are made of.

use glam::{DVec3, IVec3, Vec3};
use rayon::prelude::*;
use robust::{Coord3D, orient3d};

/// Every edge of `triangles` that crosses a triangle with which it shares no particle, and that triangle.
///
/// # Panics
/// If a corner is not one of `positions`, or those are not finite.
pub fn crossings(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<([u32; 2], [u32; 3])> {
    let at = |v: u32| positions[v as usize];
    let grid = Grid::new(positions, triangles);
    let of_edge = |edge: &[u32; 2]| {
        let segment = edge.map(at);
        let mut found = Vec::new();
        grid.near(segment, |triangle| {
            let triangle = triangles[triangle as usize];
            if !triangle.iter().any(|v| edge.contains(v)) && crosses(segment, triangle.map(at)) {
                found.push((*edge, triangle));
            }
        });
        found
    };
    edges(triangles).par_iter().flat_map_iter(of_edge).collect()
}

/// Each edge once, the lower end first, ascending.
fn edges(triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let sides = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let mut edges: Vec<[u32; 2]> = sides.map(|[a, b]| [a.min(b), a.max(b)]).collect();
    edges.sort_unstable();
    edges.dedup();
    edges
}

/// Whether a segment crosses a triangle from one side to the other, exactly; a line through a side counts.
fn crosses([p, q]: [Vec3; 2], [a, b, c]: [Vec3; 3]) -> bool {
    let (min, max) = (p.min(q), p.max(q));
    if a.min(b).min(c).cmpgt(max).any() || a.max(b).max(c).cmplt(min).any() {
        return false;
    }
    if volume([a, b, c, p]) * volume([a, b, c, q]) >= 0.0 {
        return false;
    }
    let sides = [volume([p, q, a, b]), volume([p, q, b, c]), volume([p, q, c, a])];
    sides.iter().all(|v| *v >= 0.0) || sides.iter().all(|v| *v <= 0.0)
}

fn volume(x: [Vec3; 4]) -> f64 {
    let [a, b, c, d] = x.map(|v| Coord3D { x: f64::from(v.x), y: f64::from(v.y), z: f64::from(v.z) });
    orient3d(a, b, c, d)
}

/// Triangles by the cells of a lattice that their boxes meet.
struct Grid {
    cell: f64,
    /// Cell and triangle, ascending.
    entries: Vec<([i32; 3], u32)>,
    boxes: Vec<[Vec3; 2]>,
}

/// Cells that one box may take up along an axis: a triangle that has been thrown far away does not fill the memory.
const MOST: i32 = 64;

impl Grid {
    fn new(positions: &[Vec3], triangles: &[[u32; 3]]) -> Self {
        let boxes: Vec<[Vec3; 2]> =
            triangles.iter().map(|t| around(&t.map(|v| positions[v as usize]))).collect();
        let longest = boxes.iter().map(|[min, max]| f64::from((*max - *min).max_element()));
        let (mean, most) = longest.fold((0.0, 0.0_f64), |(sum, most), x| (sum + x, most.max(x)));
        let cell = (mean / boxes.len().max(1) as f64).max(most / f64::from(MOST)).max(1e-6);
        let mut grid = Self { cell, entries: Vec::new(), boxes };
        for (triangle, of) in (0..).zip(&grid.boxes) {
            grid.entries.extend(cells(*of, cell).map(|cell| (cell, triangle)));
        }
        grid.entries.sort_unstable();
        grid
    }

    /// Each triangle whose box meets that of the segment, once: in the lowest cell that both boxes meet.
    fn near(&self, segment: [Vec3; 2], mut f: impl FnMut(u32)) {
        let [min, max] = around(&segment);
        for cell in cells([min, max], self.cell) {
            let first = self.entries.partition_point(|entry| entry.0 < cell);
            for &(_, triangle) in self.entries[first..].iter().take_while(|entry| entry.0 == cell) {
                let [low, high] = self.boxes[triangle as usize];
                let common = low.max(min);
                if common.cmple(high.min(max)).all() && cell_of(common, self.cell).to_array() == cell {
                    f(triangle);
                }
            }
        }
    }
}

fn around(points: &[Vec3]) -> [Vec3; 2] {
    let fold = |f: fn(Vec3, Vec3) -> Vec3| points.iter().copied().reduce(f).unwrap_or_default();
    [fold(Vec3::min), fold(Vec3::max)]
}

fn cell_of(point: Vec3, cell: f64) -> IVec3 {
    (DVec3::from(point) / cell).floor().as_ivec3()
}

fn cells([min, max]: [Vec3; 2], cell: f64) -> impl Iterator<Item = [i32; 3]> {
    let (low, high) = (cell_of(min, cell), cell_of(max, cell));
    let (y, z) = (move || low.y..=high.y, move || low.z..=high.z);
    (low.x..=high.x).flat_map(move |x| y().flat_map(move |y| z().map(move |z| [x, y, z])))
}

#[cfg(test)]
mod tests {
    use rand_pcg::Pcg32;
    use rand_pcg::rand_core::{Rng as _, SeedableRng as _};

    use super::*;

    /// All pairs, by looking at all pairs.
    fn brute(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<([u32; 2], [u32; 3])> {
        let at = |v: u32| positions[v as usize];
        let mut found = Vec::new();
        for edge in edges(triangles) {
            for &triangle in triangles {
                let is_apart = !triangle.iter().any(|v| edge.contains(v));
                if is_apart && crosses(edge.map(at), triangle.map(at)) {
                    found.push((edge, triangle));
                }
            }
        }
        found.sort_unstable();
        found
    }

    #[test]
    fn the_grid_misses_nothing_and_counts_nothing_twice() {
        let mut random = Pcg32::seed_from_u64(5);
        let mut unit = || random.next_u32() as f32 / u32::MAX as f32 - 0.5;
        let mut total = 0;
        for size in [0.05, 0.3, 1.0, 30.0] {
            let mut positions = Vec::new();
            for k in 0..120 {
                let center = Vec3::new(unit(), unit(), unit());
                let size = if k % 10 == 0 { 10.0 * size } else { size };
                positions.extend((0..3).map(|_| center + size * Vec3::new(unit(), unit(), unit())));
            }
            let triangles: Vec<[u32; 3]> = (0..120).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
            let mut found = crossings(&positions, &triangles);
            found.sort_unstable();
            assert_eq!(found, brute(&positions, &triangles), "{size}");
            total += found.len();
        }
        assert!(total > 1000, "{total}");
    }

    #[test]
    fn a_needle_through_a_triangle_is_one_crossing() {
        let flat = [Vec3::ZERO, Vec3::X, Vec3::Z];
        let needle = [Vec3::new(0.2, -1.0, 0.2), Vec3::new(0.2, 1.0, 0.2), Vec3::new(0.2, 1.0, 0.9)];
        let positions: Vec<Vec3> = flat.into_iter().chain(needle).collect();
        let found = crossings(&positions, &[[0, 1, 2], [3, 4, 5]]);
        assert_eq!(found[0], ([3, 4], [0, 1, 2]));
        let aside: Vec<Vec3> = positions
            .iter()
            .enumerate()
            .map(|(k, p)| *p + if k > 2 { Vec3::X } else { Vec3::ZERO })
            .collect();
        assert!(crossings(&aside, &[[0, 1, 2], [3, 4, 5]]).is_empty());
    }
}
