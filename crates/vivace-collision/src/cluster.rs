//! A surface in clusters: up to eight triangles that lie together at rest, with the points and edges that are theirs.
//!
//! Boxes are around ways as the cluster itself sees them, with its own motion taken off: neighbors move alike, so boxes stay small
//! however fast the surface goes. Where two clusters are compared, one's boxes are stretched by how the two move apart.

use glam::{DVec3, Vec3};
use wide::f32x8;

use crate::boxes::{Aabb, ROUNDING};
use crate::surface::{Surface, distinct};

/// Boxes that are compared with one at a time.
const LANES: usize = 8;
/// Triangles of a cluster, at most.
const N_TRIANGLES: usize = LANES;
/// Its particles, at most.
const N_PARTICLES: usize = 3 * N_TRIANGLES;

/// Some triangles of a surface, on their way.
pub(crate) struct Cluster {
    particles: Vec<u32>,
    points: Primitives<1>,
    edges: Primitives<2>,
    triangles: Primitives<3>,
    /// How far it goes as a whole \[m\].
    pub(crate) way: Vec3,
    /// Around all, as seen from a frame that goes along.
    bounds: Aabb,
    /// Around where its particles end instead of where they were to \[m\].
    astray: Aabb,
    /// Whether the last search was for pairs of this cluster.
    pub(crate) is_stale: bool,
}

/// Points, edges or triangles.
struct Primitives<const N: usize> {
    particles: Vec<[u32; N]>,
    /// The same, as places among the cluster's particles.
    places: Vec<[u8; N]>,
    boxes: Vec<Group>,
}

/// The boxes of eight primitives: least x, y, z, then greatest. Where there is none, it meets nothing.
#[derive(Clone, Copy)]
struct Group([f32x8; 6]);

/// All of `surface`, by where its particles are at rest \[m\]. Each point and each edge is one cluster's; a cluster is of one body.
pub(crate) fn clusters(surface: &Surface, rest: &[Vec3]) -> Vec<Cluster> {
    let mut parts = Vec::new();
    let center = |t: u32| -> DVec3 {
        surface.triangles[t as usize].iter().map(|&v| rest[v as usize].as_dvec3()).sum()
    };
    surface.bodies().iter_mut().for_each(|body| split(body, &center, &mut parts));
    let (mut has_point, mut has_edge) = (vec![false; rest.len()], vec![false; surface.edges.len()]);
    let cluster = |part: Vec<u32>| {
        let triangles: Vec<[u32; 3]> = part.iter().map(|&t| surface.triangles[t as usize]).collect();
        let particles = distinct(triangles.as_flattened().to_vec());
        let mut edges = distinct(triangles.iter().flat_map(|&corners| surface.edges_of(corners)).collect());
        edges.retain(|&e| !std::mem::replace(&mut has_edge[e], true));
        let mut points = particles.clone();
        points.retain(|&v| !std::mem::replace(&mut has_point[v as usize], true));
        Cluster {
            points: Primitives::new(points.into_iter().map(|v| [v]).collect(), &particles),
            edges: Primitives::new(edges.into_iter().map(|e| surface.edges[e]).collect(), &particles),
            triangles: Primitives::new(triangles, &particles),
            particles,
            way: Vec3::ZERO,
            bounds: Aabb::EMPTY,
            astray: Aabb::EMPTY,
            is_stale: true,
        }
    };
    parts.into_iter().map(cluster).collect()
}

/// Cuts `triangles` across their longest extent, in whole clusters, until each part is one.
fn split(triangles: &mut [u32], center: &impl Fn(u32) -> DVec3, parts: &mut Vec<Vec<u32>>) {
    let n = triangles.len();
    if n <= N_TRIANGLES {
        parts.push(distinct(triangles.to_vec()));
        return;
    }
    let (mut least, mut most) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for &t in &*triangles {
        (least, most) = (least.min(center(t)), most.max(center(t)));
    }
    let axis = (most - least).max_position();
    let middle = (n / 2).next_multiple_of(N_TRIANGLES).min(n - 1);
    triangles
        .select_nth_unstable_by(middle, |&a, &b| center(a)[axis].total_cmp(&center(b)[axis]).then(a.cmp(&b)));
    let (left, right) = triangles.split_at_mut(middle);
    split(left, center, parts);
    split(right, center, parts);
}

