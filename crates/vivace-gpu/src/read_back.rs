//! Reading without waiting: an array is copied aside, and the host asks later whether the copy has arrived.

use std::marker::PhantomData;
use std::sync::mpsc::{self, Receiver, TryRecvError};
use std::sync::{Arc, OnceLock};

use vivace_kernels::Element;

use crate::GpuError;
use crate::memory::{Allocation, array_bytes};

/// A copy of an array, on its way to the host. [`crate::Gpu::read_back`] makes it; there may be several at the same time, and in
/// whichever order they are asked for, each holds what its array held when it was made.
///
/// Its memory is counted in [`crate::Gpu::allocated`], and goes back to the pool with it, arrived or not.
#[must_use = "a copy that nobody asks for is made in vain"]
pub struct ReadBack<T> {
    /// Nothing is on its way if there are no bytes.
    copy: Option<Copy>,
    len: usize,
    device: wgpu::Device,
    lost: Arc<OnceLock<String>>,
    element: PhantomData<T>,
}

/// Memory that the host is about to see.
struct Copy {
    staging: Allocation,
    submission: wgpu::SubmissionIndex,
    arrival: Receiver<Result<(), wgpu::BufferAsyncError>>,
    has_arrived: bool,
}

impl<T: Element> ReadBack<T> {
    pub(crate) fn new(
        device: wgpu::Device,
        lost: Arc<OnceLock<String>>,
        len: usize,
        copy: Option<(Allocation, wgpu::SubmissionIndex)>,
    ) -> Self {
        let copy = copy.map(|(staging, submission)| {
            let (sender, arrival) = mpsc::channel();
            let mapped = staging.buffer.slice(..array_bytes::<T>(len));
            mapped.map_async(wgpu::MapMode::Read, move |mapped| {
                // Whoever let go of the copy does not listen any more.
                let _ = sender.send(mapped);
            });
            Copy { staging, submission, arrival, has_arrived: false }
        });
        Self { copy, len, device, lost, element: PhantomData }
    }

    /// Number of elements.
    #[must_use]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The elements if they have arrived, else `None`. The host does not wait. They stay here: another call gives them again.
    ///
    /// # Errors
    /// The device was lost.
    pub fn try_read(&mut self) -> Result<Option<Vec<T>>, GpuError> {
        let has_arrived = self.arrive(wgpu::PollType::Poll)?;
        if !has_arrived {
            return Ok(None);
        }
        let mut elements = vec![T::zeroed(); self.len];
        self.copy_to(&mut elements)?;
        Ok(Some(elements))
    }

    /// The elements. The host waits for them, and for nothing that was submitted after them.
    ///
    /// # Errors
    /// The device was lost.
    pub fn wait(self) -> Result<Vec<T>, GpuError> {
        let mut elements = vec![T::zeroed(); self.len];
        self.wait_in(&mut elements)?;
        Ok(elements)
    }

    /// As [`ReadBack::wait`], in memory of the caller's, as long as the array.
    pub(crate) fn wait_in(mut self, elements: &mut [T]) -> Result<(), GpuError> {
        let submission_index = self.copy.as_ref().map(|copy| copy.submission.clone());
        let arrived = self.arrive(wgpu::PollType::Wait { submission_index, timeout: None })?;
        if arrived { self.copy_to(elements) } else { Err(self.lost()) }
    }

    /// Whether the copy has arrived, once the device was polled.
    fn arrive(&mut self, poll: wgpu::PollType) -> Result<bool, GpuError> {
        let Some(copy) = self.copy.as_mut().filter(|copy| !copy.has_arrived) else { return Ok(true) };
        let is_polled = self.device.poll(poll).is_ok();
        match copy.arrival.try_recv() {
            Ok(Ok(())) => copy.has_arrived = true,
            Err(TryRecvError::Empty) if is_polled && self.lost.get().is_none() => return Ok(false),
            Ok(Err(_)) | Err(_) => return Err(self.lost()),
        }
        Ok(true)
    }

    fn copy_to(&self, elements: &mut [T]) -> Result<(), GpuError> {
        if let Some(copy) = &self.copy {
            let bytes = array_bytes::<T>(self.len);
            let mapped = copy.staging.buffer.get_mapped_range(..bytes).map_err(|_| self.lost())?;
            bytemuck::cast_slice_mut(elements).copy_from_slice(&mapped);
        }
        Ok(())
    }

    fn lost(&self) -> GpuError {
        GpuError::lost(&self.lost)
    }
}

/// Memory in the pool is not mapped, nor about to be.
impl<T> Drop for ReadBack<T> {
    fn drop(&mut self) {
        if let Some(copy) = &self.copy {
            // A device that is gone has taken its buffers along, and panics about an error that nobody catches.
            let scope = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
            copy.staging.buffer.unmap();
            drop(scope);
        }
    }
}

impl<T> std::fmt::Debug for ReadBack<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ReadBack").field("len", &self.len).finish_non_exhaustive()
    }
}
