//! Which particles of a body are meant.

use glam::Vec3;
use serde::{Deserialize, Serialize};

/// Some vertices of a body, in the body's own coordinates \[m\]: before it is scaled, turned and moved.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Select {
    /// The one nearest to a point; the first of several.
    Nearest(Vec3),
    /// All within a box, its faces included.
    Box {
        /// Least coordinates \[m\].
        min: Vec3,
        /// Greatest coordinates \[m\].
        max: Vec3,
    },
    /// These, by number.
    Vertices(Vec<u32>),
}

impl Select {
    /// The vertices among `positions`, ascending except for those given by number.
    ///
    /// # Errors
    /// Numbers that are not finite, a box whose least is above its greatest, a vertex that does not exist; says what to do.
    pub fn pick(&self, positions: &[Vec3]) -> Result<Vec<u32>, String> {
        let numbered = || (0_u32..).zip(positions);
        match self {
            Self::Nearest(point) => {
                if !point.is_finite() {
                    return Err(format!("the point {point} is not finite"));
                }
                let away = |p: &Vec3| p.as_dvec3().distance_squared(point.as_dvec3());
                let nearest = numbered().min_by(|(_, a), (_, b)| away(a).total_cmp(&away(b)));
                Ok(nearest.map(|(vertex, _)| vertex).into_iter().collect())
            }
            Self::Box { min, max } => {
                if !min.cmple(*max).all() {
                    return Err(format!("a box from {min} to {max}; min must not be above max, nor NaN"));
                }
                let inside = |p: &Vec3| min.cmple(*p).all() && p.cmple(*max).all();
                Ok(numbered().filter(|(_, p)| inside(p)).map(|(vertex, _)| vertex).collect())
            }
            Self::Vertices(vertices) => match vertices.iter().find(|&&v| v as usize >= positions.len()) {
                Some(vertex) => Err(format!(
                    "there is no vertex {vertex}; the body has {}, numbered from 0",
                    positions.len()
                )),
                None => Ok(vertices.clone()),
            },
        }
    }
}
