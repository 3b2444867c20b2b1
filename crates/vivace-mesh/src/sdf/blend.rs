//! Smooth unions of round cones, ellipsoids and rounded boxes, read from a text of one primitive to a line.
//!
//! ```text
//! # comment
//! blend K                         radius of the smooth union \[m\]
//! cone  x0 y0 z0 r0 x1 y1 z1 r1   distance to the segment minus the radius interpolated along it
//! ellip x y z rx ry rz            |q| (|q| - 1) / |g|,  q = (p - c) / r,  g = q / r
//! box   x y z hx hy hz r          distance to the box of half edges h - r about (x, y, z), less r
//! ```
//!
//! Primitives are folded in order: t = clamp(1/2 + (d - e) / 2K, 0, 1), d <- d (1 - t) + e t - K t (1 - t).

use std::str::FromStr;

use glam::DVec3;

use super::{Bounds, Cuboid, SignedDistance};
use crate::MeshError;

/// A smooth union of round cones, ellipsoids and rounded boxes.
#[derive(Debug, Clone, PartialEq)]
pub struct Blend {
    radius: f64,
    primitives: Vec<Primitive>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Primitive {
    Cone { start: DVec3, start_radius: f64, axis: DVec3, inv_length_squared: f64, growth: f64 },
    Ellipsoid { center: DVec3, radii: DVec3 },
    Rounded { core: Cuboid, radius: f64 },
}

impl SignedDistance for Blend {
    fn value(&self, point: DVec3) -> f64 {
        let mut value = f64::INFINITY;
        for primitive in &self.primitives {
            let other = primitive.value(point);
            value = if value < f64::INFINITY { smooth_min(value, other, self.radius) } else { other };
        }
        value
    }

    /// The union of the boxes of the primitives, each grown by the blend radius (see [`Blend::range`]).
    fn bounds(&self) -> Bounds {
        self.primitives.iter().map(|p| p.bounds(self.radius)).fold(Bounds::EMPTY, Bounds::union)
    }

    /// However many primitives are folded, the smooth union lies between the least of them and that less the blend radius:
    /// a fold step changes nothing once the value is a whole radius below the next primitive, and it is monotone.
    fn range(&self, center: DVec3, radius: f64) -> (f64, f64) {
        let (mut low, mut high) = (f64::INFINITY, f64::INFINITY);
        for primitive in &self.primitives {
            let (primitive_low, primitive_high) = primitive.range(center, radius);
            low = low.min(primitive_low);
            high = high.min(primitive_high);
        }
        (low - self.radius, high)
    }
}

fn smooth_min(a: f64, b: f64, radius: f64) -> f64 {
    if radius == 0.0 {
        return a.min(b);
    }
    let t = (0.5 + 0.5 * (a - b) / radius).clamp(0.0, 1.0);
    a * (1.0 - t) + b * t - radius * t * (1.0 - t)
}

impl Primitive {
    fn cone(start: DVec3, start_radius: f64, end: DVec3, end_radius: f64) -> Self {
        let axis = end - start;
        let length_squared = axis.length_squared();
        let inv_length_squared = if length_squared > 0.0 { 1.0 / length_squared } else { 0.0 };
        Self::Cone { start, start_radius, axis, inv_length_squared, growth: end_radius - start_radius }
    }

    fn value(&self, point: DVec3) -> f64 {
        match *self {
            Self::Cone { start, start_radius, axis, inv_length_squared, growth } => {
                let t = ((point - start).dot(axis) * inv_length_squared).clamp(0.0, 1.0);
                point.distance(start + t * axis) - (start_radius + t * growth)
            }
            Self::Ellipsoid { center, radii } => {
                let q = (point - center) / radii;
                let length = q.length();
                let slope = (q / radii).length();
                // At the center the quotient has a limit only along a ray; the nearest surface point is as good as any.
                if slope > 0.0 { length * (length - 1.0) / slope } else { -radii.min_element() }
            }
            Self::Rounded { core, radius } => core.value(point) - radius,
        }
    }

    /// Contains every point with a value of at most `margin`.
    fn bounds(&self, margin: f64) -> Bounds {
        match *self {
            Self::Cone { start, start_radius, axis, growth, .. } => {
                let half = |radius: f64| DVec3::splat((radius + margin).max(0.0));
                Bounds::around(start, half(start_radius))
                    .union(Bounds::around(start + axis, half(start_radius + growth)))
            }
            // |q| / |g| is at least the least radius, so a value of at most `margin` has |q| - 1 <= margin / least radius.
            Self::Ellipsoid { center, radii } => {
                Bounds::around(center, radii * (1.0 + margin / radii.min_element()))
            }
            Self::Rounded { core, radius } => Bounds::around(core.center, core.half_extent + radius + margin),
        }
    }

