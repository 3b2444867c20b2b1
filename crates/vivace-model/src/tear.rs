//! Cloth that tears: which springs break, and how the triangles come apart.
//!
//! A spring that is stretched too far tears the cloth across itself, as a pull does, not along itself (Müller et al. 2007): one of its
//! ends is split by the plane through it that the spring is perpendicular to. The triangles on the spring's side get a copy of
//! the particle; copies inherit position and velocity, so nothing moves and the new gap opens in the frames that follow. Where that leaves triangles that
//! share a corner and no edge, the corner is split as well, so the mesh stays manifold.
//!
//! Masses are shared by area at rest; a spring between two triangles becomes two of half its stiffness, so mass, momentum and the energy of
//! springs are what they were; a hinge vanishes with its edge. A copy's neighbors in the graph are some of its parent's, or copies of
//! them: **a coloring is inherited as it is**, and no color is ever added.

use std::collections::BTreeMap;

use glam::Vec3;
use serde::{Deserialize, Serialize};
use vivace_graph::Incidence;
use vivace_kernels::constraint::Spring;
use vivace_kernels::pcg::{hash, key};

use crate::builder::positive;
use crate::constraints::Store;
use crate::{Constraints, Model, ModelError};

/// When springs break.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TearLimit {
    /// Length over that at rest, less 1 \[1\].
    pub strain: f32,
    /// Flaws: each spring's own limit differs by up to this share of it \[1\], at least 0 and below 1. A cloth without any tears
    /// everywhere at once.
    #[serde(default)]
    pub variation: f32,
    /// One seed gives one cloth.
    #[serde(default)]
    pub seed: u64,
}

impl TearLimit {
    /// The same for all springs.
    #[must_use]
    pub fn new(strain: f32) -> Self {
        Self { strain, variation: 0.0, seed: 0 }
    }

    /// Whether springs can have it.
    pub(crate) fn check(&self) -> Result<(), ModelError> {
        positive("the strain above which a spring breaks [1]", self.strain)?;
        if (0.0..1.0).contains(&self.variation) {
            return Ok(());
        }
        let (what, need) = ("the variation of that strain [1]", "at least 0 and below 1");
        Err(ModelError::Value { what, value: self.variation, need })
    }

    /// That of spring `k` of its cloth.
    pub(crate) fn of(&self, k: u32) -> f32 {
        let unit = (hash(k, key(self.seed, 0)) >> 8) as f32 / (1 << 23) as f32 - 1.0;
        self.strain * (1.0 + self.variation * unit)
    }
}

/// One step of a tear.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum Tear {
    /// A particle has got a copy.
    Split {
        /// The particle.
        particle: u32,
        /// Its copy, numbered after all others.
        copy: u32,
        /// The triangles, by number in [`Model::surface`] and ascending, that have the copy for a corner in its place.
        triangles: Vec<u32>,
    },
    /// The springs between two particles, which are no triangle's edge, are gone.
    Break {
        /// The particles.
        particles: [u32; 2],
    },
}

/// What a model that tears knows.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Tearing {
    /// By spring, the strain above which it breaks; infinite where it never does.
    pub(crate) limits: Vec<f32>,
    /// By triangle of the surface, its area at rest \[m²\].
    pub(crate) areas: Vec<f32>,
    /// Of each copy, whose it is.
    pub(crate) parents: Vec<u32>,
}

/// Triangles, and those around each particle, while they come apart.
struct Fans {
    surface: Vec<[u32; 3]>,
    around: Incidence,
    changed: BTreeMap<u32, Vec<u32>>,
}

impl Fans {
    fn new(model: &Model) -> Result<Self, ModelError> {
        let n_particles = model.n_particles();
        let around = Incidence::from_constraints(n_particles, model.surface());
        let around = around.map_err(|_| ModelError::TooMany { n_particles })?;
        Ok(Self { surface: model.surface().to_vec(), around, changed: BTreeMap::new() })
    }

    /// The triangles around a particle, ascending.
    fn of(&self, particle: u32) -> &[u32] {
        self.changed.get(&particle).map_or_else(|| self.around.constraints(particle), Vec::as_slice)
    }

    /// The corners of a triangle that are not `particle`.
    fn others(&self, triangle: u32, particle: u32) -> impl Iterator<Item = u32> {
        self.surface[triangle as usize].into_iter().filter(move |&corner| corner != particle)
    }

    fn has(&self, triangle: u32, particle: u32) -> bool {
        self.surface[triangle as usize].contains(&particle)
    }

