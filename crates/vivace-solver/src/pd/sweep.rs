//! What a vertex computes: the body of Algorithm 1's inner loop, for eight vertices of a color at a time.
//!
//! SSE2 or NEON by portable types: no dispatch at run time, and no fused multiply-add, so that every machine rounds alike.

use glam::{Mat3, Vec3A};
use wide::f32x8;

use super::pass::Pass;
use super::points::{LANES, Lanes3, Points, load};
use super::slices::Slices;

/// What a sweep reads beside q.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Vertices<'a> {
    pub(crate) slices: &'a Slices,
    /// m/h² and the stiffness of attachments \[N/m\].
    pub(crate) anchor_weights: &'a [f32],
    /// Mean of the prediction s and the targets of attachments, by these weights \[m\].
    pub(crate) anchors: &'a Points,
    /// Y_ii less inertia and attachments \[N/m\].
    pub(crate) diagonal: &'a [f32],
    /// One over the diagonal of Y \[m/N\].
    pub(crate) inverse_diagonal: &'a [f32],
    pub(crate) passes: &'a [Box<dyn Pass>],
}

/// The symmetric 3 × 3 block of each of eight vertices.
#[derive(Debug, Clone, Copy)]
struct Blocks {
    diagonal: Lanes3,
    /// Entries yz, zx, xy.
    off: Lanes3,
}

