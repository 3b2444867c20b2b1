//! The guard on a device: ways are shortened, in a fixed number of rounds, until nothing passes through anything.

use glam::Vec4;
use vivace_kernels::Backend;
use vivace_kernels::collision::{Hit, HitUniform, KeepOut, Shorten, ShortenUniform, Solid};

use super::standing::Standing;
use super::{Collider, count, set};

/// Of the thickness, the gap that the guard leaves; of the distance at the start, the gap that is left at most.
const GAP: f32 = 0.1;
const GAP_OF_START: f32 = 0.8;
/// Of the thickness: pairs nearer than that come no nearer at all.
const FLOOR: f32 = 1e-3;
/// What each round of the guard asks for less than the one before, so that it accepts what that one left.
const LESS: f32 = 0.88;
/// Rounds in which ways are shortened, and after that rounds in which particles that hit stay where they are.
const SHORTENING_ROUNDS: u32 = 7;
const STAYING_ROUNDS: u32 = 12;

impl<B: Backend> Collider<B> {
    /// Shortens the ways from `from` to `q` \[m\], taken as straight, so that nothing passes through.
    pub(in crate::device) fn guard(&mut self, backend: &B, from: &B::Buffer<Vec4>, q: &mut B::Buffer<Vec4>) {
        let (gap, n) = (GAP * self.options.thickness, self.n);
        for Standing { solid, values, .. } in &self.solids {
            let near = Solid { distance: gap, slides: 1, ..*solid };
            let inputs = (backend.view(from), backend.view(values));
            backend.map::<KeepOut>(&self.particles, &near, inputs, q);
        }
        if self.trees.meet.n_triangles > 0 {
            let pairs = self.meet(backend, from, q, false, gap);
            set(backend, 0..2 * n + 1, u32::MAX, &mut self.parts);
            for round in 0..SHORTENING_ROUNDS + STAYING_ROUNDS {
                self.hit(backend, &pairs, round, from, q);
                let inputs = (backend.view(&self.parts), backend.view(from));
                let uniform = ShortenUniform { gives_up: 0, n };
                let mut others = self.particles.clone();
                let shortened = backend.select::<Shorten>(&mut others, &uniform, inputs, q);
                for Standing { solid, values, .. } in self.solids.iter().filter(|one| one.is_still()) {
                    // Nearer than what slides along the surface comes.
                    let near = Solid { distance: 0.5 * gap, ..*solid };
                    let inputs = (backend.view(from), backend.view(values));
                    backend.map::<KeepOut>(&shortened, &near, inputs, q);
                }
                set(backend, 0..n + 1, u32::MAX, &mut self.parts);
            }
            self.hit(backend, &pairs, SHORTENING_ROUNDS + STAYING_ROUNDS, from, q);
            let inputs = (backend.view(&self.parts), backend.view(from));
            let uniform = ShortenUniform { gives_up: 1, n };
            backend.select::<Shorten>(&mut backend.all(n as usize), &uniform, inputs, q);
            let (counts, no_items) = (&mut self.counts.held, &mut self.no_items);
            count(backend, &backend.range(n + 1..2 * n + 1), 0, &self.parts, no_items, counts);
        }
    }

    /// Finds what hits in a round of the guard.
    fn hit(&mut self, backend: &B, pairs: &B::List, round: u32, from: &B::Buffer<Vec4>, q: &B::Buffer<Vec4>) {
        let less = LESS.powi(round.min(SHORTENING_ROUNDS).cast_signed());
        let uniform = HitUniform {
            gap: GAP * self.options.thickness * less,
            gap_of_start: GAP_OF_START * less,
            floor: FLOOR * self.options.thickness,
            stays: u32::from(round >= SHORTENING_ROUNDS),
            n: self.n,
        };
        let inputs = (backend.view(&self.pairs), backend.view(from), backend.view(q));
        backend.lower::<Hit, 9>(pairs, &uniform, inputs, &mut self.parts);
    }
}
