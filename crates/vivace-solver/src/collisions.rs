//! Collisions of a model, and what is found of them in a step.

use std::fmt;

use glam::Vec3;
use vivace_collision::{CollisionError, Contact, Detector, Obstacle, Options};
use vivace_model::Model;

use crate::contacts::Found;
use crate::{ContactReport, SolverError};

/// A model's surface, prepared for detection, and obstacles.
///
/// In each small step contacts are looked for between where it begins and where particles are predicted; they are constraints like
/// any other while it is solved; and what would have passed through after that is held back.
pub struct Collisions {
    detector: Detector,
    rest: Vec<Vec3>,
    obstacles: Vec<Obstacle>,
    /// The same, with their way in the small step.
    moving: Vec<Obstacle>,
    contacts: Vec<Contact>,
}

impl fmt::Debug for Collisions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Collisions").field("obstacles", &self.obstacles).finish_non_exhaustive()
    }
}

impl Collisions {
    /// For the surface of `model`, whose particles rest at `rest` \[m\].
    ///
    /// # Errors
    /// Options out of range; a thickness that the mesh is too fine for.
    pub fn new(model: &Model, rest: &[Vec3], options: Options) -> Result<Self, CollisionError> {
        let detector = Detector::new(model.surface(), rest, options)?;
        let (obstacles, moving, contacts) = (Vec::new(), Vec::new(), Vec::new());
        Ok(Self { detector, rest: rest.to_vec(), obstacles, moving, contacts })
    }

    /// For `model`, whose first `n` particles are those of now: copies rest where what they are copies of does. So sides of a tear, which
    /// touch at rest, have no contacts with one another.
    pub(crate) fn torn(&self, model: &Model, n: usize) -> Result<(Detector, Vec<Vec3>), CollisionError> {
        let n_built = model.n_particles() - model.parents().len();
        let mut rest = self.rest[..n].to_vec();
        for &parent in &model.parents()[n - n_built..] {
            rest.push(rest[parent as usize]);
        }
        Ok((Detector::new(model.surface(), &rest, *self.detector.options())?, rest))
    }

    /// Takes what [`Collisions::torn`] has made.
    pub(crate) fn set_torn(&mut self, (detector, rest): (Detector, Vec<Vec3>)) {
        (self.detector, self.rest) = (detector, rest);
        self.contacts.clear();
    }

    pub(crate) fn detector(&self) -> &Detector {
        &self.detector
    }

    /// The obstacles in the small step that [`Collisions::enter`] has named.
    pub(crate) fn moving(&self) -> &[Obstacle] {
        &self.moving
    }

    /// Small step `k` of `n` begins.
    ///
    /// # Errors
    /// An obstacle that cannot be.
    pub(crate) fn enter(&mut self, k: u32, n: u32) -> Result<(), SolverError> {
        self.obstacles.iter().enumerate().try_for_each(|(idx, obstacle)| obstacle.check(idx))?;
        let part = |k: u32| k as f32 / n as f32;
        self.moving.clear();
        self.moving.extend(self.obstacles.iter().map(|obstacle| obstacle.during(part(k), part(k + 1))));
        Ok(())
    }

    /// The obstacles, with their way in the next step, which checks them.
    pub fn obstacles_mut(&mut self) -> &mut Vec<Obstacle> {
        &mut self.obstacles
    }

    /// The contacts of the last (small) step.
    #[must_use]
    pub fn contacts(&self) -> &[Contact] {
        &self.contacts
    }

    pub(crate) fn detect(
        &mut self,
        from: &[Vec3],
        to: &[Vec3],
        h: f32,
        report: &mut ContactReport,
    ) -> Result<(), SolverError> {
        let found = self.detector.detect(from, to, &self.moving, h, &mut self.contacts)?;
        report.contacts = found.contacts;
        report.left_out += found.left_out;
        Ok(())
    }

    pub(crate) fn found<'a>(&'a self, before: &'a [Vec3], h: f32) -> Found<'a> {
        Found { contacts: &self.contacts, before, h }
    }

    pub(crate) fn limit(
        &mut self,
        from: &[Vec3],
        to: &mut [Vec3],
        report: &mut ContactReport,
    ) -> Result<(), SolverError> {
        report.held_back += self.detector.limit(from, to, &self.moving)?.contacts;
        let depths = self.contacts.iter().map(|contact| (-contact.gap(to)).max(0.0));
        let (deepest, sum) = depths.fold((0.0_f32, 0.0), |(most, sum), depth| (most.max(depth), sum + depth));
        report.deepest = deepest;
        report.mean_depth = sum / self.contacts.len().max(1) as f32;
        Ok(())
    }
}
