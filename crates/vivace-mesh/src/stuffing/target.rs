//! The cell size for a wanted number of tetrahedra or vertices.

use super::StuffingReport;
use crate::{MeshError, TetMesh};

/// Near enough, as a share of the wanted number.
const TOLERANCE: f64 = 0.02;
/// Trials before the nearest one has to do. Most searches end after three.
const MAX_TRIALS: usize = 8;

/// One trial: the cell size \[m\] and the number it gave.
#[derive(Debug, Clone, Copy)]
struct Trial {
    cell_size: f64,
    count: f64,
}

/// Calls `fill` with one cell size \[m\] after another, until `count` of the mesh comes close to `wanted`. `extent` \[m\] is the
/// largest of the shape.
///
/// A volume V with surface A holds about a V / h^3 - b A / h^2 of anything, so `count h^3` falls in a straight line with h: two
/// trials give the line. The trials before the last are coarse and cheap.
pub(super) fn search(
    extent: f64,
    wanted: usize,
    fill: impl Fn(f64) -> Result<(TetMesh, StuffingReport), MeshError>,
    count: impl Fn(&TetMesh) -> usize,
) -> Result<(TetMesh, StuffingReport), MeshError> {
    if wanted == 0 {
        return Err(MeshError::Size { what: "the wanted number", value: 0.0, need: "at least 1" });
    }
    if wanted >= u32::MAX as usize {
        return Err(MeshError::TooLarge { what: "wanted elements", count: wanted });
    }
    if extent == 0.0 {
        return Err(MeshError::EmptyShape { cell_size: 0.0 });
    }
    let wanted = wanted as f64;
    let mut cell_size = extent / 16.0;
    let mut trials: Vec<Trial> = Vec::new();
    let mut best: Option<(TetMesh, StuffingReport)> = None;
    let (mut best_miss, mut n_values, mut n_trials) = (f64::INFINITY, 0, 0);
    while n_trials < MAX_TRIALS && best_miss > TOLERANCE {
        n_trials += 1;
        match fill(cell_size) {
            // Too coarse for a thin shape.
            Err(MeshError::EmptyShape { .. }) if n_trials < MAX_TRIALS => {
                cell_size *= 0.5;
                continue;
            }
            Err(error) if best.is_none() => return Err(error),
            // A cell size that fails after others have worked: the best of them has to do.
            Err(_) => break,
            Ok((mesh, report)) => {
                let trial = Trial { cell_size, count: count(&mesh) as f64 };
                n_values += report.n_values;
                let miss = (trial.count / wanted - 1.0).abs();
                if miss < best_miss {
                    best_miss = miss;
                    best = Some((mesh, report));
                }
                trials.push(trial);
                // From far below, another coarse trial comes first: a line through tiny meshes is a bad guide.
                let next = if trial.count < 0.1 * wanted { 0.2 * wanted } else { wanted };
                cell_size = next_cell_size(&mut trials, next);
            }
        }
    }
    let (mesh, report) = best.ok_or(MeshError::EmptyShape { cell_size })?;
    Ok((mesh, StuffingReport { n_values, n_trials, ..report }))
}

/// Where the line through the two trials nearest to `wanted` (or the cubic law through one) reaches it.
fn next_cell_size(trials: &mut [Trial], wanted: f64) -> f64 {
    trials.sort_by(|one, other| miss(*one, wanted).total_cmp(&miss(*other, wanted)));
    let nearest = trials[0];
    let scaled = |trial: Trial| trial.count * trial.cell_size * trial.cell_size * trial.cell_size;
    let slope = match trials.get(1) {
        Some(&second) if second.cell_size != nearest.cell_size => {
            // A rising line comes from sampling noise only.
            ((scaled(second) - scaled(nearest)) / (second.cell_size - nearest.cell_size)).min(0.0)
        }
        _ => 0.0,
    };
    let excess = |cell_size: f64| {
        let law = scaled(nearest) + slope * (cell_size - nearest.cell_size);
        wanted * cell_size * cell_size * cell_size - law
    };
    // `excess` rises with the cell size, from below zero: bisection, in arithmetic that is the same on every machine.
    let (mut low, mut high) = (0.05 * nearest.cell_size, 20.0 * nearest.cell_size);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if excess(middle) < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

fn miss(trial: Trial, wanted: f64) -> f64 {
    (trial.count - wanted).abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_trial_gives_the_cubic_law_and_two_the_line() {
        let mut trials = vec![Trial { cell_size: 0.2, count: 1000.0 }];
        assert!((next_cell_size(&mut trials, 8000.0) - 0.1).abs() < 1e-12);
        let law = |h: f64| 12.0 / (h * h * h) - 3.0 / (h * h);
        let mut trials =
            vec![0.2, 0.1].into_iter().map(|h| Trial { cell_size: h, count: law(h) }).collect::<Vec<_>>();
        assert!((next_cell_size(&mut trials, law(0.03)) - 0.03).abs() < 1e-12);
    }
}
