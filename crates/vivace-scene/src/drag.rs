//! Patches that follow a path, and are let go.

use glam::{EulerRot, Quat, Vec3};
use serde::{Deserialize, Serialize};
use vivace_model::State;

use crate::Select;

/// Vertices that are dragged: taken where they are in the frame of the path's first key, led along it, and let go.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Drag {
    /// Which vertices.
    pub select: Select,
    /// How they are held.
    #[serde(default)]
    pub hold: Hold,
    /// Where they go.
    pub path: Path,
    /// When they are let go \[s\]; never if left out.
    #[serde(default)]
    pub release: Option<f64>,
}

/// How particles are held.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Hold {
    /// They are where they are led, whatever pulls at them.
    #[default]
    Pin,
    /// A spring of this stiffness \[N/m\] pulls each there.
    Spring(f32),
}

/// A way through time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Path {
    /// Where it leads, at ascending times. Before the first key and after the last it stands.
    pub keys: Vec<Key>,
    /// Between keys.
    #[serde(default)]
    pub between: Between,
}

/// Where a patch is at some time, seen from where it was taken.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Key {
    /// Since the start of the scene \[s\].
    pub time: f64,
    /// Moved by this \[m\].
    #[serde(default)]
    pub at: Vec3,
    /// Turned about its own middle: about the x axis, then y, then z \[degrees\]. Angles are interpolated as they are, so 720 is two turns.
    #[serde(default)]
    pub rotate: Vec3,
}

/// How a path leads from key to key.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Between {
    /// Straight, at a steady speed.
    #[default]
    Linear,
    /// With a steady velocity through each key, at rest in the first and the last: a cubic from key to key, whose velocity in a key is
    /// the mean one between its neighbors (Catmull-Rom).
    Smooth,
}

/// A displacement: turned by `rotation`, then moved by `at` \[m\].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pose {
    /// \[m\].
    pub at: Vec3,
    /// About the middle of what is moved.
    pub rotation: Quat,
}

impl Pose {
    /// Nowhere else.
    pub const IDENTITY: Self = Self { at: Vec3::ZERO, rotation: Quat::IDENTITY };

    /// Where a point of a patch about `middle` goes \[m\]: exactly where it was under [`Pose::IDENTITY`].
    #[must_use]
    pub fn apply(&self, middle: Vec3, point: Vec3) -> Vec3 {
        if self.rotation == Quat::IDENTITY {
            return point + self.at;
        }
        middle + self.rotation * (point - middle) + self.at
    }
}

impl Path {
    /// Straight through `keys`.
    #[must_use]
    pub fn through(keys: Vec<Key>) -> Self {
        Self { keys, between: Between::Linear }
    }

    /// When it begins \[s\]; 0 without keys.
    #[must_use]
    pub fn start(&self) -> f64 {
        self.keys.first().map_or(0.0, |key| key.time)
    }

    /// Where it is at `time` \[s\].
    #[must_use]
    pub fn pose(&self, time: f64) -> Pose {
        let [at, turned] = self.sample(time);
        let [x, y, z] = turned.to_array().map(f32::to_radians);
        let rotation =
            if turned == Vec3::ZERO { Quat::IDENTITY } else { Quat::from_euler(EulerRot::XYZEx, x, y, z) };
        Pose { at, rotation }
    }

    /// Way \[m\] and angles \[degrees\] at `time` \[s\].
    fn sample(&self, time: f64) -> [Vec3; 2] {
        let values = |key: &Key| [key.at, key.rotate];
        let next = self.keys.partition_point(|key| key.time <= time);
        let (Some(before), Some(after)) = (next.checked_sub(1).map(|k| &self.keys[k]), self.keys.get(next))
        else {
            let nearest = if next == 0 { self.keys.first() } else { self.keys.last() };
            return nearest.map_or([Vec3::ZERO; 2], values);
        };
        let span = after.time - before.time;
        #[expect(clippy::cast_possible_truncation, reason = "between 0 and 1; positions are f32")]
        let t = ((time - before.time) / span) as f32;
        let (a, b) = (values(before), values(after));
        if self.between == Between::Linear {
            return [0, 1].map(|k| a[k].lerp(b[k], t));
        }
        // Displacements over this span at the velocities in both keys.
        let speed = |key: usize| {
            let around = key.checked_sub(1).and_then(|k| self.keys.get(k)).zip(self.keys.get(key + 1));
            around.map_or([Vec3::ZERO; 2], |(before, after)| {
                #[expect(clippy::cast_possible_truncation, reason = "positions are f32")]
                let share = (span / (after.time - before.time)) as f32;
                let (a, b) = (values(before), values(after));
                [0, 1].map(|k| (b[k] - a[k]) * share)
            })
        };
        let (u, v) = (speed(next - 1), speed(next));
        // Hermite's cubic.
        [0, 1].map(|k| {
            let d = b[k] - a[k];
            a[k] + t * (u[k] + t * (3.0 * d - 2.0 * u[k] - v[k] + t * (u[k] + v[k] - 2.0 * d)))
        })
    }
}

