//! How much memory an algorithm takes on a device, found by running its schedule without one.

use std::convert::Infallible;
use std::marker::PhantomData;
use std::ops::Range;
use std::sync::Arc;

use vivace_kernels::{
    Backend, CountDown, Element, Expand, Lower, Map, Memory, Params, RoundCount, Scatter, Select, Update,
    View, Views,
};

use crate::GpuError;
use crate::gpu::{FIXED_BYTES, HEADERS_BYTES, counts_bytes, decisions_bytes, places_bytes};
use crate::memory::{Allocation, Pool, Purpose, array_bytes};

/// A [`Backend`] that computes nothing and counts the bytes that [`crate::Gpu`] would allocate: it has the same pool, without
/// buffers in it.
///
/// ```
/// use vivace_coloring::{Algorithm, Vivace};
/// use vivace_gpu::Footprint;
///
/// let algorithm = Algorithm::Vivace(Vivace::DEFAULT);
/// let bytes = Footprint::of(|device| algorithm.rehearse(device, 1_000_000, 3_000_000));
/// assert!(bytes < 60_000_000);
/// ```
///
/// What keeps its device, as a simulation does, takes a clone, whose bytes are counted here, too.
#[derive(Clone)]
pub struct Footprint {
    pool: Arc<Pool<()>>,
}

impl Footprint {
    /// Bytes that a fresh [`crate::Gpu`] has allocated after `schedule`. Loops over rounds are taken to run, and to end before their
    /// limit.
    pub fn of<R>(schedule: impl FnOnce(&Self) -> R) -> u64 {
        let footprint = Self::new();
        drop(schedule(&footprint));
        footprint.allocated()
    }

    /// A device that nothing was asked of yet.
    #[must_use]
    pub fn new() -> Self {
        Self { pool: Arc::new(Pool::new(u64::MAX)) }
    }

    /// What [`crate::Gpu::allocated`] would say.
    #[must_use]
    pub fn allocated(&self) -> u64 {
        FIXED_BYTES + self.pool.allocated()
    }

    fn take(&self, purpose: Purpose, bytes: u64) -> Allocation<()> {
        let taken = self.pool.take(purpose, bytes, |_, _| Ok::<_, GpuError>(()));
        taken.unwrap_or_else(|error| unreachable!("no limit, no device: {error}"))
    }

    fn list(&self, capacity: usize) -> FootprintList {
        let memory = Arc::new(self.take(Purpose::Work, array_bytes::<u32>(capacity)));
        FootprintList { memory: Some(memory), capacity }
    }

    /// The list, with memory for its indices.
    fn listed(&self, list: &FootprintList) -> FootprintList {
        if list.memory.is_some() { list.clone() } else { self.list(list.capacity) }
    }

    fn array<T: Element>(&self, len: usize) -> FootprintBuffer<T> {
        let memory = self.take(Purpose::Work, array_bytes::<T>(len));
        FootprintBuffer { _memory: memory, len, element: PhantomData }
    }
}

impl Default for Footprint {
    fn default() -> Self {
        Self::new()
    }
}

/// No memory at all.
#[derive(Debug)]
pub struct NoMemory;

impl Memory for NoMemory {
    type View<'a, T: Element> = ();

    fn shorten<'short, 'long: 'short, T: Element>((): ()) {}
}

/// The size of an array.
pub struct FootprintBuffer<T> {
    _memory: Allocation<()>,
    len: usize,
    element: PhantomData<T>,
}

/// The size of a list.
#[derive(Clone)]
pub struct FootprintList {
    /// `None` for a range.
    memory: Option<Arc<Allocation<()>>>,
    capacity: usize,
}

type NoViews<'a, K> = Views<'a, K, NoMemory>;

impl Backend for Footprint {
    type Error = Infallible;
    type Memory = NoMemory;
    type Buffer<T: Element> = FootprintBuffer<T>;
    type List = FootprintList;

    fn filled<T: Element>(&self, len: usize, _: T) -> FootprintBuffer<T> {
        self.array(len)
    }

    fn upload<T: Element>(&self, data: &[T]) -> FootprintBuffer<T> {
        self.array(data.len())
    }