    /// Some triangles around a particle by who shares an edge there with whom, the lowest number first.
    fn pieces(&self, particle: u32, triangles: &[u32]) -> Vec<Vec<u32>> {
        let mut left = triangles.to_vec();
        let mut pieces = Vec::new();
        while !left.is_empty() {
            let mut piece = vec![left.remove(0)];
            let mut next = 0;
            while let Some(&triangle) = piece.get(next) {
                next += 1;
                let is_adjacent = |&other: &u32| self.others(triangle, particle).any(|c| self.has(other, c));
                piece.extend(left.iter().copied().filter(is_adjacent));
                left.retain(|other| !piece.contains(other));
            }
            piece.sort_unstable();
            pieces.push(piece);
        }
        pieces
    }

    /// Whether an edge at the particle has one triangle.
    fn is_on_boundary(&self, particle: u32) -> bool {
        let fan = self.of(particle);
        let mut corners = fan.iter().flat_map(|&triangle| self.others(triangle, particle));
        corners.any(|corner| fan.iter().filter(|&&triangle| self.has(triangle, corner)).count() == 1)
    }

    /// The triangles around `v` that a pull towards `w` tears off; `None` if nothing would stay behind.
    fn torn_off(&self, v: u32, w: u32, at: &[Vec3]) -> Option<Vec<u32>> {
        let (origin, fan) = (at[v as usize], self.of(v));
        let pull = at[w as usize] - origin;
        let is_pulled = |&triangle: &u32| {
            let sum: Vec3 = self.others(triangle, v).map(|corner| at[corner as usize] - origin).sum();
            self.has(triangle, w) || sum.dot(pull) > 0.0
        };
        let pulled: Vec<u32> = fan.iter().copied().filter(is_pulled).collect();
        let mut pieces = self.pieces(v, &pulled).into_iter();
        pieces
            .find(|piece| piece.iter().any(|&triangle| self.has(triangle, w)))
            .filter(|p| p.len() < fan.len())
    }

    /// Gives `triangles` the copy in place of the particle.
    fn split(&mut self, particle: u32, copy: u32, triangles: &[u32]) {
        let left =
            self.of(particle).iter().copied().filter(|t| triangles.binary_search(t).is_err()).collect();
        self.changed.insert(particle, left);
        self.changed.insert(copy, triangles.to_vec());
        for &triangle in triangles {
            let corners = &mut self.surface[triangle as usize];
            corners.iter_mut().filter(|corner| **corner == particle).for_each(|corner| *corner = copy);
        }
    }
}

/// Tears while they are found.
struct Search {
    fans: Fans,
    /// Positions, of copies too \[m\], and whether a particle has been split.
    at: Vec<Vec3>,
    is_split: Vec<bool>,
    tears: Vec<Tear>,
}

impl Search {
    fn split(&mut self, particle: u32, triangles: Vec<u32>) {
        // Three copies of each triangle at most, and triangles are numbered in 32 bits.
        let Ok(copy) = u32::try_from(self.at.len()) else { return };
        self.fans.split(particle, copy, &triangles);
        self.at.push(self.at[particle as usize]);
        self.is_split.push(true);
        self.is_split[particle as usize] = true;
        self.tears.push(Tear::Split { particle, copy, triangles });
    }

    /// Leaves a particle one piece of the triangles around it.
    fn separate(&mut self, particle: u32) {
        for piece in self.fans.pieces(particle, self.fans.of(particle)).into_iter().skip(1) {
            self.split(particle, piece);
        }
    }

    /// Tears at one end of the spring [`v`, `w`], which is an edge.
    fn tear(&mut self, spring: [u32; 2], model: &Model) {
        let [a, b] = spring;
        let mut ends = [(a, b), (b, a)];
        // A crack goes on where it has come to.
        ends.sort_by_key(|&(v, _)| (!self.fans.is_on_boundary(v), v));
        for (v, w) in ends {
            if !model.is_pinned(v)
                && let Some(triangles) = self.fans.torn_off(v, w, &self.at)
            {
                let corners = triangles.iter().flat_map(|&triangle| self.fans.others(triangle, v));
                let around: std::collections::BTreeSet<u32> = corners.collect();
                self.split(v, triangles);
                self.separate(v);
                around.into_iter().for_each(|corner| self.separate(corner));
                return;
            }
        }
    }
}

impl Model {
    /// Whether springs may break: see [`ModelBuilder::let_tear`](crate::ModelBuilder::let_tear).
    #[must_use]
    pub fn can_tear(&self) -> bool {
        self.tearing.is_some()
    }