    fn range(&self, at: DVec3, radius: f64) -> (f64, f64) {
        match *self {
            Self::Cone { inv_length_squared, growth, .. } => {
                let change = radius * (1.0 + growth.abs() * inv_length_squared.sqrt());
                let value = self.value(at);
                (value - change, value + change)
            }
            Self::Ellipsoid { center, radii } => {
                let (least, most) = (radii.min_element(), radii.max_element());
                let length = ((at - center) / radii).length();
                let signed = |excess: f64, if_outside: f64, if_inside: f64| {
                    excess * if excess > 0.0 { if_outside } else { if_inside }
                };
                let nearest = (length - radius / least).max(0.0) - 1.0;
                let farthest = length + radius / least - 1.0;
                (signed(nearest, least, most), signed(farthest, most, least))
            }
            Self::Rounded { .. } => (self.value(at) - radius, self.value(at) + radius),
        }
    }
}

impl FromStr for Blend {
    type Err = MeshError;

    /// Reads the format of the module's head.
    ///
    /// # Errors
    /// [`MeshError::Line`] with the number of the line: an unknown word, a missing, superfluous or malformed number, a
    /// radius that is not positive. [`MeshError::Empty`] for a text without a primitive.
    fn from_str(text: &str) -> Result<Self, MeshError> {
        let mut blend = Self { radius: 0.0, primitives: Vec::new() };
        for (index, line) in text.lines().enumerate() {
            let content = line.split('#').next().unwrap_or_default();
            let mut words = content.split_whitespace();
            let Some(word) = words.next() else { continue };
            blend.add(word, words).map_err(|problem| MeshError::at(index + 1, problem))?;
        }
        if blend.primitives.is_empty() {
            return Err(MeshError::Empty { what: "cone, ellip and box lines" });
        }
        Ok(blend)
    }
}

impl Blend {
    fn add<'a>(&mut self, word: &str, numbers: impl Iterator<Item = &'a str>) -> Result<(), String> {
        match word {
            "blend" => {
                let [radius] = read(word, numbers)?;
                if radius < 0.0 {
                    return Err(format!("the blend radius {radius} is negative; give 0 for a sharp union"));
                }
                self.radius = radius;
            }
            "cone" => {
                let [x0, y0, z0, r0, x1, y1, z1, r1] = read(word, numbers)?;
                check_radii(&[r0, r1])?;
                self.primitives.push(Primitive::cone(DVec3::new(x0, y0, z0), r0, DVec3::new(x1, y1, z1), r1));
            }
            "ellip" => {
                let [x, y, z, rx, ry, rz] = read(word, numbers)?;
                check_radii(&[rx, ry, rz])?;
                let (center, radii) = (DVec3::new(x, y, z), DVec3::new(rx, ry, rz));
                self.primitives.push(Primitive::Ellipsoid { center, radii });
            }
            "box" => {
                let [x, y, z, hx, hy, hz, radius] = read(word, numbers)?;
                check_radii(&[hx, hy, hz])?;
                let (center, half_extent) = (DVec3::new(x, y, z), DVec3::new(hx, hy, hz));
                if !(0.0..=half_extent.min_element()).contains(&radius) {
                    return Err(format!(
                        "the radius {radius} of the edges is negative or above half an edge; give 0 for sharp ones"
                    ));
                }
                let core = Cuboid { center, half_extent: half_extent - radius };
                self.primitives.push(Primitive::Rounded { core, radius });
            }
            _ => {
                return Err(format!(
                    "unknown word '{word}'; begin the line with blend, cone, ellip, box or #"
                ));
            }
        }
        Ok(())
    }
}

fn read<'a, const N: usize>(
    word: &str,
    mut numbers: impl Iterator<Item = &'a str>,
) -> Result<[f64; N], String> {
    let mut values = [0.0; N];
    for (found, value) in values.iter_mut().enumerate() {
        let Some(text) = numbers.next() else {
            return Err(format!("'{word}' takes {N} numbers, found {found}; add the missing ones"));
        };
        *value = text
            .parse()
            .ok()
            .filter(|number: &f64| number.is_finite())
            .ok_or_else(|| format!("'{text}' is not a finite number; write it like 0.25"))?;
    }
    match numbers.next() {
        Some(text) => Err(format!("'{word}' takes {N} numbers, then comes '{text}'; remove it")),
        None => Ok(values),
    }
}