    fn view<'a, T: Element>(&self, _: &'a FootprintBuffer<T>) -> View<'a, Self, T> {}

    fn read<T: Element>(&self, buffer: FootprintBuffer<T>) -> Result<Vec<T>, Infallible> {
        if buffer.len > 0 {
            self.take(Purpose::Staging, array_bytes::<T>(buffer.len));
        }
        Ok(Vec::new())
    }

    fn write<T: Element>(&self, _: &mut FootprintBuffer<T>, _: &[T]) {}

    fn fetch<T: Element>(&self, _: &FootprintBuffer<T>, elements: &mut [T]) -> Result<(), Infallible> {
        if !elements.is_empty() {
            self.take(Purpose::Staging, array_bytes::<T>(elements.len()));
        }
        Ok(())
    }

    fn all(&self, len: usize) -> FootprintList {
        self.list(len)
    }

    fn range(&self, range: Range<u32>) -> FootprintList {
        FootprintList { memory: None, capacity: range.len() }
    }

    fn indices(&self, list: &FootprintList) -> Result<Vec<u32>, Infallible> {
        if list.capacity > 0 && list.memory.is_some() {
            self.take(Purpose::Staging, HEADERS_BYTES);
        }
        Ok(Vec::new())
    }

    fn map<'a, K: Map>(
        &self,
        _: &FootprintList,
        _: impl Into<Params<'a, Self, K::Uniform>>,
        _: NoViews<'_, K>,
        _: &mut FootprintBuffer<K::Output>,
    ) {
    }

    fn update<'a, K: Update>(
        &self,
        _: &FootprintList,
        _: impl Into<Params<'a, Self, K::Uniform>>,
        _: NoViews<'_, K>,
        _: &mut FootprintBuffer<K::State>,
    ) {
    }

    fn update_in_order<K: Update>(
        &self,
        _: &FootprintList,
        _: &K::Uniform,
        _: NoViews<'_, K>,
        _: &mut FootprintBuffer<K::State>,
    ) {
    }

    fn scatter<'a, K: Scatter<N>, const N: usize>(
        &self,
        _: &FootprintList,
        _: impl Into<Params<'a, Self, K::Uniform>>,
        _: NoViews<'_, K>,
        _: &mut FootprintBuffer<K::State>,
        _: &mut FootprintBuffer<K::Own>,
    ) {
    }

    fn scatter_in_order<K: Scatter<N>, const N: usize>(
        &self,
        _: &FootprintList,
        _: &K::Uniform,
        _: NoViews<'_, K>,
        _: &mut FootprintBuffer<K::State>,
        _: &mut FootprintBuffer<K::Own>,
    ) {
    }

    fn select<K: Select>(
        &self,
        list: &mut FootprintList,
        _: &K::Uniform,
        _: NoViews<'_, K>,
        _: &mut FootprintBuffer<K::Output>,
    ) -> FootprintList {
        let list_before = self.listed(list);
        let _decisions = self.take(Purpose::Work, decisions_bytes(list.capacity));
        let (kept, selected) = (self.list(list.capacity), self.list(list.capacity));
        drop(list_before);
        *list = kept;
        selected
    }

    fn expand<K: Expand>(
        &self,
        list: &FootprintList,
        _: &K::Uniform,
        _: NoViews<'_, K>,
        items: &mut FootprintBuffer<K::Item>,
        _: &mut FootprintBuffer<u32>,
    ) -> FootprintList {
        let _places = self.take(Purpose::Work, places_bytes(list.capacity));
        self.list(items.len)
    }

    fn lower<K: Lower<N>, const N: usize>(
        &self,
        _: &FootprintList,
        _: &K::Uniform,
        _: NoViews<'_, K>,
        _: &mut FootprintBuffer<u32>,
    ) {
    }

    fn group_by(&self, keys: &FootprintBuffer<u32>, n_keys: u32) -> Vec<FootprintList> {
        let _counts = self.take(Purpose::Work, counts_bytes(keys.len, n_keys));
        vec![self.list(keys.len); n_keys as usize]
    }

    fn count_down<K: CountDown>(
        &self,
        _: &FootprintList,
        _: &K::Uniform,
        _: NoViews<'_, K>,
        _: &mut FootprintBuffer<u32>,
    ) {
    }

    /// Three rounds: from then on, what a round takes lies in the pool.
    fn rounds(
        &self,
        limit: u32,
        list: &mut FootprintList,
        mut round: impl FnMut(u32, &mut FootprintList),
    ) -> RoundCount {
        if list.capacity > 0 {
            *list = self.listed(list);
            (0..limit.min(3)).for_each(|next| round(next, list));
            self.take(Purpose::Staging, HEADERS_BYTES);
        }
        RoundCount::default()
    }
}

impl std::fmt::Debug for Footprint {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Footprint").field("allocated", &self.pool.allocated()).finish()
    }
}