impl Vertices<'_> {
    /// What `(b − Y q)` of the vertices of a slice is without springs, hinges and passes \[N\].
    #[inline]
    fn inertia(&self, first: usize, at: Lanes3) -> Lanes3 {
        (self.anchors.lanes(first) - at) * load(self.anchor_weights, first)
    }

    /// `(b − Y q)` of the vertices of `slice` \[N\] with everything projected from q.
    #[inline]
    pub(crate) fn fused(&self, slice: usize, q: &Points) -> Lanes3 {
        let (first, n) = self.slices.slices[slice];
        let at = q.lanes(first);
        let mut sum = self.inertia(first, at);
        let springs = &self.slices.springs;
        springs.slots.for_each(slice, q, at, |slot, d| {
            let length = d.squared_length().sqrt();
            sum = sum + d * (springs.slots.weights[slot] - springs.pulls[slot] / length);
        });
        let others = &self.slices.others;
        others.for_each(slice, q, at, |slot, d| sum = sum + d * others.weights[slot]);
        if self.passes.is_empty() { sum } else { sum + self.pass_pulls(first, n, q) }
    }

    /// `(b − Y q)` of the vertices of `slice` \[N\] with all projections in `pulls`.
    #[inline]
    pub(crate) fn linear(&self, slice: usize, q: &Points, pulls: &Points) -> Lanes3 {
        let (first, _) = self.slices.slices[slice];
        let at = q.lanes(first);
        let mut sum = self.inertia(first, at) + pulls.lanes(first);
        for slots in [&self.slices.springs.slots, &self.slices.others] {
            slots.for_each(slice, q, at, |slot, d| sum = sum + d * slots.weights[slot]);
        }
        sum
    }

    /// `Σ w Aᵀ p` of the springs of the vertices of `slice` \[N\].
    #[inline]
    pub(crate) fn spring_pulls(&self, slice: usize, q: &Points) -> Lanes3 {
        let (first, _) = self.slices.slices[slice];
        let at = q.lanes(first);
        let mut sum = Lanes3::ZERO;
        let springs = &self.slices.springs;
        springs.slots.for_each(slice, q, at, |slot, d| {
            sum = sum - d * (springs.pulls[slot] / d.squared_length().sqrt());
        });
        sum
    }

    /// What the passes ask of `n` vertices from `first` on \[N\].
    fn pass_pulls(&self, first: usize, n: usize, q: &Points) -> Lanes3 {
        let mut pulls = [Vec3A::ZERO; LANES];
        self.passes.iter().for_each(|pass| pass.pull_fused(first..first + n, q, &mut pulls[..n]));
        Lanes3::from_array(pulls)
    }

    /// By how much the vertices of `slice` move \[m\], each by the scalar diagonal of Y.
    #[inline]
    pub(crate) fn by_diagonal(&self, slice: usize, residual: Lanes3) -> Lanes3 {
        residual * load(self.inverse_diagonal, self.slices.slices[slice].0)
    }

    /// By how much the vertices of `slice` move \[m\], each by its own block of the Hessian; by the diagonal where `f32` cannot invert it.
    #[inline]
    pub(crate) fn by_blocks(&self, slice: usize, q: &Points, residual: Lanes3) -> Lanes3 {
        let Blocks { diagonal, off } = self.blocks(slice, q);
        let (x, y, z) = (
            Lanes3 { x: diagonal.x, y: off.z, z: off.y },
            Lanes3 { x: off.z, y: diagonal.y, z: off.x },
            Lanes3 { x: off.y, y: off.x, z: diagonal.z },
        );
        let (yz, zx, xy) = (y.cross(z), z.cross(x), x.cross(y));
        let determinant = x.dot(yz);
        let adjugate = Lanes3 { x: yz.dot(residual), y: zx.dot(residual), z: xy.dot(residual) };
        let solved = adjugate * (f32x8::ONE / determinant);
        let is_good = determinant.simd_gt(f32x8::ZERO) & (solved.x + solved.y + solved.z).is_finite();
        let fallback = self.by_diagonal(slice, residual);
        Lanes3 {
            x: is_good.bitselect(solved.x, fallback.x),
            y: is_good.bitselect(solved.y, fallback.y),
            z: is_good.bitselect(solved.z, fallback.z),
        }
    }

    /// Each vertex's own block of the Hessian, of springs exactly (positive semi-definite: k (u uᵀ + across (I − u uᵀ)) in place of
    /// k I), of passes as they say, of all else as in Y \[N/m\].
    #[inline]
    fn blocks(&self, slice: usize, q: &Points) -> Blocks {
        let (first, n) = self.slices.slices[slice];
        let at = q.lanes(first);
        let mut isotropic = load(self.diagonal, first) + load(self.anchor_weights, first);
        let (mut diagonal, mut off) = (Lanes3::ZERO, Lanes3::ZERO);
        let springs = &self.slices.springs;
        springs.slots.for_each(slice, q, at, |slot, d| {
            let squared = d.squared_length();
            let stiffness = springs.stiffness[slot];
            let across = (stiffness - springs.pulls[slot] / squared.sqrt()).fast_max(f32x8::ZERO);
            isotropic += across - stiffness;
            let scaled = d * ((stiffness - across) / squared);
            diagonal = diagonal + Lanes3 { x: scaled.x * d.x, y: scaled.y * d.y, z: scaled.z * d.z };
            off = off + Lanes3 { x: scaled.y * d.z, y: scaled.z * d.x, z: scaled.x * d.y };
        });
        let isotropic = Lanes3::splat(isotropic);
        let mut blocks = Blocks { diagonal: diagonal + isotropic, off };
        if !self.passes.is_empty() {
            blocks.add(std::array::from_fn(|lane| {
                let mut block = Mat3::ZERO;
                if lane < n {
                    self.passes.iter().for_each(|pass| pass.add_to_block(first + lane, q, &mut block));
                }
                block
            }));
        }
        blocks
    }

    /// Energy of the springs and flat hinges in the rows of `slice`, half of each entry, and of the inertia of its vertices \[J\].
    pub(crate) fn objective(&self, slice: usize, q: &Points) -> f64 {
        let (first, n) = self.slices.slices[slice];
        let at = q.lanes(first);
        let from_anchor = at - self.anchors.lanes(first);
        let mut sum = from_anchor.dot(from_anchor) * load(self.anchor_weights, first);
        let springs = &self.slices.springs;
        springs.slots.for_each(slice, q, at, |slot, d| {
            let squared = d.squared_length();
            let force = springs.stiffness[slot] * squared.sqrt() - springs.pulls[slot];
            sum += force * force * springs.compliance[slot] + springs.slots.linear[slot] * squared;
        });
        let others = &self.slices.others;
        others.for_each(slice, q, at, |slot, d| sum += others.linear[slot] * d.dot(d));
        0.5 * sum.to_array()[..n].iter().map(|&sum| f64::from(sum)).sum::<f64>()
    }
}

