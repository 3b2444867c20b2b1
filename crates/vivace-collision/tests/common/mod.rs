//! Surfaces, random numbers, and an intersection test that shares nothing with the crate: exact signs of volumes.

#![allow(dead_code, reason = "each binary uses a part")]
#![expect(clippy::cast_possible_truncation, reason = "small numbers")]

use glam::Vec3;
use rand_pcg::Pcg32;
use rand_pcg::rand_core::{Rng, SeedableRng};
use robust::{Coord3D, orient3d};
use vivace_collision::{Obstacle, Shape};
use vivace_mesh::cloth;

pub(crate) type Triangles = Vec<[u32; 3]>;

pub(crate) struct Random(Pcg32);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(Pcg32::seed_from_u64(seed))
    }

    /// Between -1 and 1.
    pub(crate) fn signed(&mut self) -> f32 {
        self.0.next_u32() as f32 / 2_147_483_648.0 - 1.0
    }

    pub(crate) fn below(&mut self, n: u32) -> u32 {
        self.0.next_u32() % n
    }

    /// In the cube from -1 to 1.
    pub(crate) fn vector(&mut self) -> Vec3 {
        Vec3::new(self.signed(), self.signed(), self.signed())
    }
}

/// A cloth of `n` × `n` particles around the origin, in the xz plane.
pub(crate) fn sheet(n: usize, spacing: f32) -> (Vec<Vec3>, Triangles) {
    let mesh = cloth::regular(n, n, spacing).unwrap();
    let half = 0.5 * spacing * (n - 1) as f32;
    let positions = mesh.positions().iter().map(|p| *p - Vec3::new(half, 0.0, half)).collect();
    (positions, mesh.triangles().to_vec())
}

/// Several surfaces as one.
pub(crate) fn joined(parts: &[(Vec<Vec3>, Triangles)]) -> (Vec<Vec3>, Triangles) {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for (q, t) in parts {
        let first = positions.len() as u32;
        triangles.extend(t.iter().map(|t| t.map(|v| v + first)));
        positions.extend(q);
    }
    (positions, triangles)
}

/// Triangles that share nothing.
pub(crate) fn soup(n: u32, size: f32, random: &mut Random) -> (Vec<Vec3>, Triangles) {
    let mut positions = Vec::new();
    for _ in 0..n {
        let center = random.vector();
        positions.extend((0..3).map(|_| center + size * random.vector()));
    }
    (positions, (0..n).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect())
}

fn volume(x: [Vec3; 4]) -> f64 {
    let [a, b, c, d] = x.map(|v| Coord3D { x: f64::from(v.x), y: f64::from(v.y), z: f64::from(v.z) });
    orient3d(a, b, c, d)
}

/// Whether a segment crosses a triangle from one side to the other, exactly; a line through a side counts.
pub(crate) fn crosses([p, q]: [Vec3; 2], [a, b, c]: [Vec3; 3]) -> bool {
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

pub(crate) fn edges(triangles: &Triangles) -> Vec<[u32; 2]> {
    let mut edges: Vec<[u32; 2]> = triangles
        .iter()
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
        .map(|[a, b]| [a.min(b), a.max(b)])
        .collect();
    edges.sort_unstable();
    edges.dedup();
    edges
}

/// The first edge that crosses a triangle with which it shares no particle.
pub(crate) fn intersection(positions: &[Vec3], triangles: &Triangles) -> Option<([u32; 2], [u32; 3])> {
    let at = |v: u32| positions[v as usize];
    for edge in edges(triangles) {
        let segment = edge.map(at);
        for &triangle in triangles {
            if !triangle.iter().any(|v| edge.contains(v)) && crosses(segment, triangle.map(at)) {
                return Some((edge, triangle));
            }
        }
    }
    None
}

pub(crate) fn on_threads<T: Send>(n: usize, f: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap().install(f)
}

/// Whether a point is at least `gap` outside of a solid that stands, by formulas of their own.
pub(crate) fn outside(obstacle: &Obstacle, point: Vec3, gap: f64) -> bool {
    let pose = obstacle.to;
    let local = pose.rotation.as_dquat().inverse() * (point - pose.position).as_dvec3();
    let distance = match &obstacle.shape {
        Shape::Plane => local.y,
        Shape::Sphere { radius } => local.length() - f64::from(*radius),
        Shape::Capsule { half_length, radius } => {
            let beyond = (local.y.abs() - f64::from(*half_length)).max(0.0);
            local.x.hypot(local.z).hypot(beyond) - f64::from(*radius)
        }
        Shape::Cuboid { half_extent } => (local.abs() - half_extent.as_dvec3()).max_element(),
        _ => f64::NAN,
    };
    distance >= gap
}