impl Cluster {
    /// Takes the ways from `from` to `to` \[m\], with boxes `margin` \[m\] wider on each side.
    pub(crate) fn follow(&mut self, from: &[Vec3], to: &[Vec3], margin: f32) {
        let mut ways = Aabb::EMPTY;
        for &v in &self.particles {
            ways = ways.including(to[v as usize] - from[v as usize]);
        }
        self.way = ways.center();
        self.bounds = Aabb::EMPTY;
        let mut boxes = [Aabb::EMPTY; N_PARTICLES];
        for (b, &v) in boxes.iter_mut().zip(&self.particles) {
            *b = Aabb::around(from[v as usize], to[v as usize] - self.way, margin);
            self.bounds = self.bounds.union(*b);
        }
        self.points.follow(&boxes);
        self.edges.follow(&boxes);
        self.triangles.follow(&boxes);
    }

    /// Takes where its particles end instead of at `ends` \[m\].
    pub(crate) fn stray(&mut self, to: &[Vec3], ends: &[Vec3]) {
        let ends = self.particles.iter().map(|&v| to[v as usize] - ends[v as usize]);
        self.astray = ends.fold(Aabb::EMPTY, Aabb::including);
    }

    /// How much nearer to each other that may bring this cluster and `other` \[m\]; never less for rounding.
    pub(crate) fn strays(&self, other: &Self) -> f32 {
        farthest(self.astray, other.astray)
    }

    /// Whether that may be `slack` \[m\] or more for any two of `clusters`.
    pub(crate) fn stray_apart(clusters: &[Self], slack: f32) -> bool {
        let all = clusters.iter().fold(Aabb::EMPTY, |all, cluster| all.union(cluster.astray));
        !clusters.is_empty() && farthest(all, all) >= slack
    }

    /// Whether one of its particles is one of those.
    pub(crate) fn has(&self, those: &[bool]) -> bool {
        self.particles.iter().any(|&v| those[v as usize])
    }

    /// Its box, as seen from a frame that goes as far as `drift` \[m\].
    pub(crate) fn seen(&self, drift: Vec3) -> Aabb {
        self.bounds.stretched(self.way - drift)
    }

    /// Calls `of_point` with each point and triangle, and `of_edge` with each two edges, one of them this cluster's and the other the
    /// `other`'s, whose boxes meet. They may have particles in common.
    pub(crate) fn meet(
        &self,
        other: &Self,
        of_point: &mut impl FnMut(u32, [u32; 3]),
        of_edge: &mut impl FnMut([u32; 2], [u32; 2]),
    ) {
        let apart = self.way - other.way;
        let (seen_here, seen_there) = (other.bounds.stretched(-apart), self.bounds.stretched(apart));
        if seen_there.meets(other.bounds) {
            self.points.meet(seen_here, &other.triangles, apart, &mut |[v], t| of_point(v, t));
            other.points.meet(seen_there, &self.triangles, -apart, &mut |[v], t| of_point(v, t));
            self.edges.meet(seen_here, &other.edges, apart, of_edge);
        }
    }

    /// The same for pairs of its own.
    pub(crate) fn meet_itself(
        &self,
        of_point: &mut impl FnMut(u32, [u32; 3]),
        of_edge: &mut impl FnMut([u32; 2], [u32; 2]),
    ) {
        self.points.meet(self.bounds, &self.triangles, Vec3::ZERO, &mut |[v], t| of_point(v, t));
        self.edges.meet(self.bounds, &self.edges, Vec3::ZERO, &mut |one, other| {
            if one < other {
                of_edge(one, other);
            }
        });
    }
}

impl<const N: usize> Primitives<N> {
    fn new(particles: Vec<[u32; N]>, all: &[u32]) -> Self {
        #[expect(clippy::cast_possible_truncation, reason = "below 24")]
        let place = |v: u32| all.partition_point(|&p| p < v) as u8;
        let places = particles.iter().map(|particles| particles.map(place)).collect();
        let boxes = vec![Group::NONE; particles.len().div_ceil(LANES)];
        Self { particles, places, boxes }
    }

    /// Takes boxes from those of the cluster's particles.
    fn follow(&mut self, of_particles: &[Aabb; N_PARTICLES]) {
        for (group, places) in self.boxes.iter_mut().zip(self.places.chunks(LANES)) {
            let mut boxes = [Aabb::EMPTY; LANES];
            for (b, places) in boxes.iter_mut().zip(places) {
                *b = places.iter().fold(Aabb::EMPTY, |b, &place| b.union(of_particles[place as usize]));
            }
            *group = Group::new(&boxes);
        }
    }

