//! The signed distance to a closed triangle surface.
//!
//! The distance comes from the bounding volume hierarchy of parry3d. The sign does not: the sign of a pseudo-normal hangs
//! on one nearest triangle in `f32`, while the winding number counts all triangles along a ray and is exact (see
//! `winding.rs`). Overlapping parts are united, cavities (inner surfaces turned inwards) stay empty.

use glam::{DVec3, Vec3};
use parry3d::math::Vector;
use parry3d::query::PointQuery;
use parry3d::shape::TriMesh as ParryMesh;

use super::winding::Winding;
use super::{Bounds, SignedDistance};
use crate::{MeshError, TriMesh};

/// The solid inside a closed triangle surface.
pub struct ClosedSurface {
    bounds: Bounds,
    /// World = center + scale * local; local coordinates lie within [-1/2, 1/2], where `f32` is at its best.
    center: DVec3,
    scale: f64,
    distances: ParryMesh,
    winding: Winding,
}

/// Local height below which a triangle is left out of the distance (its neighbors' edges cover it): a sliver has no
/// reliable projection. It still counts for the sign.
const SLIVER_HEIGHT: f64 = 1e-7;

const NO_AREA: MeshError = MeshError::Empty { what: "triangles with an area" };

/// What `f32` may spoil in a distance, of the surface's extent.
const ROUNDING: f64 = 1e-5;

impl ClosedSurface {
    /// Prepares a surface whose triangles are counter-clockwise seen from outside.
    ///
    /// Isolated vertices are ignored, and surfaces that touch in a single vertex are accepted: neither spoils the inside.
    ///
    /// # Errors
    /// [`MeshError::Empty`] without a triangle that has an area. [`MeshError::NotAVolumeBoundary`] where an edge does not
    /// belong to two triangles (an open or non-manifold surface), where two neighbors run along their edge in the same
    /// direction, and when the volume enclosed is not positive (an inside-out surface).
    pub fn new(surface: &TriMesh) -> Result<Self, MeshError> {
        check_closed(surface.triangles())?;
        let points: Vec<DVec3> = surface.positions().iter().map(|&p| DVec3::from(p)).collect();
        let triangles = || surface.triangles().iter().map(|t| t.map(|v| points[v as usize]));

        let bounds =
            triangles().flatten().fold(Bounds::EMPTY, |bounds, p| bounds.union(Bounds { min: p, max: p }));
        let center = 0.5 * (bounds.min + bounds.max);
        let scale = bounds.size().max_element();
        if surface.triangles().is_empty() || scale <= 0.0 {
            return Err(NO_AREA);
        }
        let volume: f64 = triangles()
            .map(|t| t.map(|p| (p - center) / scale))
            .map(|[a, b, c]| a.dot(b.cross(c)) / 6.0)
            .sum();
        if volume <= 0.0 {
            let fault =
                format!("it encloses {} m^3, so its triangles face inwards", volume * scale * scale * scale);
            return Err(MeshError::NotAVolumeBoundary { fault });
        }

        let local: Vec<Vec3> = points.iter().map(|&p| ((p - center) / scale).as_vec3()).collect();
        let kept: Vec<[u32; 3]> = surface
            .triangles()
            .iter()
            .copied()
            .filter(|triangle| height(triangle.map(|v| local[v as usize])) > SLIVER_HEIGHT)
            .collect();
        let vertices = local.iter().map(|p| Vector::from_array(p.to_array())).collect();
        let distances = ParryMesh::new(vertices, kept).map_err(|_| NO_AREA)?;
        let corners = surface.triangles().iter().map(|t| t.map(|v| local[v as usize])).collect();
        Ok(Self { bounds, center, scale, distances, winding: Winding::new(corners) })
    }

    fn local(&self, point: DVec3) -> Vec3 {
        ((point - self.center) / self.scale).as_vec3()
    }
}

impl SignedDistance for ClosedSurface {
    fn value(&self, point: DVec3) -> f64 {
        let local = self.local(point);
        let distance = self.distances.distance_to_local_point(Vector::from_array(local.to_array()), false);
        // Parry's own sign (is the point behind the nearest triangle?) is dropped.
        let distance = f64::from(distance.abs()) * self.scale;
        if self.winding.around(local) > 0 { -distance } else { distance }
    }

    fn bounds(&self) -> Bounds {
        self.bounds
    }

    fn range(&self, center: DVec3, radius: f64) -> (f64, f64) {
        let value = self.value(center);
        let slack = radius + ROUNDING * self.scale;
        (value - slack, value + slack)
    }
}

/// The least height of a triangle; 0 when it has no area.
fn height(triangle: [Vec3; 3]) -> f64 {
    let [a, b, c] = triangle.map(DVec3::from);
    let longest = (b - a).length().max((c - b).length()).max((a - c).length());
    if longest > 0.0 { (b - a).cross(c - a).length() / longest } else { 0.0 }
}

