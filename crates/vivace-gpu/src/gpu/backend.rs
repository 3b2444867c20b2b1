//! The forms of kernels, lists and rounds.

use std::ops::Range;
use std::sync::Arc;

use vivace_kernels::{
    Backend, CountDown, Element, Expand, Lower, Map, Params, RoundCount, Scatter, Select, Shader, Update,
    View, Views,
};

use super::Gpu;
use crate::list::{Elements, Header};
use crate::memory::{Buffer, GpuMemory};
use crate::{GpuError, List};

/// Rounds in the first batch. The paper's coloring ends within it on a mesh.
const FIRST_BATCH: u32 = 8;

/// No batch is longer: each of its rounds keeps a header.
const LARGEST_BATCH: u32 = 128;

impl Gpu {
    /// Whether the list of which this is the header is known to be empty.
    fn is_seen_empty(&self, header: &Header) -> bool {
        self.seen_len(header) == Some(0)
    }

    /// Counts rounds of which the host may not know yet whether anything was left to do. Looks if it has not since.
    fn count(&self, begun: &mut Vec<Arc<Header>>, count: &mut RoundCount) -> Result<(), GpuError> {
        if begun.last().is_some_and(|header| self.seen_len(header).is_none()) {
            self.look()?;
        }
        for len in begun.drain(..).filter_map(|header| self.seen_len(&header)).filter(|&len| len > 0) {
            count.rounds += 1;
            count.visits += u64::from(len);
        }
        Ok(())
    }
}

impl Backend for Gpu {
    type Error = GpuError;
    type Memory = GpuMemory;
    type Buffer<T: Element> = Buffer<T>;
    type List = List;

    fn filled<T: Element>(&self, len: usize, value: T) -> Buffer<T> {
        Buffer::new(len, self.try_filled(len, value))
    }

    fn upload<T: Element>(&self, data: &[T]) -> Buffer<T> {
        Buffer::new(data.len(), self.try_upload(data))
    }

