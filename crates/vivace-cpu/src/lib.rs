//! Runs Vivace kernels on the CPU.
//!
//! [`Cpu`] takes the rayon pool it is called in: `pool.install(|| …)` chooses the threads, and outside any pool rayon's global
//! one serves. [`Cpu::serial`] never touches rayon. The answers are the same, bit for bit.

mod list;

use std::convert::Infallible;
use std::ops::Range;

use rayon::prelude::*;
use vivace_kernels::{
    Backend, CountDown, Element, Expand, Host, Lower, Map, Params, RoundCount, Scatter, Select, Update, View,
    Views,
};

pub use list::List;

/// The CPU as a [`Backend`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cpu {
    /// Runs of fewer elements than this stay on the calling thread.
    grain: usize,
}

impl Cpu {
    /// Runs on the threads of the rayon pool that it is called in.
    #[must_use]
    pub const fn new() -> Self {
        // Waking another thread costs tens of microseconds: the work of some thousand vertices.
        Self { grain: 4096 }
    }

    /// Runs on the calling thread alone.
    #[must_use]
    pub const fn serial() -> Self {
        Self { grain: usize::MAX }
    }

    /// Runs `work` inside the pool, so that its many short runs are not each handed over from outside.
    pub fn enter<R: Send>(self, work: impl FnOnce() -> R + Send) -> R {
        if self.grain == usize::MAX { work() } else { rayon::scope(|_| work()) }
    }

    /// How many pieces to cut `len` elements into: some more than there are threads, so that uneven pieces even out.
    fn n_pieces(self, len: usize) -> usize {
        if len <= self.grain { 1 } else { (len / (self.grain / 2)).min(4 * rayon::current_num_threads()) }
    }
}

impl Default for Cpu {
    fn default() -> Self {
        Self::new()
    }
}

impl Backend for Cpu {
    type Error = Infallible;
    type Memory = Host;
    type Buffer<T: Element> = Vec<T>;
    type List = List;

    fn filled<T: Element>(&self, len: usize, value: T) -> Vec<T> {
        vec![value; len]
    }

    fn upload<T: Element>(&self, data: &[T]) -> Vec<T> {
        data.to_vec()
    }