fn check_radii(radii: &[f64]) -> Result<(), String> {
    match radii.iter().find(|&&radius| radius <= 0.0) {
        Some(radius) => Err(format!("the radius {radius} is not positive; give a length in metres")),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn problem(text: &str) -> String {
        text.parse::<Blend>().unwrap_err().to_string()
    }

    #[test]
    fn one_cone_by_hand() {
        let blend: Blend = "cone 0 0 0 1  4 0 0 2 # grows".parse().unwrap();
        assert_eq!(blend.value(DVec3::new(2.0, 3.0, 0.0)), 1.5);
        assert_eq!(blend.value(DVec3::new(-3.0, 0.0, 0.0)), 2.0);
        assert_eq!(
            blend.bounds(),
            Bounds { min: DVec3::new(-1.0, -2.0, -2.0), max: DVec3::new(6.0, 2.0, 2.0) }
        );
    }

    #[test]
    fn one_ellipsoid_by_hand() {
        let blend: Blend = "ellip 0 0 0 2 1 1".parse().unwrap();
        assert_eq!(blend.value(DVec3::new(4.0, 0.0, 0.0)), 2.0);
        assert_eq!(blend.value(DVec3::new(0.0, 0.5, 0.0)), -0.5);
        assert_eq!(blend.value(DVec3::ZERO), -1.0);
    }

    #[test]
    fn one_rounded_box_by_hand() {
        let blend: Blend = "box 1 0 0 2 3 4 0.5".parse().unwrap();
        assert_eq!(blend.value(DVec3::new(4.0, 0.0, 0.0)), 1.0);
        assert_eq!(blend.value(DVec3::new(1.0, 0.0, 0.0)), -2.0);
        // From the corner of the core, (2.5, 2.5, 3.5).
        assert_eq!(blend.value(DVec3::new(2.5, 5.5, 7.5)), 4.5);
        assert_eq!(blend.bounds(), Bounds::around(DVec3::X, DVec3::new(2.0, 3.0, 4.0)));
        assert_eq!(blend.range(DVec3::new(4.0, 0.0, 0.0), 0.25), (0.75, 1.25));
    }

    #[test]
    fn equal_values_blend_by_a_quarter_of_the_radius() {
        let blend: Blend = "blend 0.4\ncone 0 0 0 1 0 0 0 1\ncone 0 0 0 1 0 0 0 1".parse().unwrap();
        assert!((blend.value(DVec3::X) + 0.1).abs() < 1e-15);
        let (low, high) = blend.range(DVec3::X, 0.0);
        assert!(low <= -0.1 && -0.1 <= high, "{low} .. {high}");
    }

    #[test]
    fn lines_are_named() {
        assert!(problem("# only talk").contains("no cone, ellip and box lines"));
        assert!(problem("blend 1\nsphere 1").starts_with("line 2: unknown word 'sphere'"));
        assert!(problem("ellip 0 0 0 1 1").contains("takes 6 numbers, found 5"));
        assert!(problem("ellip 0 0 0 1 1 1 1").contains("remove it"));
        assert!(problem("ellip 0 0 0 1 1 0").contains("not positive"));
        assert!(problem("box 0 0 0 1 1 1 1.5").contains("above half an edge"));
        assert!(problem("box 0 0 0 1 0 1 0").contains("not positive"));
        assert!(problem("cone 0 0 zero 1 1 1 1 1").contains("'zero' is not a finite number"));
        assert!(problem("blend nan").contains("not a finite number"));
        assert!(problem("blend -1").contains("negative"));
    }

    #[test]
    fn ranges_hold_on_samples() {
        let blend: Blend = crate::sdf::DILLO.parse().unwrap();
        let bounds = blend.bounds();
        for i in 0..20_u32 {
            let fraction =
                DVec3::new(f64::from(i % 3), f64::from(i % 5), f64::from(i % 7)) / DVec3::new(2.0, 4.0, 6.0);
            let center = bounds.min + fraction * bounds.size();
            let (low, high) = blend.range(center, 0.1);
            for j in 0..200_u32 {
                let angle = f64::from(j) * 2.4;
                let height = (f64::from(j) - 99.5) / 100.0;
                let ring = (1.0 - height * height).sqrt();
                let offset = DVec3::new(ring * angle.cos(), ring * angle.sin(), height) * 0.1;
                let value = blend.value(center + offset * f64::from(j % 4) / 3.0);
                assert!(low <= value && value <= high, "{value} not in [{low}, {high}] near {center}");
            }
        }
    }
}
