//! What runs kernels.

use std::fmt;
use std::ops::Range;

use crate::{CountDown, Element, Expand, Host, Lower, Map, Memory, Scatter, Select, Update, Views};

/// Runs kernels over arrays that it keeps.
///
/// A *list* is a set of element indices, the domain of every run: the uncolored vertices, one color class. Its length may be
/// known to a device only, so a schedule says "until empty" ([`Backend::rounds`]) instead of looking.
///
/// A schedule cannot fail. What a device could not do (no memory, device lost) is remembered by the array or list that lacks it,
/// passes on to whatever is computed from that, and comes out where data reach the host: [`Backend::read`], [`Backend::indices`].
pub trait Backend {
    /// What can go wrong; [`std::convert::Infallible`] on the host.
    type Error: std::error::Error + Send + Sync + 'static;
    /// Where arrays live.
    type Memory: Memory;
    /// An array of `T`, owned.
    type Buffer<T: Element>: Send + 'static;
    /// A set of element indices.
    type List: Clone + Send;

    /// An array of `len` times `value`.
    fn filled<T: Element>(&self, len: usize, value: T) -> Self::Buffer<T>;

    /// An array that holds a copy of `data`.
    fn upload<T: Element>(&self, data: &[T]) -> Self::Buffer<T>;

    /// A view of an array.
    fn view<'a, T: Element>(&self, buffer: &'a Self::Buffer<T>) -> View<'a, Self, T>;

    /// The array, on the host.
    ///
    /// # Errors
    /// What went wrong in computing it or on its way.
    fn read<T: Element>(&self, buffer: Self::Buffer<T>) -> Result<Vec<T>, Self::Error>;

    /// Puts `data` in place of the first elements of an array. Those past the array's end are left away.
    fn write<T: Element>(&self, buffer: &mut Self::Buffer<T>, data: &[T]);

    /// Copies the first elements of an array to the host, as many as there are in `elements`, which the array has.
    ///
    /// # Errors
    /// What went wrong in computing them or on their way; `elements` are then as they were.
    fn fetch<T: Element>(&self, buffer: &Self::Buffer<T>, elements: &mut [T]) -> Result<(), Self::Error>;

    /// The list of all indices below `len`.
    fn all(&self, len: usize) -> Self::List;

    /// The list of the indices in `range`. On a device it takes no memory, and a run over it looks nothing up.
    fn range(&self, range: Range<u32>) -> Self::List;

    /// The indices of a list on the host, ascending.
    ///
    /// # Errors
    /// What went wrong in computing it or on its way.
    fn indices(&self, list: &Self::List) -> Result<Vec<u32>, Self::Error>;

    /// Writes element `i` of `output` for each `i` in `list`.
    fn map<'a, K: Map>(
        &self,
        list: &Self::List,
        uniform: impl Into<Params<'a, Self, K::Uniform>>,
        inputs: Views<'_, K, Self::Memory>,
        output: &mut Self::Buffer<K::Output>,
    );

    /// Updates element `i` of `state` for each `i` in `list`, all at once.
    fn update<'a, K: Update>(
        &self,
        list: &Self::List,
        uniform: impl Into<Params<'a, Self, K::Uniform>>,
        inputs: Views<'_, K, Self::Memory>,
        state: &mut Self::Buffer<K::State>,
    );

    /// As [`Backend::update`], one after another in ascending order: each sees what those before it wrote.
    fn update_in_order<K: Update>(
        &self,
        list: &Self::List,
        uniform: &K::Uniform,
        inputs: Views<'_, K, Self::Memory>,
        state: &mut Self::Buffer<K::State>,
    );

    /// Writes to `state` what `K` scatters for each `i` in `list`, and element `i` of `own`, all at once.
    fn scatter<'a, K: Scatter<N>, const N: usize>(
        &self,
        list: &Self::List,
        uniform: impl Into<Params<'a, Self, K::Uniform>>,
        inputs: Views<'_, K, Self::Memory>,
        state: &mut Self::Buffer<K::State>,
        own: &mut Self::Buffer<K::Own>,
    );

    /// As [`Backend::scatter`], one after another in ascending order: each sees what those before it wrote, and may write it, too.
    fn scatter_in_order<K: Scatter<N>, const N: usize>(
        &self,
        list: &Self::List,
        uniform: &K::Uniform,
        inputs: Views<'_, K, Self::Memory>,
        state: &mut Self::Buffer<K::State>,
        own: &mut Self::Buffer<K::Own>,
    );

    /// Takes out of `list` what `K` selects, and returns it. May write element `i` of `output` for each `i` that was in `list`.
    fn select<K: Select>(
        &self,
        list: &mut Self::List,
        uniform: &K::Uniform,
        inputs: Views<'_, K, Self::Memory>,
        output: &mut Self::Buffer<K::Output>,
    ) -> Self::List;

    /// Writes to `items` what `K` finds for each `i` in `list`, invocation by invocation, as far as there is room, and returns the list of
    /// the elements written. Adds to the first two elements of `counts` how many these are, and how many found no room.
    fn expand<K: Expand>(
        &self,
        list: &Self::List,
        uniform: &K::Uniform,
        inputs: Views<'_, K, Self::Memory>,
        items: &mut Self::Buffer<K::Item>,
        counts: &mut Self::Buffer<u32>,
    ) -> Self::List;

    /// Lowers elements of `lowest` to what `K` says for each `i` in `list`.
    fn lower<K: Lower<N>, const N: usize>(
        &self,
        list: &Self::List,
        uniform: &K::Uniform,
        inputs: Views<'_, K, Self::Memory>,
        lowest: &mut Self::Buffer<u32>,
    );

    /// The elements of `keys` by key: for each key below `n_keys`, of which there are [`MOST_KEYS`](crate::MOST_KEYS) at most, the list of
    /// the elements that have it, ascending. Those with larger keys are in none.
    fn group_by(&self, keys: &Self::Buffer<u32>, n_keys: u32) -> Vec<Self::List>;

    /// Takes one from each counter that is a target of each `i` in `list`.
    fn count_down<K: CountDown>(
        &self,
        list: &Self::List,
        uniform: &K::Uniform,
        inputs: Views<'_, K, Self::Memory>,
        counters: &mut Self::Buffer<u32>,
    );

    /// Runs `round` with 0, 1, … until `list` is empty or `limit` rounds have run; returns how many ran and, over all of them,
    /// how many elements the list held at their beginning.
    fn rounds(
        &self,
        limit: u32,
        list: &mut Self::List,
        round: impl FnMut(u32, &mut Self::List),
    ) -> RoundCount;
}

