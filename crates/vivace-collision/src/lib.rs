//! Contacts of triangle surfaces with themselves and with obstacles, and a guard that lets nothing pass.
//!
//! A [`Detector`] is made once for a surface. In each step, or small step, [`Detector::detect`] looks at the way of the particles
//! from its start to where they are predicted, and lists [`Contact`]s: inequalities that a solver can hold.
//! [`Detector::limit`] looks at the way to where they were solved, and shortens it where something would pass through. Lengths
//! are in metres. Nothing here knows masses, constraints or solvers.

mod boxes;
mod broad;
mod cluster;
mod contact;
mod detector;
mod error;
mod field;
mod grid;
mod limit;
mod motion;
mod narrow;
mod obstacle;
mod outside;
mod parallel;
mod proximity;
mod surface;
mod thin;

pub use contact::{Contact, Report, Times};
pub use detector::{Detector, Options};
pub use error::CollisionError;
pub use field::Field;
pub use obstacle::{Obstacle, Pose, Shape};