impl Blocks {
    fn add(&mut self, blocks: [Mat3; LANES]) {
        let diagonal = Lanes3::from_array(blocks.map(|m| Vec3A::new(m.x_axis.x, m.y_axis.y, m.z_axis.z)));
        let off = Lanes3::from_array(blocks.map(|m| Vec3A::new(m.y_axis.z, m.z_axis.x, m.x_axis.y)));
        *self = Self { diagonal: self.diagonal + diagonal, off: self.off + off };
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use vivace_mesh::{ball, cloth};
    use vivace_model::{Model, ModelBuilder};

    use super::super::layout::Layout;
    use super::super::rows::Rows;
    use super::*;

    /// A regular cloth, where most slots are runs, and a ball, where none are; each with a pinned particle.
    fn models() -> [(&'static str, Model); 2] {
        let mesh = cloth::regular(13, 11, 0.1).unwrap();
        let mut builder = ModelBuilder::new();
        builder.cloth(&mesh, 0.2).unwrap();
        builder.springs(0, &mesh.edges(), 100.0).unwrap();
        builder.hinges(0, &mesh.hinges(), 1e-3, false).unwrap();
        builder.pin(3).unwrap();
        let cloth = builder.build().unwrap().0;
        let mesh = ball::layered(5, 1.0).unwrap();
        let mut builder = ModelBuilder::new();
        builder.volume(&mesh, 1000.0).unwrap();
        builder.springs(0, &mesh.edges(), 100.0).unwrap();
        builder.pin(3).unwrap();
        [("cloth", cloth), ("ball", builder.build().unwrap().0)]
    }

    struct Scalar {
        residual: DVec3,
        objective: f64,
        block: glam::DMat3,
    }

    /// Row i, entry by entry, in f64.
    fn scalar(rows: &Rows, i: usize, q: &Points, anchor: Vec3A, weight: f32) -> Scalar {
        let at = q.get(i).as_dvec3();
        let weight = f64::from(weight);
        let from_anchor = anchor.as_dvec3() - at;
        let mut residual = from_anchor * weight;
        let mut objective = 0.5 * weight * from_anchor.length_squared();
        let mut block = glam::DMat3::from_diagonal(DVec3::splat(f64::from(rows.diagonal[i]) + weight));
        for k in rows.offsets[i] as usize..rows.offsets[i + 1] as usize {
            let d = q.get(rows.columns[k] as usize).as_dvec3() - at;
            let (length, pull, k_spring) =
                (d.length(), f64::from(rows.pulls[k]), f64::from(rows.stiffness[k]));
            residual += d * (f64::from(rows.weights[k]) - pull / length);
            let share = f64::from(rows.share(k));
            objective += 0.5 * share * f64::from(rows.linear[k]) * length * length;
            if k_spring > 0.0 {
                objective += 0.5 * share * k_spring * (length - pull / k_spring).powi(2);
                let (u, across) = (d / length, (k_spring - pull / length).max(0.0));
                let uu = glam::DMat3::from_cols(u * u.x, u * u.y, u * u.z);
                block += uu * (k_spring - across) + glam::DMat3::IDENTITY * (across - k_spring);
            }
        }
        Scalar { residual, objective, block }
    }

    /// Eight at a time is one at a time, up to the rounding of a sum of a row's entries in f32.
    #[test]
    fn lanes_are_rows() {
        for (name, model) in models() {
            let graph = model.graph().unwrap();
            let layout = Layout::new(&model, &graph, &[]).unwrap();
            let rows = Rows::new(&model, &graph, &layout);
            let slices = Slices::new(&rows, &layout.classes);
            let n_free = layout.n_free;
            let (mut q, mut anchors, pulls) =
                (Points::zeros(model.n_particles()), Points::zeros(n_free), Points::zeros(n_free));
            for (slot, i) in (0_u16..).zip(&layout.order) {
                let k = f32::from(u16::try_from(*i).unwrap());
                let shift = Vec3A::new((k * 0.7).sin(), (k * 1.3).cos(), (k * 2.1).sin());
                q.set(slot.into(), Vec3A::new(k * 0.01, 0.3, 0.0) + shift);
                if usize::from(slot) < n_free {
                    anchors.set(slot.into(), shift);
                }
            }
            let anchor_weights = vec![3.0; n_free];
            let inverse_diagonal: Vec<f32> = rows.diagonal.iter().map(|d| 1.0 / (d + 3.0)).collect();
            let vertices = Vertices {
                slices: &slices,
                anchor_weights: &anchor_weights,
                anchors: &anchors,
                diagonal: &rows.diagonal,
                inverse_diagonal: &inverse_diagonal,
                passes: &[],
            };
            let mut objective = [0.0; 2];
            let mut n_seen = 0;
            for (slice, &(first, n)) in slices.slices.iter().enumerate() {
                let fused = vertices.fused(slice, &q);
                let step = vertices.by_blocks(slice, &q, fused).to_array();
                let linear = vertices.linear(slice, &q, &pulls) + vertices.spring_pulls(slice, &q);
                objective[0] += vertices.objective(slice, &q);
                for (lane, step) in step.iter().enumerate().take(n) {
                    let i = first + lane;
                    assert_eq!((i, slices.of_vertex(i)), (n_seen, slice));
                    n_seen += 1;
                    let expected = scalar(&rows, i, &q, anchors.get(i), 3.0);
                    objective[1] += expected.objective;
                    let bound = 1e-5 * f64::from(rows.diagonal[i]) * 4.0;
                    for got in [fused, linear] {
                        let error = (got.to_array()[lane].as_dvec3() - expected.residual).length();
                        assert!(error < bound, "{name} {i}: {error} {bound}");
                    }
                    let error = (step.as_dvec3() - expected.block.inverse() * expected.residual).length();
                    assert!(error < 1e-4, "{name} {i}: {error}");
                }
            }
            assert_eq!(n_seen, n_free);
            assert!((objective[0] / objective[1] - 1.0).abs() < 1e-6, "{name}: {objective:?}");
        }
    }
}
