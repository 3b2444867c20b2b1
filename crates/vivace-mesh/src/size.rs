//! Checks of what the generators are asked for.

use crate::{MAX_COORDINATE, MeshError};

/// The largest count along one side of a generated mesh: `f32` still tells grid points from their neighbors there, jittered or
/// not.
pub(crate) const MAX_SIDE: usize = 1 << 20;

/// A count along a side: at least `min`, at most [`MAX_SIDE`].
pub(crate) fn check_count(what: &'static str, n: usize, min: usize) -> Result<(), MeshError> {
    if (min..=MAX_SIDE).contains(&n) {
        return Ok(());
    }
    let need = match min {
        ..=1 => "between 1 and 1048576",
        _ => "between 2 and 1048576",
    };
    Err(MeshError::Size { what, value: n as f64, need })
}

/// The smallest length \[m\] that generated meshes are made of: the volume of a cube of it is not lost to the range of `f32`.
const MIN_LENGTH: f32 = 1e-12;

/// A length \[m\]: finite, at least [`MIN_LENGTH`], and `n` of them at most [`MAX_COORDINATE`].
pub(crate) fn check_length(what: &'static str, length: f32, n: usize) -> Result<(), MeshError> {
    let value = f64::from(length);
    if !(length.is_finite() && length >= MIN_LENGTH) {
        return Err(MeshError::Size { what, value, need: "finite and at least 1e-12 m" });
    }
    if value * n as f64 > f64::from(MAX_COORDINATE) {
        return Err(MeshError::Size { what, value, need: "so small that no coordinate exceeds 1e12 m" });
    }
    Ok(())
}

/// A product of counts: fewer than 2^32 - 1, so that 32-bit indices suffice.
pub(crate) fn check_total(what: &'static str, factors: &[usize]) -> Result<(), MeshError> {
    let count = factors.iter().fold(1_usize, |product, &n| product.saturating_mul(n));
    if count < u32::MAX as usize { Ok(()) } else { Err(MeshError::TooLarge { what, count }) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_say_what_and_how() {
        let message = check_count("the number of cells", 0, 1).unwrap_err().to_string();
        assert_eq!(message, "the number of cells is 0, but must be between 1 and 1048576");
        let message = check_length("the radius [m]", -1.0, 1).unwrap_err().to_string();
        assert_eq!(message, "the radius [m] is -1, but must be finite and at least 1e-12 m");
        assert!(check_total("vertices", &[usize::MAX, usize::MAX]).is_err());
        assert!(check_total("vertices", &[u32::MAX as usize - 1]).is_ok());
    }
}
