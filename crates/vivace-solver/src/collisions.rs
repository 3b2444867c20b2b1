//! Collisions of a model, and what is found of them in a step.

use std::fmt;

use glam::Vec3;
use vivace_collision::{CollisionError, Contact, Detector, Obstacle, Options, Pose};
use vivace_model::Model;

use crate::contacts::Found;
use crate::{ContactReport, Recoloring, SolverError};

/// A model's surface, prepared for detection, and obstacles.
///
/// In each small step contacts are looked for between where it begins and where particles are predicted; they are constraints like
/// any other while it is solved; and what would pass through after that is held back.
pub struct Collisions {
    detector: Detector,
    /// How the coloring follows.
    pub recoloring: Recoloring,
    obstacles: Vec<Obstacle>,
    /// The obstacles, in a small step.
    now: Vec<Obstacle>,
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
        let (obstacles, now, contacts) = (Vec::new(), Vec::new(), Vec::new());
        Ok(Self { detector, recoloring: Recoloring::default(), obstacles, now, contacts })
    }

    pub(crate) fn detector(&self) -> &Detector {
        &self.detector
    }

    /// The obstacles, in a small step.
    pub(crate) fn now(&self) -> &[Obstacle] {
        &self.now
    }

    /// The obstacles, with their way in the next step, which checks them.
    pub fn obstacles_mut(&mut self) -> &mut Vec<Obstacle> {
        &mut self.obstacles
    }

    /// The contacts of the last small step.
    #[must_use]
    pub fn contacts(&self) -> &[Contact] {
        &self.contacts
    }

    /// Puts the obstacles where they go in small step `k` of `n`.
    pub(crate) fn begin(&mut self, k: u32, n: u32) {
        let at = |obstacle: &Obstacle, k: u32| match k {
            0 => obstacle.from,
            k if k == n => obstacle.to,
            k => between(obstacle.from, obstacle.to, k as f32 / n as f32),
        };
        self.now.clone_from(&self.obstacles);
        for (now, whole) in self.now.iter_mut().zip(&self.obstacles) {
            (now.from, now.to) = (at(whole, k), at(whole, k + 1));
        }
    }

    pub(crate) fn detect(
        &mut self,
        from: &[Vec3],
        to: &[Vec3],
        h: f32,
        report: &mut ContactReport,
    ) -> Result<(), SolverError> {
        let found = self.detector.detect(from, to, &self.now, h, &mut self.contacts)?;
        report.contacts += found.contacts;
        report.left_out += found.left_out;
        Ok(())
    }

    pub(crate) fn found<'a>(
        &'a self,
        masses: &'a [f32],
        before: &'a [Vec3],
        predicted: &'a [Vec3],
        h: f32,
    ) -> Found<'a> {
        Found { contacts: &self.contacts, before, predicted, masses, h, recoloring: self.recoloring }
    }

    pub(crate) fn limit(
        &mut self,
        from: &[Vec3],
        to: &mut [Vec3],
        report: &mut ContactReport,
    ) -> Result<(), SolverError> {
        report.held_back += self.detector.limit(from, to, &self.now)?.contacts;
        let depths = self.contacts.iter().map(|contact| (-contact.gap(to)).max(0.0));
        let (deepest, sum) = depths.fold((0.0_f32, 0.0), |(most, sum), depth| (most.max(depth), sum + depth));
        report.deepest = deepest;
        report.mean_depth = sum / self.contacts.len().max(1) as f32;
        Ok(())
    }
}

/// A pose on the way from one to another.
fn between(from: Pose, to: Pose, part: f32) -> Pose {
    let position = from.position.lerp(to.position, part);
    // The shorter way round; no sines, which differ from machine to machine.
    let end = if from.rotation.dot(to.rotation) < 0.0 { -to.rotation } else { to.rotation };
    let rotation = (from.rotation * (1.0 - part) + end * part).normalize();
    Pose { position, rotation }
}
