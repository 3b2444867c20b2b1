//! Lists of element indices. A select makes new lists and leaves the old one as it is, so a copy of a list is the list itself.

use std::ops::Range;
use std::sync::{Arc, Mutex};

use crate::GpuError;
use crate::memory::{Allocation, locked};

/// Element indices in ascending order, on the device; nobody on the host knows how many. Or why there is no list.
#[derive(Clone)]
pub struct List {
    pub(crate) state: Result<Elements, GpuError>,
}

/// Which elements.
#[derive(Clone)]
pub(crate) enum Elements {
    Listed(Arc<Indices>),
    Range(Range<u32>),
}

pub(crate) struct Indices {
    /// What the lists of a sort share.
    pub(crate) memory: Arc<Allocation>,
    /// No list here is longer.
    pub(crate) capacity: usize,
    pub(crate) header: Arc<Header>,
}

impl List {
    pub(crate) fn listed(indices: Result<Arc<Indices>, GpuError>) -> Self {
        Self { state: indices.map(Elements::Listed) }
    }

    pub(crate) fn state(&self) -> Result<&Elements, GpuError> {
        self.state.as_ref().map_err(Clone::clone)
    }
}

impl Elements {
    /// No list here is longer.
    pub(crate) fn capacity(&self) -> usize {
        match self {
            Self::Listed(indices) => indices.capacity,
            Self::Range(range) => range.len(),
        }
    }
}

impl std::fmt::Debug for List {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let capacity = self.state.as_ref().map(Elements::capacity);
        f.debug_struct("List").field("capacity", &capacity).finish_non_exhaustive()
    }
}

/// Most lists at the same time.
pub(crate) const N_HEADERS: u32 = 1024;

/// A header: a grid, a length and where the list begins, see `run.wgsl`.
pub(crate) type HeaderWords = [u32; 5];

/// Bytes of a header.
pub(crate) const HEADER_BYTES: u64 = size_of::<HeaderWords>() as u64;

/// The free places for headers of lists in the device's array of them.
pub(crate) struct Headers {
    free: Mutex<Vec<u32>>,
}

impl Headers {
    pub(crate) fn new() -> Arc<Self> {
        Arc::new(Self { free: Mutex::new((0..N_HEADERS).rev().collect()) })
    }

    /// A free place, of which the host knows nothing until it has looked more than `n_looks` times.
    pub(crate) fn take(self: &Arc<Self>, n_looks: u64) -> Result<Arc<Header>, GpuError> {
        let place = locked(&self.free).pop().ok_or(GpuError::TooManyLists(N_HEADERS))?;
        Ok(Arc::new(Header { place, n_looks, headers: self.clone() }))
    }
}

/// A place in the array of headers. It is written once. Whoever wants to know a list's length later holds this, not the list.
pub(crate) struct Header {
    pub(crate) place: u32,
    /// How often the host had looked at the headers when this one was recorded.
    pub(crate) n_looks: u64,
    headers: Arc<Headers>,
}

impl Drop for Header {
    fn drop(&mut self) {
        locked(&self.headers.free).push(self.place);
    }
}
