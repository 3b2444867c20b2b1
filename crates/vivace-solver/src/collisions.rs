//! Collisions of a model, and what is found of them in a step.

use std::fmt;

use glam::Vec3;
use vivace_collision::{CollisionError, Contact, Detector, Obstacle, Options};
use vivace_model::Model;

use crate::contacts::{Found, SmallStep};
use crate::{ContactReport, Recoloring, SolverError};

/// A model's surface, prepared for detection, and obstacles.
///
/// In each step contacts are looked for between where it begins and where particles are predicted; they are constraints like any
/// other while it, or each of its small steps, is solved; and what would have passed through after that is held back.
pub struct Collisions {
    detector: Detector,
    rest: Vec<Vec3>,
    /// How the coloring follows.
    pub recoloring: Recoloring,
    obstacles: Vec<Obstacle>,
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
        let (obstacles, contacts) = (Vec::new(), Vec::new());
        let rest = rest.to_vec();
        Ok(Self { detector, rest, recoloring: Recoloring::default(), obstacles, contacts })
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

    pub(crate) fn obstacles(&self) -> &[Obstacle] {
        &self.obstacles
    }

    /// The obstacles, with their way in the next step, which checks them.
    pub fn obstacles_mut(&mut self) -> &mut Vec<Obstacle> {
        &mut self.obstacles
    }

    /// The contacts of the last step.
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
        let found = self.detector.detect(from, to, &self.obstacles, h, &mut self.contacts)?;
        report.contacts += found.contacts;
        report.left_out += found.left_out;
        Ok(())
    }

    pub(crate) fn found<'a>(
        &'a self,
        masses: &'a [f32],
        before: &'a [Vec3],
        predicted: &'a [Vec3],
        small: SmallStep,
    ) -> Found<'a> {
        Found { contacts: &self.contacts, before, predicted, masses, small, recoloring: self.recoloring }
    }

    pub(crate) fn limit(
        &mut self,
        from: &[Vec3],
        to: &mut [Vec3],
        report: &mut ContactReport,
    ) -> Result<(), SolverError> {
        report.held_back += self.detector.limit(from, to, &self.obstacles)?.contacts;
        let depths = self.contacts.iter().map(|contact| (-contact.gap(to)).max(0.0));
        let (deepest, sum) = depths.fold((0.0_f32, 0.0), |(most, sum), depth| (most.max(depth), sum + depth));
        report.deepest = deepest;
        report.mean_depth = sum / self.contacts.len().max(1) as f32;
        Ok(())
    }
}
