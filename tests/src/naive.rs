//! A second backend: what a kernel run means, in the fewest words.
//!
//! One plain loop per form, on one thread, in *descending* order: gathers must not care. Lists are ordered sets, updates read a
//! copy of the array as it was. It also holds kernels to their contract: an [`Update`] or a [`Scatter`] that reads what the same run
//! writes would differ when done in place, and is refused, as is a [`Scatter`] that writes an element twice.

use std::collections::BTreeSet;
use std::convert::Infallible;
use std::ops::Range;

use vivace_coloring::{Algorithm, ConstraintGraph, GraphBuffers, RoundColoring};
use vivace_kernels::{
    Backend, CountDown, Element, Expand, Host, Kernel, Lower, Map, Params, RoundCount, Scatter, Select,
    Update, View, Views,
};

use crate::generators::to_u32;

/// The backend, right or wrong on purpose.
#[derive(Debug, Clone, Copy, Default)]
pub struct Naive {
    /// What is wrong with it; `None` for a right one.
    pub fault: Option<Fault>,
}

/// A mistake that a backend could make: comparisons with [`Naive`] must notice each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// A map leaves out the last element of its list.
    MapStopsShort,
    /// A selected element stays in the list, too.
    SelectedStays,
    /// What was selected is forgotten: the last of it never arrives.
    SelectionLosesOne,
    /// A counter that two elements count down goes down by one.
    CountDownCollides,
    /// Rounds are numbered from 1.
    RoundsFromOne,
    /// Visits are counted after the round.
    VisitsCountedLate,
}

impl Fault {
    /// Each of them.
    pub const ALL: [Self; 6] = [
        Self::MapStopsShort,
        Self::SelectedStays,
        Self::SelectionLosesOne,
        Self::CountDownCollides,
        Self::RoundsFromOne,
        Self::VisitsCountedLate,
    ];
}

impl Naive {
    fn has(self, fault: Fault) -> bool {
        self.fault == Some(fault)
    }
}

/// Whether the elements are the same, bit for bit.
fn same<T: Element>(a: &[T], b: &[T]) -> bool {
    bytemuck::cast_slice::<T, u8>(a) == bytemuck::cast_slice::<T, u8>(b)
}

