//! Arrays in the device's memory. What is freed waits in a pool for the next array of its size: a coloring after the first
//! allocates nothing.

use std::collections::HashMap;
use std::fmt;
use std::marker::PhantomData;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use vivace_kernels::{Element, Memory};

use crate::GpuError;

/// The device's memory: a view is a reference to a [`Buffer`].
#[derive(Debug)]
pub struct GpuMemory;

impl Memory for GpuMemory {
    type View<'a, T: Element> = &'a Buffer<T>;

    fn shorten<'short, 'long: 'short, T: Element>(view: &'long Buffer<T>) -> &'short Buffer<T> {
        view
    }
}

/// An array in the device's memory, or why there is none.
pub struct Buffer<T> {
    pub(crate) memory: Result<Allocation, GpuError>,
    pub(crate) len: usize,
    pub(crate) element: PhantomData<T>,
}

impl<T: Element> Buffer<T> {
    pub(crate) fn new(len: usize, memory: Result<Allocation, GpuError>) -> Self {
        Self { memory, len, element: PhantomData }
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

    /// The elements where they lie, for a pipeline of the caller's: nothing is copied, and nobody waits.
    ///
    /// - Layout: [`Buffer::len`] elements from the buffer's start, one after another as they are in Rust; what is behind them
    ///   holds nothing. Usages: `STORAGE`, `UNIFORM`, `VERTEX`, `COPY_SRC` and `COPY_DST`. Positions are four `f32` a particle, the fourth of
    ///   which is no coordinate: `Float32x3` with a stride of 16.
    /// - Order: call [`crate::Gpu::submit`], then submit to [`crate::Gpu::queue`]. All that was recorded here before is done
    ///   first, and what is recorded here afterwards comes later. What is not submitted, the caller's commands do not see.
    /// - Lifetime: as long as this array. Then the memory goes to the next array that asks, even if the caller keeps a clone.
    ///
    /// # Errors
    /// Why there is no such array.
    pub fn raw(&self) -> Result<&wgpu::Buffer, GpuError> {
        Ok(&self.memory()?.buffer)
    }

    pub(crate) fn memory(&self) -> Result<&Allocation, GpuError> {
        self.memory.as_ref().map_err(Clone::clone)
    }

    /// Bytes that hold elements.
    pub(crate) fn n_bytes(&self) -> u64 {
        array_bytes::<T>(self.len)
    }
}

impl<T> fmt::Debug for Buffer<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Buffer").field("len", &self.len).finish_non_exhaustive()
    }
}

/// Bytes of `len` elements. WGSL knows words only.
pub(crate) fn array_bytes<T>(len: usize) -> u64 {
    const { assert!(size_of::<T>().is_multiple_of(4), "whole words of 32 bits") };
    len as u64 * size_of::<T>() as u64
}

/// What a buffer is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Purpose {
    /// Kernels read and write it.
    Work,
    /// The host reads it.
    Staging,
}

impl Purpose {
    pub(crate) fn usage(self) -> wgpu::BufferUsages {
        match self {
            Self::Work => {
                wgpu::BufferUsages::STORAGE
                    | wgpu::BufferUsages::UNIFORM
                    | wgpu::BufferUsages::VERTEX
                    | wgpu::BufferUsages::COPY_SRC
                    | wgpu::BufferUsages::COPY_DST
            }
            Self::Staging => wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        }
    }
}

/// Buffers that wait to be used again, of the type that the device (or, for [`crate::Footprint`], nobody) has for them.
pub(crate) struct Pool<B> {
    limit: u64,
    state: Mutex<PoolState<B>>,
}

struct PoolState<B> {
    free: HashMap<(Purpose, u64), Vec<B>>,
    allocated: u64,
}

impl<B: Clone> Pool<B> {
    /// No array may be larger than `limit`.
    pub(crate) fn new(limit: u64) -> Self {
        Self { limit, state: Mutex::new(PoolState { free: HashMap::new(), allocated: 0 }) }
    }

    /// A buffer of at least `bytes`, from the pool or from `make`.
    pub(crate) fn take(
        self: &Arc<Self>,
        purpose: Purpose,
        bytes: u64,
        make: impl FnOnce(u64, u64) -> Result<B, GpuError>,
    ) -> Result<Allocation<B>, GpuError> {
        if bytes > self.limit {
            return Err(GpuError::TooLarge { bytes, limit: self.limit });
        }
        let size = size_class(bytes).min(self.limit);
        let waiting = self.state().free.get_mut(&(purpose, size)).and_then(Vec::pop);
        let buffer = match waiting {
            Some(buffer) => buffer,
            None => {
                let buffer = make(size, self.allocated())?;
                self.state().allocated += size;
                buffer
            }
        };
        Ok(Allocation { buffer, pool: self.clone(), purpose, size })
    }

    /// Bytes of all buffers, in use or not.
    pub(crate) fn allocated(&self) -> u64 {
        self.state().allocated
    }

    /// Lets go of what is not in use.
    pub(crate) fn trim(&self) {
        let mut state = self.state();
        let freed: u64 = state.free.iter().map(|(&(_, size), buffers)| size * buffers.len() as u64).sum();
        state.allocated -= freed;
        state.free.clear();
    }

    fn state(&self) -> MutexGuard<'_, PoolState<B>> {
        locked(&self.state)
    }
}

/// The next of eight sizes to each doubling: arrays whose length changes a little from frame to frame find their buffer again.
fn size_class(bytes: u64) -> u64 {
    bytes.next_multiple_of((bytes.next_power_of_two() / 16).max(256)).max(256)
}

/// What a mutex guards. A panic elsewhere while it was held leaves counts and free lists usable.
pub(crate) fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A buffer that goes back to its pool. Commands recorded before run before those that use it next, so it may go back at once.
pub(crate) struct Allocation<B: Clone = wgpu::Buffer> {
    pub(crate) buffer: B,
    pool: Arc<Pool<B>>,
    purpose: Purpose,
    size: u64,
}

impl<B: Clone> Drop for Allocation<B> {
    fn drop(&mut self) {
        let buffer = self.buffer.clone();
        self.pool.state().free.entry((self.purpose, self.size)).or_default().push(buffer);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn size_classes_waste_little() {
        for bytes in [0, 1, 255, 256, 257, 1000, 4096, 4097, 1_000_000, 123_456_789, 1 << 27] {
            let size = size_class(bytes);
            assert!(size >= bytes && size.is_multiple_of(256) && size_class(size) == size, "{bytes}: {size}");
            assert!(bytes < 4096 || size < bytes + bytes / 8, "{bytes}: {size}");
        }
        assert_eq!(size_class(1 << 27), 1 << 27);
    }

    #[test]
    fn what_is_freed_is_used_again() {
        let pool = Arc::new(Pool::<()>::new(10_000));
        let make = |_, _| Ok(());
        drop(pool.take(Purpose::Work, 1000, make).unwrap());
        let again = pool.take(Purpose::Work, 900, make).unwrap();
        assert_eq!(pool.allocated(), 1024);
        drop(pool.take(Purpose::Staging, 900, make).unwrap());
        assert_eq!(pool.allocated(), 2048);
        pool.trim();
        assert_eq!(pool.allocated(), 1024);
        drop(again);
        let too_large = pool.take(Purpose::Work, 10_001, make).err();
        assert_eq!(too_large, Some(GpuError::TooLarge { bytes: 10_001, limit: 10_000 }));
    }
}
