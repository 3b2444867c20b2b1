//! Colors: a map for scalars, and the way between sRGB and light.

#![expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "pixel arithmetic")]

use glam::Vec3;

/// What stands for a scalar that is no number.
const NO_NUMBER: Vec3 = Vec3::new(0.5, 0.5, 0.5);

/// Viridis as a polynomial of degree 6, within a hundredth of the tabulated map.
const VIRIDIS: [Vec3; 7] = [
    Vec3::new(0.277_727_34, 0.005_407_344_6, 0.334_099_8),
    Vec3::new(0.105_093_04, 1.404_613_5, 1.384_590_1),
    Vec3::new(-0.330_861_84, 0.214_847_56, 0.095_095_165),
    Vec3::new(-4.634_23, -5.799_101, -19.332_441),
    Vec3::new(6.228_27, 14.179_934, 56.690_55),
    Vec3::new(4.776_385, -13.745_145, -65.353_03),
    Vec3::new(-5.435_456, 4.645_852_6, 26.312_435),
];

/// The color of a scalar in sRGB: from dark violet at 0 over green to yellow at 1, evenly in lightness; gray for NaN.
pub fn color_map(share: f32) -> [u8; 3] {
    bytes(viridis(share))
}

/// As [`color_map`], as light.
pub(super) fn map_light(share: f32) -> Vec3 {
    to_light(viridis(share))
}

/// The light of an sRGB color.
pub(super) fn light_of(color: [u8; 3]) -> Vec3 {
    to_light(Vec3::from(color.map(f32::from)) / 255.0)
}

/// The sRGB color of light.
pub(super) fn color_of(light: Vec3) -> [u8; 3] {
    bytes(light.max(Vec3::ZERO).powf(1.0 / 2.2))
}

fn to_light(color: Vec3) -> Vec3 {
    color.powf(2.2)
}

fn viridis(share: f32) -> Vec3 {
    if share.is_nan() {
        return NO_NUMBER;
    }
    let t = share.clamp(0.0, 1.0);
    let color = VIRIDIS.iter().rev().fold(Vec3::ZERO, |sum, &term| sum * t + term);
    color.clamp(Vec3::ZERO, Vec3::ONE)
}

fn bytes(color: Vec3) -> [u8; 3] {
    color.to_array().map(|part| (part.clamp(0.0, 1.0) * 255.0).round() as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_map_ends_in_violet_and_yellow_and_grows_lighter() {
        let near = |color: [u8; 3], want: [u8; 3]| color.iter().zip(want).all(|(&a, b)| a.abs_diff(b) <= 6);
        assert!(near(color_map(0.0), [68, 1, 84]), "{:?}", color_map(0.0));
        assert!(near(color_map(0.5), [33, 145, 140]), "{:?}", color_map(0.5));
        assert!(near(color_map(1.0), [253, 231, 37]), "{:?}", color_map(1.0));
        assert_eq!(color_map(f32::INFINITY), color_map(1.0));
        assert_eq!(color_map(f32::NAN), [128; 3]);
        let lightness =
            |k: u8| map_light(f32::from(k) / 16.0).dot(Vec3::new(0.2126, 0.7152, 0.0722)).powf(1.0 / 3.0);
        let steps: Vec<f32> = (0..16).map(|k| lightness(k + 1) - lightness(k)).collect();
        assert!(steps.iter().all(|&step| step > 0.015 && step < 0.08), "{steps:?}");
    }

    #[test]
    fn colors_survive_the_way_to_light_and_back() {
        for level in 0..=255 {
            let color = [level, 255 - level, level / 2];
            assert_eq!(color_of(light_of(color)), color);
        }
    }
}