impl Backend for Naive {
    type Error = Infallible;
    type Memory = Host;
    type Buffer<T: Element> = Vec<T>;
    type List = BTreeSet<u32>;

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
        let n = buffer.len().min(data.len());
        buffer[..n].copy_from_slice(&data[..n]);
    }

    fn fetch<T: Element>(&self, buffer: &Vec<T>, elements: &mut [T]) -> Result<(), Infallible> {
        elements.copy_from_slice(&buffer[..elements.len()]);
        Ok(())
    }

    fn all(&self, len: usize) -> BTreeSet<u32> {
        (0..to_u32(len)).collect()
    }

    fn range(&self, range: Range<u32>) -> BTreeSet<u32> {
        range.collect()
    }

    fn indices(&self, list: &BTreeSet<u32>) -> Result<Vec<u32>, Infallible> {
        Ok(list.iter().copied().collect())
    }

    fn map<'a, K: Map>(
        &self,
        list: &BTreeSet<u32>,
        uniform: impl Into<Params<'a, Self, K::Uniform>>,
        inputs: Views<'_, K, Host>,
        output: &mut Vec<K::Output>,
    ) {
        let uniform = uniform.into().on_host();
        for &i in list.iter().rev().skip(usize::from(self.has(Fault::MapStopsShort))) {
            K::map(i, uniform, inputs, &mut output[i as usize]);
        }
    }

    fn update<'a, K: Update>(
        &self,
        list: &BTreeSet<u32>,
        uniform: impl Into<Params<'a, Self, K::Uniform>>,
        inputs: Views<'_, K, Host>,
        state: &mut Vec<K::State>,
    ) {
        let uniform = uniform.into().on_host();
        let (before, mut in_place) = (state.clone(), state.clone());
        for &i in list.iter().rev() {
            state[i as usize] = K::update(i, uniform, inputs, &before);
            in_place[i as usize] = K::update(i, uniform, inputs, &in_place);
        }
        assert!(same(state, &in_place), "{} reads what the same run writes", <K as Kernel>::NAME);
    }

    fn update_in_order<K: Update>(
        &self,
        list: &BTreeSet<u32>,
        uniform: &K::Uniform,
        inputs: Views<'_, K, Host>,
        state: &mut Vec<K::State>,
    ) {
        for &i in list {
            state[i as usize] = K::update(i, uniform, inputs, state);
        }
    }

    fn scatter<'a, K: Scatter<N>, const N: usize>(
        &self,
        list: &BTreeSet<u32>,
        uniform: impl Into<Params<'a, Self, K::Uniform>>,
        inputs: Views<'_, K, Host>,
        state: &mut Vec<K::State>,
        own: &mut Vec<K::Own>,
    ) {
        let uniform = uniform.into().on_host();
        let (before, mut in_place, mut own_in_place) = (state.clone(), state.clone(), own.clone());
        let mut touched = BTreeSet::new();
        for &i in list.iter().rev() {
            let written = K::scatter(i, uniform, inputs, &before, &mut own[i as usize]);
            for (at, value) in written.into_iter().flatten() {
                assert!(touched.insert(at), "{}: element {at} is written twice", <K as Kernel>::NAME);
                state[at as usize] = value;
            }
            let written = K::scatter(i, uniform, inputs, &in_place, &mut own_in_place[i as usize]);
            for (at, value) in written.into_iter().flatten() {
                in_place[at as usize] = value;
            }
        }
        let is_same = same(state, &in_place) && same(own, &own_in_place);
        assert!(is_same, "{} reads what the same run writes", <K as Kernel>::NAME);
    }

    fn scatter_in_order<K: Scatter<N>, const N: usize>(
        &self,
        list: &BTreeSet<u32>,
        uniform: &K::Uniform,
        inputs: Views<'_, K, Host>,
        state: &mut Vec<K::State>,
        own: &mut Vec<K::Own>,
    ) {
        for &i in list {
            let written = K::scatter(i, uniform, inputs, state, &mut own[i as usize]);
            for (at, value) in written.into_iter().flatten() {
                state[at as usize] = value;
            }
        }
    }

    fn select<K: Select>(
        &self,
        list: &mut BTreeSet<u32>,
        uniform: &K::Uniform,
        inputs: Views<'_, K, Host>,
        output: &mut Vec<K::Output>,
    ) -> BTreeSet<u32> {
        let mut selected = BTreeSet::new();
        for &i in list.iter().rev() {
            if K::select(i, uniform, inputs, &mut output[i as usize]) {
                selected.insert(i);
            }
        }
        if !self.has(Fault::SelectedStays) {
            list.retain(|i| !selected.contains(i));
        }
        if self.has(Fault::SelectionLosesOne) {
            selected.pop_last();
        }
        selected
    }

    fn expand<K: Expand>(
        &self,
        list: &BTreeSet<u32>,
        uniform: &K::Uniform,
        inputs: Views<'_, K, Host>,
        items: &mut Vec<K::Item>,
        counts: &mut Vec<u32>,
    ) -> BTreeSet<u32> {
        let mut found = Vec::new();
        for &i in list {
            K::expand(i, uniform, inputs, &mut |item| found.push(item));
        }
        let n = found.len().min(items.len());
        items[..n].copy_from_slice(&found[..n]);
        counts[0] += to_u32(n);
        counts[1] += to_u32(found.len() - n);
        (0..to_u32(n)).collect()
    }

    fn lower<K: Lower<N>, const N: usize>(
        &self,
        list: &BTreeSet<u32>,
        uniform: &K::Uniform,
        inputs: Views<'_, K, Host>,
        lowest: &mut Vec<u32>,
    ) {
        for &i in list.iter().rev() {
            for (at, value) in K::lower(i, uniform, inputs).into_iter().flatten() {
                lowest[at as usize] = lowest[at as usize].min(value);
            }
        }
    }

    fn group_by(&self, keys: &Vec<u32>, n_keys: u32) -> Vec<BTreeSet<u32>> {
        let of_key = |key| (0..to_u32(keys.len())).filter(|&i| keys[i as usize] == key).collect();
        (0..n_keys).map(of_key).collect()
    }

    fn count_down<K: CountDown>(
        &self,
        list: &BTreeSet<u32>,
        uniform: &K::Uniform,
        inputs: Views<'_, K, Host>,
        counters: &mut Vec<u32>,
    ) {
        let mut touched = BTreeSet::new();
        for &i in list.iter().rev() {
            for &target in K::targets(i, uniform, inputs) {
                if touched.insert(target) || !self.has(Fault::CountDownCollides) {
                    counters[target as usize] = counters[target as usize].saturating_sub(1);
                }
            }
        }
    }

    fn rounds(
        &self,
        limit: u32,
        list: &mut BTreeSet<u32>,
        mut round: impl FnMut(u32, &mut BTreeSet<u32>),
    ) -> RoundCount {
        let mut count = RoundCount::default();
        while count.rounds < limit && !list.is_empty() {
            let before = list.len() as u64;
            round(count.rounds + u32::from(self.has(Fault::RoundsFromOne)), list);
            count.rounds += 1;
            count.visits += if self.has(Fault::VisitsCountedLate) { list.len() as u64 } else { before };
        }
        count
    }
}

/// All that a round-based coloring tells, on the host.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rounds {
    /// Color of each vertex, before unused numbers are closed up.
    pub colors: Vec<u32>,
    /// Rounds and visits.
    pub count: RoundCount,
    /// Who was colored one by one at the end.
    pub stragglers: Vec<u32>,
}

/// Runs a round-based algorithm on any backend; `None` for a serial one.
///
/// # Panics
/// When the device fails.
pub fn in_rounds<B: Backend>(backend: &B, algorithm: Algorithm, graph: &ConstraintGraph) -> Option<Rounds> {
    let graph = GraphBuffers::upload(backend, graph);
    let RoundColoring { colors, count, stragglers } = algorithm.run(backend, graph.view(backend))?;
    let stragglers = backend.indices(&stragglers).expect("a device that works");
    Some(Rounds { stragglers, count, colors: backend.read(colors).expect("a device that works") })
}
