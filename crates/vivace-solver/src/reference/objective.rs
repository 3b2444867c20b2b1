//! What implicit Euler minimizes (Liu et al. 2013, Bouaziz et al. 2014), in `f64`.

use std::fmt;

use glam::{DMat3, DVec3};
use vivace_model::{Constraints, Model, Store};

use super::kinds::Exact;
use crate::cholesky::Pattern;

/// `g(x) = 1/(2h²) Σ m |x − s|² + Σ W(x)` \[J\], with pinned particles where s has them.
#[derive(Debug)]
pub(crate) struct Objective {
    /// m/h² \[N/m\], 0 where the particle is pinned.
    inertia: Vec<f64>,
    terms: Vec<Box<dyn Term>>,
    /// The particles that move.
    pub(crate) free: Vec<u32>,
    /// The number of each particle among those that move, `PINNED` for the others.
    place: Vec<u32>,
    /// Where Y has entries.
    pub(crate) pattern: Pattern,
    /// Whether [`Objective::hessian`] is the Hessian: of strains it is an upper bound.
    pub(crate) is_hessian_exact: bool,
    /// Whether it is more than Y: where all constraints are strains it is the same.
    pub(crate) is_hessian_worth_it: bool,
}

const PINNED: u32 = u32::MAX;

/// The constraints of one kind.
trait Term: fmt::Debug + Send + Sync {
    /// Returns W \[J\] and adds its gradient \[N\].
    fn add_gradient(&self, x: &[DVec3], gradient: &mut [DVec3]) -> f64;
    /// Shows particles, and the block of the Hessian that belongs to them: with `None` the block of Y.
    fn blocks(&self, x: Option<&[DVec3]>, add: &mut dyn FnMut(u32, u32, DMat3));
    fn set_target(&mut self, idx: usize, target: glam::Vec3);
}

#[derive(Debug)]
struct KindTerm<C, const N: usize, const R: usize> {
    elements: Vec<Element<C, N, R>>,
}

#[derive(Debug)]
struct Element<C, const N: usize, const R: usize> {
    particles: [u32; N],
    rest: C,
    weight: f64,
    columns: [[f64; R]; N],
}

impl<C: Exact<N, R>, const N: usize, const R: usize> KindTerm<C, N, R> {
    fn new(store: &Store<C, N>) -> Self {
        let element = |(&particles, &rest): (&[u32; N], &C)| {
            let mut columns: [[f64; R]; N] = std::array::from_fn(|slot| rest.column(slot).map(f64::from));
            // Rounded to `f32`, rows add up to almost 0; here they do exactly.
            if N > 1 {
                columns[0] =
                    std::array::from_fn(|row| -columns[1..].iter().map(|column| column[row]).sum::<f64>());
            }
            Element { particles, rest, weight: f64::from(rest.weight()), columns }
        };
        Self { elements: store.particles.iter().zip(&store.rest).map(element).collect() }
    }
}

impl<C: Exact<N, R>, const N: usize, const R: usize> Element<C, N, R> {
    fn apply(&self, x: &[DVec3]) -> [DVec3; R] {
        let q = self.particles.map(|particle| x[particle as usize]);
        let origin = if N > 1 { q[0] } else { DVec3::ZERO };
        std::array::from_fn(|row| (0..N).map(|slot| self.columns[slot][row] * (q[slot] - origin)).sum())
    }

    /// B in the Hessian `w Aᵀ B A`. With more than one row 1, which is an upper bound.
    fn curvature(&self, x: &[DVec3]) -> DMat3 {
        let aq = self.apply(x);
        let length = aq[0].length();
        if R > 1 || self.rest.is_linear() || length == 0.0 {
            return DMat3::IDENTITY;
        }
        // p is on a sphere around 0, so it turns as A q does.
        let across = 1.0 - self.rest.project_exactly(aq)[0].length() / length;
        let u = aq[0] / length;
        let along = DMat3::from_cols(u * u.x, u * u.y, u * u.z);
        along * (1.0 - across) + DMat3::from_diagonal(DVec3::splat(across))
    }
}

impl<C: Exact<N, R>, const N: usize, const R: usize> Term for KindTerm<C, N, R> {
    fn add_gradient(&self, x: &[DVec3], gradient: &mut [DVec3]) -> f64 {
        let mut energy = 0.0;
        for element in &self.elements {
            let aq = element.apply(x);
            let p = element.rest.project_exactly(aq);
            let residual: [DVec3; R] = std::array::from_fn(|row| aq[row] - p[row]);
            energy += 0.5 * element.weight * residual.iter().map(|r| r.length_squared()).sum::<f64>();
            for (&particle, column) in element.particles.iter().zip(&element.columns) {
                let pull: DVec3 = column.iter().zip(&residual).map(|(&a, &r)| a * r).sum();
                gradient[particle as usize] += element.weight * pull;
            }
        }
        energy
    }

    fn blocks(&self, x: Option<&[DVec3]>, add: &mut dyn FnMut(u32, u32, DMat3)) {
        for element in &self.elements {
            let block = element.weight * x.map_or(DMat3::IDENTITY, |x| element.curvature(x));
            for (&i, a) in element.particles.iter().zip(&element.columns) {
                for (&j, b) in element.particles.iter().zip(&element.columns) {
                    add(i, j, block * a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>());
                }
            }
        }
    }

    fn set_target(&mut self, idx: usize, target: glam::Vec3) {
        if let Some(element) = self.elements.get_mut(idx) {
            element.rest.set_target(target);
        }
    }
}

