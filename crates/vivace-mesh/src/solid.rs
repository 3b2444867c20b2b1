//! Surfaces of simple solids, closed and oriented outwards.

use std::f32::consts::{FRAC_PI_2, TAU};

use glam::Vec3;

use crate::mesh::index32;
use crate::size::{check_count, check_length};
use crate::{MeshError, TriMesh};

/// The box that reaches from −`half_extent` to `half_extent` \[m\]: 8 vertices, 12 triangles.
///
/// # Errors
/// [`MeshError::Size`] for an edge that is not finite, below 10⁻¹² m or beyond [`MAX_COORDINATE`](crate::MAX_COORDINATE).
pub fn cuboid(half_extent: Vec3) -> Result<TriMesh, MeshError> {
    for half in half_extent.to_array() {
        check_length("half an edge of the box [m]", half, 1)?;
    }
    let sign = |corner: usize, bit: usize| if corner & bit == 0 { -1.0 } else { 1.0 };
    let corner = |k| half_extent * Vec3::new(sign(k, 1), sign(k, 2), sign(k, 4));
    let sides = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = sides.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]);
    TriMesh::new((0..8).map(corner).collect(), triangles.collect())
}

/// All within `radius` of the y axis from −`half_length` to `half_length` \[m\], a ball if that is 0: 4 `n` vertices around the axis.
///
/// # Errors
/// [`MeshError::Size`] if `n` is 0 or above 2^20, or a length is not finite, below 10⁻¹² m (`half_length` may be 0) or beyond
/// [`MAX_COORDINATE`](crate::MAX_COORDINATE).
pub fn capsule(half_length: f32, radius: f32, n: usize) -> Result<TriMesh, MeshError> {
    check_count("a quarter of the vertices around the axis", n, 1)?;
    check_length("the radius [m]", radius, 2)?;
    if half_length != 0.0 {
        check_length("half the length [m]", half_length, 2)?;
    }
    // From pole to pole; the equator once for each end.
    let latitude = |k: usize| FRAC_PI_2 * k as f32 / n as f32;
    let lower = (1..=n).map(|k| (-latitude(n - k), -half_length));
    let upper = (0..n).map(|k| (latitude(k), half_length)).skip(usize::from(half_length == 0.0));
    let rings: Vec<(f32, f32)> = lower.chain(upper).collect();

    let around = 4 * n;
    let mut positions = vec![-(half_length + radius) * Vec3::Y];
    for &(latitude, middle) in &rings {
        positions.extend((0..around).map(|k| {
            let longitude = TAU * k as f32 / around as f32;
            let out = Vec3::new(longitude.cos(), 0.0, longitude.sin()) * latitude.cos();
            radius * (out + latitude.sin() * Vec3::Y) + middle * Vec3::Y
        }));
    }
    positions.push((half_length + radius) * Vec3::Y);

    let (last, at) = (positions.len() - 1, |ring: usize, k: usize| index32(1 + ring * around + k % around));
    let mut triangles = Vec::with_capacity(2 * around * rings.len());
    for k in 0..around {
        triangles.push([0, at(0, k), at(0, k + 1)]);
        for ring in 1..rings.len() {
            let [a, b, c, d] = [at(ring - 1, k), at(ring - 1, k + 1), at(ring, k), at(ring, k + 1)];
            triangles.extend([[a, c, b], [b, c, d]]);
        }
        let top = rings.len() - 1;
        triangles.push([index32(last), at(top, k + 1), at(top, k)]);
    }
    TriMesh::new(positions, triangles)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn surfaces_enclose_the_volumes_of_their_solids() {
        let ball = |radius: f64| 4.0 / 3.0 * PI * radius.powi(3);
        for (mesh, volume, n_triangles) in [
            (cuboid(Vec3::new(1.0, 2.0, 3.0)), 48.0, 12),
            (capsule(0.0, 0.5, 16), ball(0.5), 64 * 2 * 31),
            (capsule(1.5, 0.5, 16), ball(0.5) + 0.25 * PI * 3.0, 64 * 2 * 32),
        ] {
            let mesh = mesh.unwrap();
            mesh.check_volume_boundary().unwrap();
            assert_eq!(mesh.triangles().len(), n_triangles);
            assert!((mesh.signed_volume() / volume - 1.0).abs() < 0.01, "{} {volume}", mesh.signed_volume());
        }
    }

    #[test]
    fn impossible_solids_are_refused() {
        assert!(cuboid(Vec3::new(1.0, 0.0, 1.0)).is_err() && cuboid(Vec3::splat(f32::NAN)).is_err());
        for (half_length, radius, n) in
            [(1.0, 1.0, 0), (1.0, 0.0, 4), (-1.0, 1.0, 4), (f32::INFINITY, 1.0, 4), (1.0, f32::NAN, 4)]
        {
            assert!(capsule(half_length, radius, n).is_err(), "{half_length} {radius} {n}");
        }
    }
}
