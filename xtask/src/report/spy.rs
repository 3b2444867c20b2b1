//! Pictures of sparse matrices: how dense the nonzeros are in the cell of the matrix under each pixel.

#![expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "pixel arithmetic")]

use super::error::ReportError;
use super::grid::Cell;
use super::raster;

/// Pixels along each side of a matrix picture.
const PIXELS: u32 = 400;

/// Darkness of a pixel that holds a single nonzero, where few pixels hold any.
const FAINTEST: f64 = 0.3;

/// Mean darkness above which a picture is lightened: a matrix whose nonzeros lie everywhere shows as gray, not black.
const DARKEST_MEAN: f64 = 0.33;

/// Draws an `n` by `n` matrix with the given nonzeros.
///
/// `blocks` holds the number of rows of each color, in order; lines are drawn between the blocks, and the blocks on
/// the diagonal are tinted, since a proper coloring leaves them empty. It may be empty. `lines` go under the picture.
/// Entries outside the matrix are passed over. Time and memory do not grow with `n`, only with the nonzeros.
pub fn spy(
    n: usize,
    nonzeros: impl IntoIterator<Item = (usize, usize)>,
    blocks: &[usize],
    lines: &[String],
) -> Result<Cell, ReportError> {
    let density = density(n, nonzeros);
    let levels = gray_levels(&density);
    let png = raster::png_from_gray16("matrix", PIXELS, PIXELS, &levels)?;
    let mut bounds = vec![0.0];
    let mut total = 0.0;
    for block in blocks {
        total += *block as f64;
        bounds.push((total / n.max(1) as f64).min(1.0));
    }
    let bounds = if blocks.is_empty() { Vec::new() } else { bounds };
    Ok(Cell { png, blocks: bounds, lines: lines.to_vec() })
}

/// Nonzeros in each pixel; one smaller than a pixel is shared between its neighbors, a larger one covers many with 1.
fn density(n: usize, nonzeros: impl IntoIterator<Item = (usize, usize)>) -> Vec<f32> {
    let side = PIXELS as usize;
    let mut density = vec![0.0f32; side * side];
    let scale = side as f64 / n.max(1) as f64;
    // At least one pixel wide: a share of at most four pixels, so a lone entry stays visible and does not flicker.
    let reach = scale.max(1.0) / 2.0;
    for (row, column) in nonzeros {
        if row >= n || column >= n {
            continue;
        }
        let (y, x) = ((row as f64 + 0.5) * scale, (column as f64 + 0.5) * scale);
        for py in pixels(y, reach) {
            let share = overlap(py, y, reach);
            let line = &mut density[py * side..(py + 1) * side];
            for px in pixels(x, reach) {
                line[px] += (share * overlap(px, x, reach)) as f32;
            }
        }
    }
    density
}

/// Pixels that reach from `at` to either side touches.
fn pixels(at: f64, reach: f64) -> std::ops::Range<usize> {
    (at - reach).max(0.0) as usize..((at + reach).ceil() as usize).min(PIXELS as usize)
}

/// Length of the touched part of a pixel.
fn overlap(pixel: usize, at: f64, reach: f64) -> f64 {
    let low = pixel as f64;
    ((at + reach).min(low + 1.0) - (at - reach).max(low)).max(0.0)
}

/// Darkness grows with the logarithm of the density, up to the densest percent of the pixels that hold anything.
fn gray_levels(density: &[f32]) -> Vec<u8> {
    let mut held: Vec<f32> = density.iter().copied().filter(|d| *d > 0.0).collect();
    let dense = if held.is_empty() {
        1.0
    } else {
        let at = (held.len() - 1) * 99 / 100;
        f64::from(*held.select_nth_unstable_by(at, f32::total_cmp).1).max(1.0)
    };
    let tone = |d: f64| (FAINTEST + (1.0 - FAINTEST) * (1.0 + d).ln() / (1.0 + dense).ln()).clamp(0.0, 1.0);
    let darkness = |d: f32, contrast: f64| match f64::from(d) {
        d if d < 1.0 => d.sqrt() * tone(1.0).powf(contrast),
        d => tone(d).powf(contrast),
    };
    let mean = |contrast: f64| {
        density.iter().map(|d| darkness(*d, contrast)).sum::<f64>() / density.len().max(1) as f64
    };
    let steps = [1.0, 1.4, 2.0, 2.8, 4.0, 5.6];
    let contrast = steps.into_iter().find(|&contrast| mean(contrast) <= DARKEST_MEAN);
    // Where every pixel is equally dense, no contrast helps.
    let contrast = contrast.unwrap_or(if mean(5.6) > 0.9 { 1.0 } else { 5.6 });
    density.iter().map(|d| (15.0 * (1.0 - darkness(*d, contrast))).round() as u8).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mass_is_kept_for_large_matrices_and_coverage_for_small_ones() {
        let large: f64 =
            density(1_000_000, (0..1000).map(|k| (k * 997, k * 311))).iter().map(|d| f64::from(*d)).sum();
        assert!((large - 1000.0).abs() < 2.0, "{large}");
        let small = density(2, [(0, 0), (1, 1)]);
        let side = PIXELS as usize;
        assert_eq!((small[0], small[side - 1]), (1.0, 0.0));
        assert!((small.iter().sum::<f32>() - (side * side / 2) as f32).abs() < 1.0);
    }

    #[test]
    fn empty_full_and_wrong_entries() {
        assert!(gray_levels(&density(0, [(0, 0)])).iter().all(|&level| level == 15));
        assert!(gray_levels(&density(5, [(5, 0), (0, 9)])).iter().all(|&level| level == 15));
        assert!(gray_levels(&density(1, [(0, 0)])).iter().all(|&level| level == 0));
    }

    #[test]
    fn a_lone_entry_of_a_huge_matrix_is_visible() {
        let levels = gray_levels(&density(1_000_000, [(500_003, 20_001)]));
        assert!(levels.iter().any(|&level| level < 11));
    }

    #[test]
    fn a_cell_holds_a_picture_and_its_blocks() {
        let cell = spy(100, (0..99).map(|k| (k, k + 1)), &[50, 30, 20], &["3 colors".to_owned()]).unwrap();
        let (width, height, colors) = raster::tests::inspect(&cell.png);
        assert_eq!((width, height), (PIXELS, PIXELS));
        assert!(colors > 1);
        assert_eq!(cell.blocks, [0.0, 0.5, 0.8, 1.0]);
    }
}
