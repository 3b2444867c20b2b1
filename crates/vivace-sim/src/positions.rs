//! Positions on their way to the host.

#[cfg(feature = "gpu")]
use std::sync::Arc;

use crate::{SimError, Vec3};

/// The positions of a frame, which may still be on their way from a GPU: [`Simulation::read_positions`] makes it. Its memory there is used
/// again when it goes, arrived or not.
///
/// [`Simulation::read_positions`]: crate::Simulation::read_positions
#[derive(Debug)]
#[must_use = "positions that nobody asks for are read in vain"]
pub struct PendingPositions(Place);

#[derive(Debug)]
enum Place {
    Here(Vec<Vec3>),
    #[cfg(feature = "gpu")]
    OnTheWay(vivace_gpu::ReadBack<glam::Vec4>, Arc<[u32]>),
}

impl PendingPositions {
    pub(crate) fn here(positions: Vec<Vec3>) -> Self {
        Self(Place::Here(positions))
    }

    /// `place` is where each particle is in the copy.
    #[cfg(feature = "gpu")]
    pub(crate) fn on_the_way(copy: vivace_gpu::ReadBack<glam::Vec4>, place: Arc<[u32]>) -> Self {
        Self(Place::OnTheWay(copy, place))
    }

    /// The positions \[m\] if they have arrived, else `None`. The host does not wait.
    ///
    /// # Errors
    /// The GPU was lost.
    pub fn try_read(&mut self) -> Result<Option<Vec<Vec3>>, SimError> {
        Ok(match &mut self.0 {
            Place::Here(positions) => Some(positions.clone()),
            #[cfg(feature = "gpu")]
            Place::OnTheWay(copy, place) => copy.try_read()?.map(|there| placed(&there, place)),
        })
    }

    /// The positions \[m\]. The host waits for them, and for no frame after theirs.
    ///
    /// # Errors
    /// The GPU was lost.
    pub fn wait(self) -> Result<Vec<Vec3>, SimError> {
        Ok(match self.0 {
            Place::Here(positions) => positions,
            #[cfg(feature = "gpu")]
            Place::OnTheWay(copy, place) => placed(&copy.wait()?, &place),
        })
    }
}

/// In the model's order.
#[cfg(feature = "gpu")]
fn placed(there: &[glam::Vec4], place: &[u32]) -> Vec<Vec3> {
    place.iter().map(|&slot| there[slot as usize].truncate()).collect()
}
