//! Singular values in `f64`.

use glam::{DMat3, DVec3};

/// U, σ, V with `f = U diag(σ) Vᵀ`: U and V are rotations, and σ descends; the last value has the sign of the determinant.
/// By one-sided Jacobi rotations (Hestenes 1958), which lose no digits of small values.
pub(crate) fn svd(f: DMat3) -> (DMat3, DVec3, DMat3) {
    const SWEEPS: usize = 30;
    let mut a = [f.x_axis, f.y_axis, f.z_axis];
    let mut v = DVec3::AXES;
    for _ in 0..SWEEPS {
        let mut is_done = true;
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            let (ii, jj, ij) = (a[i].length_squared(), a[j].length_squared(), a[i].dot(a[j]));
            if ij.abs() <= 1e-16 * (ii * jj).sqrt() {
                continue;
            }
            is_done = false;
            let zeta = (jj - ii) / (2.0 * ij);
            // Where zeta² overflows, t is 0 as it ought to be.
            let t = 1.0_f64.copysign(zeta) / (zeta.abs() + (1.0 + zeta * zeta).sqrt());
            let c = 1.0 / (1.0 + t * t).sqrt();
            for columns in [&mut a, &mut v] {
                (columns[i], columns[j]) =
                    (c * (columns[i] - t * columns[j]), c * (t * columns[i] + columns[j]));
            }
        }
        if is_done {
            break;
        }
    }
    for (i, j) in [(0, 1), (1, 2), (0, 1)] {
        if a[i].length_squared() < a[j].length_squared() {
            for columns in [&mut a, &mut v] {
                (columns[i], columns[j]) = (columns[j], -columns[i]);
            }
        }
    }
    let x = a[0].try_normalize().unwrap_or(DVec3::X);
    let rest = a[1] - x * x.dot(a[1]);
    // Columns shorter than rounding have no direction of their own.
    let has_direction = rest.length() > 1e-15 * a[0].length();
    let y = if has_direction { rest.normalize() } else { x.any_orthonormal_vector() };
    let u = DMat3::from_cols(x, y, x.cross(y));
    let sigma = DVec3::new(a[0].dot(x), a[1].dot(y), a[2].dot(u.z_axis));
    (u, sigma, DMat3::from_cols_array_2d(&v.map(|v| v.to_array())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn product_is_the_matrix_and_factors_are_rotations() {
        let f = DMat3::from_cols(
            DVec3::new(1.3, 0.2, -0.1),
            DVec3::new(0.1, 0.6, 0.4),
            DVec3::new(-0.2, 0.1, 1.2),
        );
        let mut flat = f;
        flat.y_axis = flat.x_axis * 0.5;
        for f in [f, -f, f.transpose(), f * 1e-3, flat, DMat3::ZERO, DMat3::IDENTITY, -DMat3::IDENTITY] {
            let (u, sigma, v) = svd(f);
            let back = u * DMat3::from_diagonal(sigma) * v.transpose();
            assert!((back - f).to_cols_array().iter().all(|d| d.abs() < 1e-14), "{f} {back}");
            for r in [u, v] {
                assert!((r * r.transpose()).abs_diff_eq(DMat3::IDENTITY, 1e-14), "{r}");
                assert!((r.determinant() - 1.0).abs() < 1e-14, "{r}");
            }
            assert!(sigma.x >= sigma.y && sigma.y >= sigma.z.abs() - 1e-15, "{sigma}");
        }
    }
}
