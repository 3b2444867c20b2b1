//! How long a time step may be.

use crate::ModelError;

/// The longest time step \[s\].
const MAX_STEP: f32 = 1000.0;

/// Whether `h` \[s\] can be a time step, or the time from frame to frame: above 0 and at most 1000.
///
/// # Errors
/// It cannot.
pub fn check_time_step(h: f32) -> Result<(), ModelError> {
    if h > 0.0 && h <= MAX_STEP { Ok(()) } else { Err(ModelError::TimeStep { value: h }) }
}