impl Drag {
    /// Whether it can be done.
    pub(crate) fn check(&self) -> Result<(), PathError> {
        let keys = &self.path.keys;
        if keys.is_empty() {
            return Err(PathError::Empty);
        }
        for (key, Key { time, at, rotate }) in keys.iter().enumerate() {
            let is_after = key == 0 || *time > keys[key - 1].time;
            if !(time.is_finite() && is_after) {
                return Err(PathError::Time { key, time: *time });
            }
            if let Some(&value) = [at, rotate].into_iter().find(|v| !State::is_in_range(**v)) {
                return Err(PathError::Place { key, value });
            }
        }
        match (self.release, self.hold) {
            (Some(release), _) if release.is_nan() || release <= self.path.start() => {
                Err(PathError::Release { release, start: self.path.start() })
            }
            (_, Hold::Spring(stiffness)) if !(stiffness > 0.0 && stiffness.is_finite()) => {
                Err(PathError::Stiffness { stiffness })
            }
            _ => Ok(()),
        }
    }
}

/// Why a drag is refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PathError {
    /// No keys.
    #[error("the path has no keys; give at least where it begins: `keys: [(time: 0)]`")]
    Empty,
    /// Times that do not ascend.
    #[error("key {key} is at {time} s; times must be finite, each after the one before")]
    Time {
        /// Which, from 0.
        key: usize,
        /// \[s\].
        time: f64,
    },
    /// A place that is none.
    #[error("key {key} has {value}; ways and angles must be finite, and at most 1e12")]
    Place {
        /// Which, from 0.
        key: usize,
        /// The way \[m\] or the angles \[degrees\].
        value: Vec3,
    },
    /// Let go before it is taken.
    #[error("it is let go at {release} s, and taken at {start} s; let it go later, or leave `release` out")]
    Release {
        /// \[s\].
        release: f64,
        /// \[s\].
        start: f64,
    },
    /// A spring that is none.
    #[error("its stiffness is {stiffness} N/m; it must be finite and positive, or `hold: Pin`")]
    Stiffness {
        /// \[N/m\].
        stiffness: f32,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(time: f64, at: Vec3, rotate: Vec3) -> Key {
        Key { time, at, rotate }
    }

    fn path(between: Between) -> Path {
        let corner = key(2.0, Vec3::X, Vec3::new(0.0, 90.0, 0.0));
        let keys =
            vec![key(1.0, Vec3::ZERO, Vec3::ZERO), corner, key(4.0, Vec3::new(1.0, 4.0, 0.0), corner.rotate)];
        Path { keys, between }
    }

    #[test]
    fn a_path_goes_through_its_keys_and_stands_outside() {
        for between in [Between::Linear, Between::Smooth] {
            let path = path(between);
            for (time, at) in [(-1.0, Vec3::ZERO), (9.0, Vec3::new(1.0, 4.0, 0.0))] {
                assert_eq!(path.pose(time).at, at);
            }
            for key in &path.keys {
                assert_eq!(path.pose(key.time).at, key.at);
            }
            let turned = path.pose(2.0).apply(Vec3::ONE, Vec3::new(2.0, 1.0, 1.0)) - path.pose(2.0).at;
            assert!(turned.distance(Vec3::new(1.0, 1.0, 0.0)) < 1e-6, "{turned}");
        }
        assert_eq!(path(Between::Linear).pose(1.25).at, 0.25 * Vec3::X);
        let odd = Vec3::new(0.1, 0.7, -3.3);
        assert_eq!(Pose::IDENTITY.apply(Vec3::splat(0.123), odd), odd);
    }

    /// Position and velocity have no jumps, and the velocity in a key is the one that is written there.
    #[test]
    fn a_smooth_path_is_smooth() {
        let path = path(Between::Smooth);
        let velocity = |time: f64| (path.pose(time + 1e-3).at - path.pose(time - 1e-3).at) / 2e-3;
        for (time, expected) in [(1.0, Vec3::ZERO), (2.0, Vec3::new(1.0, 4.0, 0.0) / 3.0), (4.0, Vec3::ZERO)]
        {
            for around in [-2e-3, 0.0, 2e-3] {
                let found = velocity(time + around);
                assert!(found.distance(expected) < 0.03, "{time}: {found}");
            }
        }
    }

    #[test]
    fn what_cannot_be_is_refused() {
        let select = Select::Vertices(vec![0]);
        let drag = |keys: Vec<Key>, hold, release| Drag {
            select: select.clone(),
            hold,
            path: Path::through(keys),
            release,
        };
        let good = key(0.0, Vec3::ZERO, Vec3::ZERO);
        assert_eq!(drag(vec![good], Hold::Pin, Some(1.0)).check(), Ok(()));
        let bad = [
            drag(vec![], Hold::Pin, None),
            drag(vec![good, good], Hold::Pin, None),
            drag(vec![key(f64::NAN, Vec3::ZERO, Vec3::ZERO)], Hold::Pin, None),
            drag(vec![key(0.0, Vec3::NAN, Vec3::ZERO)], Hold::Pin, None),
            drag(vec![key(0.0, Vec3::ZERO, Vec3::INFINITY)], Hold::Pin, None),
            drag(vec![good], Hold::Pin, Some(0.0)),
            drag(vec![good], Hold::Pin, Some(f64::NAN)),
            drag(vec![good], Hold::Spring(0.0), None),
        ];
        for drag in bad {
            let error = drag.check().unwrap_err().to_string();
            assert!(error.contains("; "), "{error}");
        }
    }
}