    /// Of each copy that a tear has made, whose it is; copies are numbered after what was built.
    #[must_use]
    pub fn parents(&self) -> &[u32] {
        self.tearing.as_ref().map_or(&[], |tearing| &tearing.parents)
    }

    /// The particle that was built of which this one is a copy, or a copy of a copy; or itself.
    ///
    /// # Panics
    /// When there is no such particle.
    #[must_use]
    pub fn origin(&self, mut particle: u32) -> u32 {
        let n_built = self.n_particles() - self.parents().len();
        while let Some(copy) = (particle as usize).checked_sub(n_built) {
            particle = self.parents()[copy];
        }
        particle
    }

    /// By how much a spring is stretched beyond what it bears, as a multiple of that.
    fn excess(&self, spring: usize, limit: f32, at: &[Vec3]) -> Option<f32> {
        let springs = &self.constraints().springs;
        let ([a, b], rest) = (springs.particles[spring], springs.rest[spring].rest);
        let strain = at[a as usize].distance(at[b as usize]) / rest - 1.0;
        (strain > limit && rest > 0.0).then(|| strain / limit)
    }

    /// What tears at these positions \[m\], in the order in which it does: the most stretched first, and no particle twice. What both ends of a
    /// spring cannot let go of (they are pinned, or nothing is behind them) does not tear.
    ///
    /// # Panics
    /// When there are not as many positions as particles.
    #[must_use]
    pub fn find_tears(&self, positions: &[Vec3]) -> Vec<Tear> {
        let limits = self.tearing.as_ref().map_or(&[][..], |tearing| &tearing.limits);
        let excess = |(k, &limit): (usize, &f32)| self.excess(k, limit, positions).map(|excess| (excess, k));
        let mut torn: Vec<(f32, usize)> = limits.iter().enumerate().filter_map(excess).collect();
        if torn.is_empty() {
            return Vec::new();
        }
        torn.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let Ok(fans) = Fans::new(self) else { return Vec::new() };
        let is_split = vec![false; positions.len()];
        let mut search = Search { fans, at: positions.to_vec(), is_split, tears: Vec::new() };
        for (_, spring) in torn {
            let particles = self.constraints().springs.particles[spring];
            if particles.iter().any(|&p| search.is_split[p as usize]) {
                continue;
            }
            let [a, b] = particles;
            if search.fans.of(a).iter().any(|&triangle| search.fans.has(triangle, b)) {
                search.tear(particles, self);
            } else if !search.tears.contains(&Tear::Break { particles }) {
                search.tears.push(Tear::Break { particles });
            }
        }
        search.tears
    }

    /// Tears the model: what [`Model::find_tears`] has found, in this model or in another that had the same past.
    ///
    /// # Errors
    /// The model cannot tear; a step names triangles or particles that are not there, or all triangles of a particle. Nothing has changed.
    pub fn tear(&mut self, tears: &[Tear]) -> Result<(), ModelError> {
        let refused = |tear, reason| ModelError::Tear { tear, reason };
        let Some(mut tearing) = self.tearing.clone() else {
            return Err(refused(0, "the model was not built to tear"));
        };
        let mut fans = Fans::new(self)?;
        let (mut masses, mut own_masses) = (self.masses.clone(), self.own_masses.clone());
        let mut broken = Vec::new();
        for (tear, step) in tears.iter().enumerate() {
            match step {
                &Tear::Break { particles } => broken.push(particles),
                Tear::Split { particle, copy, triangles } => {
                    let n = masses.len();
                    if *copy as usize != n || *particle as usize >= n {
                        return Err(refused(
                            tear,
                            "its particle is not there, or its copy is not the next one",
                        ));
                    }
                    let fan = fans.of(*particle);
                    let are_some = !triangles.is_empty() && triangles.len() < fan.len();
                    let are_there = triangles.iter().all(|triangle| fan.binary_search(triangle).is_ok());
                    if !(are_some && are_there && triangles.is_sorted_by(|a, b| a < b)) {
                        return Err(refused(tear, "its triangles are not some of those around its particle"));
                    }
                    let area = |triangles: &[u32]| -> f32 {
                        triangles.iter().map(|&triangle| tearing.areas[triangle as usize]).sum()
                    };
                    let share = area(triangles) / area(fan);
                    let of_copy = share_mass(&mut masses[*particle as usize], share);
                    masses.push(of_copy);
                    if let Some(own) = own_masses.get_mut(particle) {
                        let of_copy = share_mass(own, share);
                        own_masses.insert(*copy, of_copy);
                    }
                    tearing.parents.push(*particle);
                    fans.split(*particle, *copy, triangles);
                }
            }
        }
        let cut = Cut { before: &self.surface, around: &fans.around, after: &fans.surface };
        cut.apply(&mut self.constraints, &mut tearing.limits, &broken);
        (self.masses, self.own_masses, self.surface) = (masses, own_masses, fans.surface);
        self.tearing = Some(tearing);
        Ok(())
    }
}