    fn view<'a, T: Element>(&self, buffer: &'a Buffer<T>) -> View<'a, Self, T> {
        buffer
    }

    fn read<T: Element>(&self, buffer: Buffer<T>) -> Result<Vec<T>, GpuError> {
        self.download(buffer.raw()?, buffer.len)
    }

    fn write<T: Element>(&self, buffer: &mut Buffer<T>, data: &[T]) {
        if let Ok(memory) = &buffer.memory
            && !data.is_empty()
        {
            let data = &data[..data.len().min(buffer.len)];
            self.recorder.borrow_mut().upload(&memory.buffer, bytemuck::cast_slice(data));
        }
    }

    fn fetch<T: Element>(&self, buffer: &Buffer<T>, elements: &mut [T]) -> Result<(), GpuError> {
        self.download_to(buffer.raw()?, elements)
    }

    fn all(&self, len: usize) -> List {
        List::listed(self.try_list(0..len))
    }

    fn range(&self, range: Range<u32>) -> List {
        List { state: Ok(Elements::Range(range)) }
    }

    fn indices(&self, list: &List) -> Result<Vec<u32>, GpuError> {
        match list.state()? {
            Elements::Listed(list) => {
                let [first, len] = self.extent(list)?.map(|n| n as usize);
                let mut indices = self.download(&list.memory.buffer, first + len)?;
                Ok(indices.split_off(first))
            }
            Elements::Range(range) => Ok(range.clone().collect()),
        }
    }

    fn map<'a, K: Map>(
        &self,
        list: &List,
        uniform: impl Into<Params<'a, Self, K::Uniform>>,
        inputs: Views<'_, K, GpuMemory>,
        output: &mut Buffer<K::Output>,
    ) {
        self.run_over::<K, _>(&Shader::map::<K>(), list, uniform.into(), inputs, output);
    }

    fn update<'a, K: Update>(
        &self,
        list: &List,
        uniform: impl Into<Params<'a, Self, K::Uniform>>,
        inputs: Views<'_, K, GpuMemory>,
        state: &mut Buffer<K::State>,
    ) {
        self.run_over::<K, _>(&Shader::update::<K>(), list, uniform.into(), inputs, state);
    }

    /// One invocation at a time: for the few that a coloring leaves over, whose number is known since its last round.
    fn update_in_order<K: Update>(
        &self,
        list: &List,
        uniform: &K::Uniform,
        inputs: Views<'_, K, GpuMemory>,
        state: &mut Buffer<K::State>,
    ) {
        self.run_over::<K, _>(&Shader::update_in_order::<K>(), list, uniform.into(), inputs, state);
    }

    fn scatter<'a, K: Scatter<N>, const N: usize>(
        &self,
        list: &List,
        uniform: impl Into<Params<'a, Self, K::Uniform>>,
        inputs: Views<'_, K, GpuMemory>,
        state: &mut Buffer<K::State>,
        own: &mut Buffer<K::Own>,
    ) {
        self.write_both::<K, _, _>(&Shader::scatter::<K, N>(), list, uniform.into(), inputs, state, own);
    }

    fn scatter_in_order<K: Scatter<N>, const N: usize>(
        &self,
        list: &List,
        uniform: &K::Uniform,
        inputs: Views<'_, K, GpuMemory>,
        state: &mut Buffer<K::State>,
        own: &mut Buffer<K::Own>,
    ) {
        self.write_both::<K, _, _>(
            &Shader::scatter_in_order::<K, N>(),
            list,
            uniform.into(),
            inputs,
            state,
            own,
        );
    }

    fn select<K: Select>(
        &self,
        list: &mut List,
        uniform: &K::Uniform,
        inputs: Views<'_, K, GpuMemory>,
        output: &mut Buffer<K::Output>,
    ) -> List {
        match self.try_select::<K>(list, uniform, inputs, output) {
            Ok([kept, selected]) => {
                list.state = Ok(Elements::Listed(kept));
                List::listed(Ok(selected))
            }
            Err(error) => {
                output.memory = Err(error.clone());
                list.state = Err(error.clone());
                List { state: Err(error) }
            }
        }
    }

    fn expand<K: Expand>(
        &self,
        list: &List,
        uniform: &K::Uniform,
        inputs: Views<'_, K, GpuMemory>,
        items: &mut Buffer<K::Item>,
        counts: &mut Buffer<u32>,
    ) -> List {
        let found = self.try_expand::<K>(list, uniform, inputs, items, counts);
        if let Err(error) = &found {
            items.memory = Err(error.clone());
            counts.memory = Err(error.clone());
        }
        List::listed(found)
    }

    fn lower<K: Lower<N>, const N: usize>(
        &self,
        list: &List,
        uniform: &K::Uniform,
        inputs: Views<'_, K, GpuMemory>,
        lowest: &mut Buffer<u32>,
    ) {
        self.run_over::<K, _>(&Shader::lower::<K, N>(), list, uniform.into(), inputs, lowest);
    }

    fn group_by(&self, keys: &Buffer<u32>, n_keys: u32) -> Vec<List> {
        match self.try_group_by(keys, n_keys) {
            Ok(lists) => lists.into_iter().map(|list| List::listed(Ok(list))).collect(),
            Err(error) => vec![List::listed(Err(error)); n_keys as usize],
        }
    }

    fn count_down<K: CountDown>(
        &self,
        list: &List,
        uniform: &K::Uniform,
        inputs: Views<'_, K, GpuMemory>,
        counters: &mut Buffer<u32>,
    ) {
        self.run_over::<K, _>(&Shader::count_down::<K>(), list, uniform.into(), inputs, counters);
    }

    /// Records a batch of rounds, submits it, and only then looks whether the list has become empty. Rounds after that do nothing:
    /// dispatches over an empty list have no groups. Each batch is as long as all before it together, so at most half of the rounds
    /// are such, and waiting for the device, some ten rounds' time, happens a few times in all. The lengths at the beginning of each
    /// round stay in the headers, so the count is that of a host that looks before every round.
    fn rounds(&self, limit: u32, list: &mut List, mut round: impl FnMut(u32, &mut List)) -> RoundCount {
        let mut count = RoundCount::default();
        let mut begun = Vec::new();
        let mut next = 0;
        *list = List::listed(self.listed(list));
        while let Ok(Elements::Listed(indices)) = list.state()
            && next < limit
            && indices.capacity > 0
            && !self.is_seen_empty(&indices.header)
        {
            let header = indices.header.clone();
            begun.push(header.clone());
            round(next, list);
            next += 1;
            // A loop inside the round has looked at this header, too: nothing to wait for.
            let is_seen = self.seen_len(&header).is_some();
            let batch = (next / 2).clamp(FIRST_BATCH, LARGEST_BATCH);
            if is_seen || begun.len() >= batch as usize || next == limit {
                if let Err(error) = self.count(&mut begun, &mut count) {
                    list.state = Err(error);
                } else if self.is_seen_empty(&header) {
                    break;
                }
            }
        }
        count
    }
}