/// The parameters of a run. `&uniform` is one: known to the host.
pub enum Params<'a, B: Backend + ?Sized, U: Element> {
    /// Known to the host.
    Known(&'a U),
    /// An element of an array, as it is when the run comes to it. It begins at a multiple of [`PARAMS_BYTES`], and there are as many behind
    /// it.
    Found(&'a B::Buffer<U>, usize),
}

/// Where parameters in an array may begin: see [`Params::Found`].
pub const PARAMS_BYTES: usize = 256;

impl<B: Backend + ?Sized, U: Element> Clone for Params<'_, B, U> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<B: Backend + ?Sized, U: Element> Copy for Params<'_, B, U> {}

impl<B: Backend + ?Sized, U: Element> fmt::Debug for Params<'_, B, U> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if matches!(self, Self::Known(_)) { "Known" } else { "Found" })
    }
}

impl<'a, B: Backend + ?Sized, U: Element> From<&'a U> for Params<'a, B, U> {
    fn from(known: &'a U) -> Self {
        Self::Known(known)
    }
}

impl<'a, B: Backend<Memory = Host> + ?Sized, U: Element> Params<'a, B, U>
where
    B::Buffer<U>: AsRef<[U]>,
{
    /// The parameters, where arrays lie on the host.
    pub fn on_host(self) -> &'a U {
        match self {
            Self::Known(known) => known,
            Self::Found(array, idx) => &array.as_ref()[idx],
        }
    }
}

/// A view in the memory of backend `B`.
pub type View<'a, B, T> = <<B as Backend>::Memory as Memory>::View<'a, T>;

/// What a loop over rounds did: the same on every machine.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct RoundCount {
    /// Rounds run.
    pub rounds: u32,
    /// Sum over the rounds of the elements that were in the list when the round began.
    pub visits: u64,
}