/// Takes a share of a mass \[kg\], and returns it. What is pinned stays so; where a share would be nothing, it is one half.
fn share_mass(mass: &mut f32, share: f32) -> f32 {
    if mass.is_infinite() {
        return *mass;
    }
    let of_copy = *mass * share;
    let of_copy = if of_copy.is_normal() && (*mass - of_copy).is_normal() { of_copy } else { 0.5 * *mass };
    *mass -= of_copy;
    of_copy
}

/// The triangles before and after tears; the same by number, with other corners.
struct Cut<'a> {
    before: &'a [[u32; 3]],
    /// Before.
    around: &'a Incidence,
    after: &'a [[u32; 3]],
}

impl Cut<'_> {
    /// The triangles that had all these corners: what each of these is there now.
    fn now<'a, const N: usize>(&'a self, corners: &'a [u32; N]) -> impl Iterator<Item = [u32; N]> + 'a {
        self.around.constraints(corners[0]).iter().filter_map(move |&triangle| {
            let (before, after) = (self.before[triangle as usize], self.after[triangle as usize]);
            let now = corners.map(|corner| before.iter().position(|&c| c == corner).map(|slot| after[slot]));
            now.iter().all(Option::is_some).then(|| now.map(Option::unwrap_or_default))
        })
    }

    fn apply(&self, constraints: &mut Constraints, limits: &mut Vec<f32>, broken: &[[u32; 2]]) {
        self.cut_springs(&mut constraints.springs, limits, broken);
        let bending = &mut constraints.bending;
        let kept = bending.particles.iter().zip(&bending.rest).filter_map(|(hinge, &rest)| {
            let &[e0, e1, o0, o1] = hinge;
            let (a, b) = (self.now(&[e0, e1, o0]).next(), self.now(&[e0, e1, o1]).next());
            // A hinge that is none of the surface's stays.
            let (Some([a0, a1, o0]), Some([b0, b1, o1])) = (a, b) else { return Some((*hinge, rest)) };
            (a0 == b0 && a1 == b1).then_some(([a0, a1, o0, o1], rest))
        });
        let (particles, rest) = kept.unzip();
        *bending = Store { particles, rest };
        for corners in &mut constraints.triangle_strain.particles {
            let now = self.now(corners).next();
            *corners = now.unwrap_or(*corners);
        }
    }

    /// Ends of springs that are edges; those between triangles that have come apart, for each side a share of it.
    fn cut_springs(&self, springs: &mut Store<Spring, 2>, limits: &mut Vec<f32>, broken: &[[u32; 2]]) {
        let mut more: Vec<([u32; 2], Spring, f32)> = Vec::new();
        let mut sides: Vec<([u32; 2], usize)> = Vec::new();
        for ((ends, spring), &limit) in springs.particles.iter_mut().zip(&mut springs.rest).zip(&*limits) {
            sides.clear();
            for now in self.now(ends) {
                match sides.iter_mut().find(|(side, _)| *side == now) {
                    Some((_, n)) => *n += 1,
                    None => sides.push((now, 1)),
                }
            }
            let n_triangles = sides.iter().map(|(_, n)| n).sum::<usize>() as f32;
            let of = |n: usize| Spring { stiffness: spring.stiffness * (n as f32 / n_triangles), ..*spring };
            let mut sides = sides.iter();
            let Some(&(first, n)) = sides.next() else { continue };
            more.extend(sides.map(|&(side, n)| (side, of(n), limit)));
            *spring = of(n);
            *ends = first;
        }
        if !broken.is_empty() {
            let is_kept = |&(ends, ..): &([u32; 2], Spring, f32)| !broken.contains(&ends);
            let all = springs.particles.drain(..).zip(springs.rest.drain(..)).zip(limits.drain(..));
            let kept: Vec<_> =
                all.map(|((ends, spring), limit)| (ends, spring, limit)).filter(is_kept).collect();
            more.splice(0..0, kept);
        }
        for (ends, spring, limit) in more {
            springs.extend([(ends, spring)]);
            limits.push(limit);
        }
    }
}