/// Every edge must belong to two triangles, which run along it in opposite directions.
#[expect(clippy::cast_possible_truncation, reason = "triangles are numbered in 32 bits by their mesh")]
fn check_closed(triangles: &[[u32; 3]]) -> Result<(), MeshError> {
    let mut edges: Vec<([u32; 2], bool, u32)> = Vec::with_capacity(3 * triangles.len());
    for (index, &[a, b, c]) in triangles.iter().enumerate() {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            edges.push(([from.min(to), from.max(to)], from < to, index as u32));
        }
    }
    edges.sort_unstable();
    for group in edges.chunk_by(|one, other| one.0 == other.0) {
        let ([from, to], _, triangle) = group[0];
        if from == to {
            let (element, index) = ("triangle", triangle as usize);
            return Err(MeshError::RepeatedVertex { element, index, vertex: from });
        }
        match *group {
            [(_, one, _), (_, other, _)] if one != other => {}
            [(_, _, one), (_, _, other)] => {
                let fault = format!(
                    "triangles {one} and {other} run along their edge ({from}, {to}) in the same direction"
                );
                return Err(MeshError::NotAVolumeBoundary { fault });
            }
            _ => {
                let sharing = group.len();
                let kind = if sharing == 1 { "open" } else { "not manifold" };
                let fault = format!(
                    "it is {kind} at edge ({from}, {to}), which has {sharing} triangle(s) instead of 2"
                );
                return Err(MeshError::NotAVolumeBoundary { fault });
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube() -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let corner = |i: u8| Vec3::new(f32::from(i & 1), f32::from(i >> 1 & 1), f32::from(i >> 2 & 1));
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        ((0..8).map(corner).collect(), triangles)
    }

    fn solid(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Result<ClosedSurface, MeshError> {
        ClosedSurface::new(&TriMesh::new(positions, triangles).unwrap())
    }

    #[test]
    fn cube_by_hand() {
        let (positions, triangles) = cube();
        let cube = solid(positions, triangles).unwrap();
        for (point, expected) in [
            ([0.5, 0.5, 0.5], -0.5),
            ([0.5, 0.5, 0.75], -0.25),
            ([0.5, 0.5, 1.5], 0.5),
            ([-3.0, 0.5, -4.0], 5.0),
            ([0.25, 0.5, 0.5], -0.25),
        ] {
            let value = cube.value(DVec3::from_array(point));
            assert!((value - expected).abs() < 1e-6, "{value} at {point:?}");
        }
    }

    #[test]
    fn hostile_surfaces_are_refused_by_name() {
        let fault = |positions: &[Vec3], triangles: Vec<[u32; 3]>| {
            solid(positions.to_vec(), triangles).err().map_or(String::new(), |error| error.to_string())
        };
        let (positions, mut triangles) = cube();
        let last = triangles.pop().unwrap();
        assert!(fault(&positions, triangles.clone()).contains("open at edge (1, 5), which has 1"));
        let mut fin = triangles.clone();
        fin.extend([last, [0, 1, 6]]);
        assert!(fault(&positions, fin).contains("not manifold at edge (0, 1), which has 3"));
        let mut turned = triangles.clone();
        turned.push([last[0], last[2], last[1]]);
        assert!(fault(&positions, turned).contains("run along their edge (1, 5) in the same direction"));
        let inside_out = cube().1.iter().map(|&[a, b, c]| [a, c, b]).collect();
        assert!(fault(&positions, inside_out).contains("-1 m^3"));
        assert_eq!(solid(positions, Vec::new()).err(), Some(NO_AREA));
        assert_eq!(solid(vec![Vec3::ONE; 3], vec![[0, 1, 2], [0, 2, 1]]).err(), Some(NO_AREA));
    }

    #[test]
    fn an_isolated_vertex_far_away_changes_nothing() {
        let (mut positions, triangles) = cube();
        positions.push(Vec3::splat(1e12));
        let cube = solid(positions, triangles).unwrap();
        assert_eq!(cube.bounds(), Bounds { min: DVec3::ZERO, max: DVec3::ONE });
        assert!((cube.value(DVec3::splat(0.5)) + 0.5).abs() < 1e-6);
    }

    #[test]
    fn scale_and_offset_do_not_matter() {
        let (positions, triangles) = cube();
        let moved = positions.iter().map(|p| 1e11 * (*p + 3.0)).collect();
        let cube = solid(moved, triangles).unwrap();
        let value = cube.value(DVec3::splat(3.25e11));
        assert!((value / -0.25e11 - 1.0).abs() < 1e-5, "{value}");
    }
}