    /// Calls `found` with those in `bounds` and those of `others` whose boxes meet; these move `apart` \[m\] from those.
    fn meet<const M: usize>(
        &self,
        bounds: Aabb,
        others: &Primitives<M>,
        apart: Vec3,
        found: &mut impl FnMut([u32; N], [u32; M]),
    ) {
        for (group, particles) in self.boxes.iter().zip(self.particles.chunks(LANES)) {
            for lane in lanes(group.meeting(bounds)) {
                let own = group.lane(lane).stretched(apart);
                for (group, others) in others.boxes.iter().zip(others.particles.chunks(LANES)) {
                    lanes(group.meeting(own)).for_each(|other| found(particles[lane], others[other]));
                }
            }
        }
    }
}

impl Group {
    const NONE: Self = Self([f32x8::ZERO; 6]);

    fn new(boxes: &[Aabb; LANES]) -> Self {
        let least = [0, 1, 2].map(|axis| f32x8::new(boxes.map(|b| b.min[axis])));
        let most = [0, 1, 2].map(|axis| f32x8::new(boxes.map(|b| b.max[axis])));
        Self([least[0], least[1], least[2], most[0], most[1], most[2]])
    }

    /// A bit for each box that meets `b`.
    #[inline]
    fn meeting(&self, b: Aabb) -> u32 {
        let least = |axis: usize| self.0[axis].simd_le(f32x8::splat(b.max[axis]));
        let most = |axis: usize| self.0[3 + axis].simd_ge(f32x8::splat(b.min[axis]));
        (least(0) & least(1) & least(2) & most(0) & most(1) & most(2)).to_bitmask()
    }

    #[inline]
    fn lane(&self, k: usize) -> Aabb {
        let at = |side: usize| self.0[side].as_array()[k];
        Aabb { min: Vec3::new(at(0), at(1), at(2)), max: Vec3::new(at(3), at(4), at(5)) }
    }
}

/// How far a point of one box may be from one of the other \[m\]; never less for rounding.
fn farthest(one: Aabb, other: Aabb) -> f32 {
    let apart = |one: Aabb, other: Aabb| (one.max - other.min).abs();
    let size = |b: Aabb| b.min.abs().max(b.max.abs()).max_element();
    let most = apart(one, other).max(apart(other, one));
    most.length() * (1.0 + ROUNDING) + ROUNDING * (size(one) + size(other))
}

/// The lanes whose bits are set.
#[inline]
fn lanes(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = mask.trailing_zeros() as usize;
        mask &= mask.wrapping_sub(1);
        (lane < LANES).then_some(lane)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two triangles far from each other that end elsewhere than they were to: apart by as much as they differ in that, which also is
    /// whether any two may.
    #[test]
    fn what_ends_elsewhere_strays_by_the_difference() {
        let to: Vec<Vec3> =
            [0.0, 9.0].iter().flat_map(|&x| [Vec3::ZERO, Vec3::X, Vec3::Y].map(|p| p + x)).collect();
        let cluster = |first: u32| Cluster {
            particles: vec![first, first + 1, first + 2],
            points: Primitives::new(Vec::new(), &[]),
            edges: Primitives::new(Vec::new(), &[]),
            triangles: Primitives::new(Vec::new(), &[]),
            way: Vec3::ZERO,
            bounds: Aabb::EMPTY,
            astray: Aabb::EMPTY,
            is_stale: true,
        };
        let mut both = [cluster(0), cluster(3)];
        let strays = |both: &mut [Cluster; 2], by: [Vec3; 2]| {
            let ends: Vec<Vec3> = to.iter().enumerate().map(|(k, &p)| p + by[k / 3]).collect();
            both.iter_mut().for_each(|cluster| cluster.stray(&to, &ends));
            both[0].strays(&both[1])
        };
        let (one, other) = (Vec3::new(0.3, 0.0, 0.4), Vec3::new(0.3, 0.0, -0.1));
        assert!(strays(&mut both, [one, one]) < 1e-5);
        assert!(!Cluster::stray_apart(&both, 0.01));
        let apart = strays(&mut both, [one, other]);
        assert!((0.5..0.51).contains(&apart), "{apart}");
        assert!(Cluster::stray_apart(&both, 0.5) && !Cluster::stray_apart(&both, 0.51));
    }
}