impl Objective {
    /// Of a step of `h` \[s\].
    pub(crate) fn new(model: &Model, h: f64) -> Self {
        let inertia: Vec<f64> = model
            .masses()
            .iter()
            .map(|&m| if m.is_finite() { f64::from(m) / (h * h) } else { 0.0 })
            .collect();
        // Taken apart, so that a new kind cannot be forgotten.
        let Constraints { springs, bending, triangle_strain, tet_strain, tet_volume, attachments } =
            model.constraints();
        let terms: Vec<Box<dyn Term>> = vec![
            Box::new(KindTerm::new(attachments)),
            Box::new(KindTerm::new(springs)),
            Box::new(KindTerm::new(bending)),
            Box::new(KindTerm::new(triangle_strain)),
            Box::new(KindTerm::new(tet_strain)),
            Box::new(KindTerm::new(tet_volume)),
        ];
        let is_hessian_exact = triangle_strain.is_empty() && tet_strain.is_empty() && tet_volume.is_empty();
        let is_hessian_worth_it = is_hessian_exact || !springs.is_empty() || !bending.is_empty();
        let mut place = vec![PINNED; inertia.len()];
        let all = (0..).take(inertia.len());
        let free: Vec<u32> = all.filter(|&particle| !model.is_pinned(particle)).collect();
        for (number, &particle) in (0..).zip(&free) {
            place[particle as usize] = number;
        }
        let mut objective = Self {
            inertia,
            terms,
            free,
            place,
            pattern: Pattern::default(),
            is_hessian_exact,
            is_hessian_worth_it,
        };
        objective.pattern = objective.find_pattern();
        objective
    }

    fn find_pattern(&self) -> Pattern {
        let mut columns: Vec<Vec<u32>> = (0..).take(self.free.len()).map(|number| vec![number]).collect();
        for term in &self.terms {
            term.blocks(None, &mut |i, j, _| {
                let (i, j) = (self.place[i as usize], self.place[j as usize]);
                if i != PINNED && j != PINNED && i > j {
                    columns[j as usize].push(i);
                }
            });
        }
        let mut pattern = Pattern { offsets: vec![0], rows: Vec::new() };
        for mut column in columns {
            column.sort_unstable();
            column.dedup();
            pattern.rows.extend(column);
            pattern.offsets.push(u32::try_from(pattern.rows.len()).unwrap_or(u32::MAX));
        }
        pattern
    }

    /// Returns g(x) \[J\] and writes its gradient \[N\], 0 where a particle is pinned.
    pub(crate) fn evaluate(&self, x: &[DVec3], predicted: &[DVec3], gradient: &mut [DVec3]) -> f64 {
        gradient.fill(DVec3::ZERO);
        let mut g: f64 = self.terms.iter().map(|term| term.add_gradient(x, gradient)).sum();
        for (i, gradient) in gradient.iter_mut().enumerate() {
            if self.place[i] == PINNED {
                *gradient = DVec3::ZERO;
            } else {
                let d = x[i] - predicted[i];
                g += 0.5 * self.inertia[i] * d.length_squared();
                *gradient += self.inertia[i] * d;
            }
        }
        g
    }

    /// The blocks of the Hessian at x, or of Y, in the order of the pattern.
    fn matrix(&self, x: Option<&[DVec3]>) -> Vec<DMat3> {
        let Pattern { offsets, rows } = &self.pattern;
        let mut values = vec![DMat3::ZERO; rows.len()];
        for (&particle, &start) in self.free.iter().zip(offsets) {
            values[start as usize] = DMat3::from_diagonal(DVec3::splat(self.inertia[particle as usize]));
        }
        for term in &self.terms {
            term.blocks(x, &mut |i, j, block| {
                let (i, j) = (self.place[i as usize], self.place[j as usize]);
                if i != PINNED && j != PINNED && i >= j {
                    let start = offsets[j as usize] as usize;
                    let column = &rows[start..offsets[j as usize + 1] as usize];
                    if let Ok(k) = column.binary_search(&i) {
                        values[start + k] += block;
                    }
                }
            });
        }
        values
    }

    /// Y: one matrix for x, y and z.
    pub(crate) fn y(&self) -> Vec<f64> {
        self.matrix(None).iter().map(|block| block.x_axis.x).collect()
    }

    /// Where the Hessian has entries, x, y and z of a particle one after the other.
    pub(crate) fn hessian_pattern(&self) -> Pattern {
        let mut pattern = Pattern { offsets: vec![0], rows: Vec::new() };
        for column in self.pattern.offsets.windows(2) {
            let rows = &self.pattern.rows[column[0] as usize..column[1] as usize];
            for axis in 0..3 {
                let all = rows.iter().flat_map(|row| [3 * row, 3 * row + 1, 3 * row + 2]);
                pattern.rows.extend(all.skip(axis));
                pattern.offsets.push(u32::try_from(pattern.rows.len()).unwrap_or(u32::MAX));
            }
        }
        pattern
    }

    /// The Hessian at x, in the order of its pattern: see `is_hessian_exact`.
    pub(crate) fn hessian(&self, x: &[DVec3]) -> Vec<f64> {
        let blocks = self.matrix(Some(x));
        let mut values = Vec::with_capacity(9 * blocks.len());
        for column in self.pattern.offsets.windows(2) {
            let blocks = &blocks[column[0] as usize..column[1] as usize];
            for axis in 0..3 {
                values.extend(blocks.iter().flat_map(|block| block.col(axis).to_array()).skip(axis));
            }
        }
        values
    }

    /// Moves the target of attachment `idx`: attachments are the first term.
    pub(crate) fn set_attachment_target(&mut self, idx: usize, target: glam::Vec3) {
        self.terms[0].set_target(idx, target);
    }
}
