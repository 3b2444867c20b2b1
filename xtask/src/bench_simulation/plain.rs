//! The measure of all sweeps: what anybody would write.

use std::time::Instant;

use vivace_model::Model;

use crate::figures::FigureError;

/// A plain scalar Gauss-Seidel sweep in `f32` over the rows of Y (Eq. 1), three right-hand sides together, in the model's order.
#[derive(Clone, Debug)]
pub(super) struct Plain {
    offsets: Vec<u32>,
    columns: Vec<u32>,
    /// −Y_ij \[N/m\].
    weights: Vec<f32>,
    inverse_diagonal: Vec<f32>,
    b: Vec<[f32; 3]>,
    x: Vec<[f32; 3]>,
}

impl Plain {
    /// Y of the springs and hinges of `model` for steps of `h` \[s\].
    #[expect(clippy::cast_possible_truncation, reason = "matrices are f32")]
    pub(super) fn new(model: &Model, h: f32) -> Result<Self, FigureError> {
        let graph = model.graph()?;
        let (offsets, columns) = (graph.csr().offsets().to_vec(), graph.csr().items().to_vec());
        let n = model.n_particles();
        let mut weights = vec![0.0_f64; columns.len()];
        let mut diagonal: Vec<f64> =
            model.masses().iter().map(|mass| f64::from(*mass) / (f64::from(h) * f64::from(h))).collect();
        let mut add = |i: u32, j: u32, value: f64| {
            if i == j {
                diagonal[i as usize] += value;
            } else if let Ok(idx) = graph.neighbors(i).binary_search(&j) {
                weights[offsets[i as usize] as usize + idx] -= value;
            }
        };
        let constraints = model.constraints();
        for (&[a, b], spring) in constraints.springs.particles.iter().zip(&constraints.springs.rest) {
            let k = f64::from(spring.stiffness);
            for (i, j, value) in [(a, a, k), (b, b, k), (a, b, -k), (b, a, -k)] {
                add(i, j, value);
            }
        }
        for (particles, hinge) in constraints.bending.particles.iter().zip(&constraints.bending.rest) {
            for (&i, ci) in particles.iter().zip(hinge.row) {
                for (&j, cj) in particles.iter().zip(hinge.row) {
                    add(i, j, f64::from(hinge.weight) * f64::from(ci) * f64::from(cj));
                }
            }
        }
        Ok(Self {
            columns,
            weights: weights.into_iter().map(|w| w as f32).collect(),
            inverse_diagonal: diagonal.into_iter().map(|d| (1.0 / d) as f32).collect(),
            b: vec![[0.1, 0.2, 0.3]; n],
            x: vec![[0.0; 3]; n],
            offsets,
        })
    }

    /// One sweep. The bars are set against these very loops: written with iterators they take a quarter less time.
    #[expect(clippy::needless_range_loop, reason = "what is measured against does not change")]
    pub(super) fn sweep(&mut self) {
        for i in 0..self.x.len() {
            let mut sum = self.b[i];
            for k in self.offsets[i] as usize..self.offsets[i + 1] as usize {
                let q = self.x[self.columns[k] as usize];
                for c in 0..3 {
                    sum[c] += self.weights[k] * q[c];
                }
            }
            for c in 0..3 {
                self.x[i][c] = sum[c] * self.inverse_diagonal[i];
            }
        }
    }

    /// Time of one sweep \[ms\], the mean of a few, after one that warms the caches.
    pub(super) fn time(&mut self) -> f64 {
        const SWEEPS: u32 = 20;
        self.sweep();
        let start = Instant::now();
        for _ in 0..SWEEPS {
            self.sweep();
        }
        std::hint::black_box(&self.x);
        start.elapsed().as_secs_f64() * 1e3 / f64::from(SWEEPS)
    }

    /// Y among the particles that are not pinned, numbered anew: how many they are; row, column and
    /// value \[N/m\] of each entry.
    pub(super) fn entries(&self) -> (usize, Vec<(u32, u32, f32)>) {
        let mut free = 0..;
        let is_free = |inverse: &f32| *inverse > 0.0;
        let numbers: Vec<Option<u32>> = self
            .inverse_diagonal
            .iter()
            .map(|inverse| is_free(inverse).then(|| free.next()).flatten())
            .collect();
        let mut entries = Vec::new();
        for (i, row) in numbers.iter().enumerate() {
            let Some(row) = *row else { continue };
            entries.push((row, row, 1.0 / self.inverse_diagonal[i]));
            for k in self.offsets[i] as usize..self.offsets[i + 1] as usize {
                if let Some(column) = numbers[self.columns[k] as usize] {
                    entries.push((row, column, -self.weights[k]));
                }
            }
        }
        (numbers.iter().flatten().count(), entries)
    }

    /// Entries off the diagonal.
    #[cfg(test)]
    fn n_entries(&self) -> usize {
        self.columns.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench_simulation::scenes;

    #[test]
    fn sweeps_solve_the_system() {
        let (model, _) = scenes::cloth(6, 100.0, true).unwrap();
        let mut plain = Plain::new(&model, 1.0 / 30.0).unwrap();
        assert_eq!(plain.n_entries(), model.graph().unwrap().csr().len());
        for _ in 0..20_000 {
            plain.sweep();
        }
        let before = plain.x.clone();
        plain.sweep();
        let moved = before.iter().flatten().zip(plain.x.iter().flatten()).map(|(a, b)| (a - b).abs());
        let largest = plain.x.iter().flatten().fold(0.0_f32, |most, x| most.max(x.abs()));
        assert!(moved.fold(0.0_f32, f32::max) < 1e-5 * largest && largest > 0.0);

        let (n, entries) = plain.entries();
        let is_free = |i: &usize| plain.inverse_diagonal[*i] > 0.0;
        let free: Vec<usize> = (0..plain.x.len()).filter(is_free).collect();
        assert_eq!((n, free.len()), (6 * 6 - 2, 6 * 6 - 2));
        let mut left = vec![0.3; n];
        for (row, column, value) in entries {
            left[row as usize] -= value * plain.x[free[column as usize]][2];
        }
        assert!(left.iter().all(|left| left.abs() < 0.003), "{left:?}");
    }
}