    fn view<'a, T: Element>(&self, buffer: &'a Vec<T>) -> View<'a, Self, T> {
        buffer
    }

    fn read<T: Element>(&self, buffer: Vec<T>) -> Result<Vec<T>, Infallible> {
        Ok(buffer)
    }

    fn write<T: Element>(&self, buffer: &mut Vec<T>, data: &[T]) {
        buffer.iter_mut().zip(data).for_each(|(element, &value)| *element = value);
    }

    fn fetch<T: Element>(&self, buffer: &Vec<T>, elements: &mut [T]) -> Result<(), Infallible> {
        elements.copy_from_slice(&buffer[..elements.len()]);
        Ok(())
    }

    fn all(&self, len: usize) -> List {
        List::all(len)
    }

    fn range(&self, range: Range<u32>) -> List {
        List::range(range)
    }

    fn indices(&self, list: &List) -> Result<Vec<u32>, Infallible> {
        Ok(list.indices().to_vec())
    }

    fn map<'a, K: Map>(
        &self,
        list: &List,
        uniform: impl Into<Params<'a, Self, K::Uniform>>,
        inputs: Views<'_, K, Host>,
        output: &mut Vec<K::Output>,
    ) {
        let uniform = uniform.into().on_host();
        list.for_each_element(self.n_pieces(list.len()), output, |i, element| {
            K::map(i, uniform, inputs, element);
        });
    }

    fn update<'a, K: Update>(
        &self,
        list: &List,
        uniform: impl Into<Params<'a, Self, K::Uniform>>,
        inputs: Views<'_, K, Host>,
        state: &mut Vec<K::State>,
    ) {
        let uniform = uniform.into().on_host();
        // Gathered aside, then scattered: the host has no way to read and write one array from many threads.
        let n_pieces = self.n_pieces(list.len());
        let update = |&i: &u32| K::update(i, uniform, inputs, state);
        let updated: Vec<K::State> = if n_pieces == 1 {
            list.indices().iter().map(update).collect()
        } else {
            list.indices().par_iter().with_min_len(list.len().div_ceil(n_pieces)).map(update).collect()
        };
        list.scatter(n_pieces, &updated, state);
    }

    fn update_in_order<K: Update>(
        &self,
        list: &List,
        uniform: &K::Uniform,
        inputs: Views<'_, K, Host>,
        state: &mut Vec<K::State>,
    ) {
        for &i in list.indices() {
            state[i as usize] = K::update(i, uniform, inputs, state);
        }
    }

    fn scatter<'a, K: Scatter<N>, const N: usize>(
        &self,
        list: &List,
        uniform: impl Into<Params<'a, Self, K::Uniform>>,
        inputs: Views<'_, K, Host>,
        state: &mut Vec<K::State>,
        own: &mut Vec<K::Own>,
    ) {
        let uniform = uniform.into().on_host();
        let n_pieces = self.n_pieces(list.len());
        if n_pieces == 1 {
            // Nobody sees another: each may be written at once.
            return self.scatter_in_order::<K, N>(list, uniform, inputs, state, own);
        }
        // Found in parallel, then written: the host has no way to write scattered elements from many threads.
        let find = |&i: &u32| {
            let mut own = own[i as usize];
            let written = K::scatter(i, uniform, inputs, state, &mut own);
            (own, written)
        };
        let found = list.indices().par_iter().with_min_len(list.len().div_ceil(n_pieces)).map(find);
        let (owns, written): (Vec<K::Own>, Vec<_>) = found.unzip();
        list.scatter(n_pieces, &owns, own);
        for (at, value) in written.into_iter().flatten().flatten() {
            state[at as usize] = value;
        }
    }

    fn scatter_in_order<K: Scatter<N>, const N: usize>(
        &self,
        list: &List,
        uniform: &K::Uniform,
        inputs: Views<'_, K, Host>,
        state: &mut Vec<K::State>,
        own: &mut Vec<K::Own>,
    ) {
        for &i in list.indices() {
            let written = K::scatter(i, uniform, inputs, state, &mut own[i as usize]);
            for (at, value) in written.into_iter().flatten() {
                state[at as usize] = value;
            }
        }
    }

    fn select<K: Select>(
        &self,
        list: &mut List,
        uniform: &K::Uniform,
        inputs: Views<'_, K, Host>,
        output: &mut Vec<K::Output>,
    ) -> List {
        list.split_off(self.n_pieces(list.len()), output, |i, own| K::select(i, uniform, inputs, own))
    }

    fn expand<K: Expand>(
        &self,
        list: &List,
        uniform: &K::Uniform,
        inputs: Views<'_, K, Host>,
        items: &mut Vec<K::Item>,
        counts: &mut Vec<u32>,
    ) -> List {
        let find = |indices: &[u32]| {
            let mut found = Vec::new();
            indices.iter().for_each(|&i| K::expand(i, uniform, inputs, &mut |item| found.push(item)));
            found
        };
        let n_pieces = self.n_pieces(list.len());
        let pieces: Vec<Vec<K::Item>> = if n_pieces == 1 {
            vec![find(list.indices())]
        } else {
            list.indices().par_chunks(list.len().div_ceil(n_pieces)).map(find).collect()
        };
        let n_found: usize = pieces.iter().map(Vec::len).sum();
        let n = n_found.min(items.len());
        items.iter_mut().zip(pieces.into_iter().flatten()).for_each(|(item, found)| *item = found);
        for (count, more) in counts.iter_mut().zip([n, n_found - n]) {
            *count = count.saturating_add(u32::try_from(more).unwrap_or(u32::MAX));
        }
        List::all(n)
    }

    fn lower<K: Lower<N>, const N: usize>(
        &self,
        list: &List,
        uniform: &K::Uniform,
        inputs: Views<'_, K, Host>,
        lowest: &mut Vec<u32>,
    ) {
        // Found in parallel, then written, as in a scatter.
        let find = |&i: &u32| K::lower(i, uniform, inputs);
        let mut write = |(at, value): (u32, u32)| {
            let lowest = &mut lowest[at as usize];
            *lowest = (*lowest).min(value);
        };
        let n_pieces = self.n_pieces(list.len());
        if n_pieces == 1 {
            return list.indices().iter().flat_map(find).flatten().for_each(write);
        }
        let found = list.indices().par_iter().with_min_len(list.len().div_ceil(n_pieces)).map(find);
        let found: Vec<_> = found.collect();
        found.into_iter().flatten().flatten().for_each(&mut write);
    }

    fn group_by(&self, keys: &Vec<u32>, n_keys: u32) -> Vec<List> {
        let mut lists = vec![Vec::new(); n_keys as usize];
        for (i, &key) in (0..).zip(keys) {
            if let Some(list) = lists.get_mut(key as usize) {
                list.push(i);
            }
        }
        lists.into_iter().map(List::from_unsorted).collect()
    }

    fn count_down<K: CountDown>(
        &self,
        list: &List,
        uniform: &K::Uniform,
        inputs: Views<'_, K, Host>,
        counters: &mut Vec<u32>,
    ) {
        // Each thread owns a stretch of the counters and looks at every element; ascending targets tell at a glance whether an
        // element touches the stretch, and in a mesh few touch two. No atomics: they cost more than what a second thread gains.
        let n_pieces = if list.len() <= self.grain { 1 } else { rayon::current_num_threads() };
        let stretch_len = counters.len().div_ceil(n_pieces).max(1);
        let count_down = |(piece, stretch): (usize, &mut [u32])| {
            let first = piece * stretch_len;
            for &i in list.indices() {
                let targets = K::targets(i, uniform, inputs);
                let (Some(&lowest), Some(&highest)) = (targets.first(), targets.last()) else { continue };
                if (highest as usize) < first || lowest as usize >= first + stretch.len() {
                    continue;
                }
                for &target in targets {
                    if let Some(counter) = stretch.get_mut((target as usize).wrapping_sub(first)) {
                        *counter = counter.saturating_sub(1);
                    }
                }
            }
        };
        if n_pieces == 1 {
            count_down((0, counters));
        } else {
            counters.par_chunks_mut(stretch_len).enumerate().for_each(count_down);
        }
    }

    fn rounds(&self, limit: u32, list: &mut List, mut round: impl FnMut(u32, &mut List)) -> RoundCount {
        let mut count = RoundCount::default();
        while !list.is_empty() && count.rounds < limit {
            count.visits += list.len() as u64;
            round(count.rounds, list);
            count.rounds += 1;
        }
        count
    }
}
