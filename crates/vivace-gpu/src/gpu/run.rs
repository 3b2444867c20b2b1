//! How a kernel runs: what is bound, which grid, and the dispatches between kernels that fill arrays and split lists.

use std::ops::Range;
use std::sync::Arc;

use bytemuck::Zeroable;
use vivace_kernels::{
    Element, Expand, Inputs, Kernel, ListShader, MOST_KEYS, PARAMS_BYTES, Params, Select, Shader,
    ViewVisitor, Views,
};

use super::{Gpu, HEADERS_BYTES, MOST_BIND_GROUPS, counts_bytes, decisions_bytes, places_bytes};
use crate::list::{Elements, HEADER_BYTES, Indices};
use crate::memory::{Allocation, Buffer, GpuMemory, array_bytes};
use crate::pipeline::{Pipeline, UNIFORM_BYTES};
use crate::recorder::{GROUP, Grid, Uniform, uniform_binding};
use crate::{GpuError, Grids, List};

/// Elements that an invocation updates in order, as in `update_in_order.wgsl`.
const IN_ORDER: usize = 4;

/// Which lists a run is about, as in `run.wgsl`.
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct Run {
    list: u32,
    kept: u32,
    selected: u32,
    value: u32,
    first: u32,
    len: u32,
}

/// In place of a list: a range.
const RANGE: u32 = u32::MAX;

/// What is bound of an array without elements: a device takes no less than one of them, and no buffer is smaller than this.
const EMPTY_BYTES: u64 = 256;

/// What is bound to a binding.
#[derive(Clone, Copy)]
enum Bound<'a> {
    /// The first bytes of a buffer.
    Array(&'a wgpu::Buffer, u64),
    /// The uniforms, at an offset that comes with the dispatch.
    Uniform,
    /// Uniforms that the device has made, likewise.
    Found(&'a wgpu::Buffer),
}

/// The arrays that a kernel writes.
#[derive(Clone, Copy)]
struct Written<'a> {
    arrays: &'a [Bound<'a>],
    /// Elements of the array of which each invocation writes its own.
    len: usize,
}

impl<'a> Written<'a> {
    fn one(array: &'a Bound<'a>, len: usize) -> Self {
        Self { arrays: std::slice::from_ref(array), len }
    }
}

impl<T: Element> Buffer<T> {
    fn bound(&self) -> Result<Bound<'_>, GpuError> {
        Ok(Bound::Array(self.raw()?, self.n_bytes()))
    }
}

impl Indices {
    fn bound(&self) -> Bound<'_> {
        Bound::Array(&self.memory.buffer, array_bytes::<u32>(self.capacity))
    }
}

/// Collects the arrays that a kernel reads.
struct Binder<'a> {
    bound: Vec<Bound<'a>>,
    failed: Option<GpuError>,
}

impl<'a> ViewVisitor<'a, GpuMemory> for Binder<'a> {
    fn view<T: Element>(&mut self, view: &'a Buffer<T>) {
        match view.bound() {
            Ok(bound) => self.bound.push(bound),
            Err(error) => self.failed = Some(error),
        }
    }
}

impl Gpu {
    /// Records one dispatch that binds `groups`.
    fn dispatch(
        &self,
        pipeline: &Pipeline,
        groups: &[Vec<Bound<'_>>],
        uniforms: [Uniform<'_>; 2],
        grid: Grid<'_>,
    ) {
        let bytes = groups.iter().map(|group| self.bytes(group)).sum();
        let groups = self.bind(pipeline, groups);
        self.recorder.borrow_mut().dispatch(pipeline, &groups, uniforms, grid, bytes);
    }

    /// Bind groups of what is bound, made once: buffers come back from the pool, so the same are asked for again and again.
    fn bind(&self, pipeline: &Pipeline, groups: &[Vec<Bound<'_>>]) -> Vec<wgpu::BindGroup> {
        let arrays = groups.iter().flatten().filter_map(|bound| match *bound {
            Bound::Array(buffer, bytes) => Some((buffer.clone(), bytes)),
            Bound::Found(buffer) => Some((buffer.clone(), 0)),
            Bound::Uniform => None,
        });
        let key = (pipeline.pipeline.clone(), arrays.collect());
        let mut made = self.bind_groups.borrow_mut();
        if made.len() > MOST_BIND_GROUPS {
            made.clear();
        }
        made.entry(key).or_insert_with(|| self.bind_groups(pipeline, groups)).clone()
    }

    fn bind_groups(&self, pipeline: &Pipeline, groups: &[Vec<Bound<'_>>]) -> Vec<wgpu::BindGroup> {
        let recorder = self.recorder.borrow();
        let bind = |(layout, bound): (&wgpu::BindGroupLayout, &Vec<Bound<'_>>)| {
            let entries: Vec<_> = (0..)
                .zip(bound)
                .map(|(binding, bound)| wgpu::BindGroupEntry {
                    binding,
                    resource: match *bound {
                        Bound::Array(buffer, bytes) => wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                            buffer,
                            offset: 0,
                            size: wgpu::BufferSize::new(if bytes == 0 { EMPTY_BYTES } else { bytes }),
                        }),
                        Bound::Uniform => recorder.uniform_binding(),
                        Bound::Found(buffer) => uniform_binding(buffer),
                    },
                })
                .collect();
            let descriptor = wgpu::BindGroupDescriptor { label: None, layout, entries: &entries };
            self.device.create_bind_group(&descriptor)
        };
        pipeline.layouts.iter().zip(groups).map(bind).collect()
    }

    /// Bytes of what is bound, as a profile counts them.
    fn bytes(&self, bound: &[Bound<'_>]) -> f64 {
        let bytes = |bound: &Bound<'_>| match *bound {
            Bound::Array(buffer, bytes) if *buffer != self.header_array => bytes as f64,
            Bound::Array(..) | Bound::Uniform | Bound::Found(_) => 0.0,
        };
        bound.iter().map(bytes).sum()
    }

    fn bound_headers(&self) -> Bound<'_> {
        Bound::Array(&self.header_array, HEADERS_BYTES)
    }

    /// The grid of a run over a list.
    fn grid(&self, elements: &Elements) -> Grid<'_> {
        let list = match elements {
            Elements::Listed(list) => list,
            Elements::Range(range) => return Grid::Groups(range.len().div_ceil(GROUP)),
        };
        match self.grids {
            Grids::Indirect => {
                Grid::Indirect(&self.header_array, u64::from(list.header.place) * HEADER_BYTES)
            }
            Grids::Bounds => Grid::Groups(list.capacity.div_ceil(GROUP)),
        }
    }

    /// Runs a kernel over a list. `work` is where a select writes what it decides, or an expansion where it goes on, and whether that
    /// is known.
    fn run<K: Kernel>(
        &self,
        shader: &Shader,
        list: &Elements,
        params: Params<'_, Self, K::Uniform>,
        inputs: Views<'_, K, GpuMemory>,
        written: Written<'_>,
        work: Option<(Bound<'_>, u32)>,
    ) -> Result<(), GpuError> {
        const { assert!(size_of::<K::Uniform>() <= UNIFORM_BYTES, "a uniform has 256 bytes at most") };
        const { assert!(PARAMS_BYTES == UNIFORM_BYTES, "where the device finds them, too") };
        let mut own =
            Binder { bound: Vec::with_capacity(K::Inputs::LEN + written.arrays.len()), failed: None };
        K::Inputs::visit(inputs, &mut own);
        if let Some(error) = own.failed {
            return Err(error);
        }
        let mut own = own.bound;
        own.extend_from_slice(written.arrays);
        let (bound, over) = match list {
            Elements::Listed(list) => (list.bound(), Run { list: list.header.place, ..Run::zeroed() }),
            // Nothing is looked up, but something has to be bound.
            Elements::Range(range) => {
                let (first, len) = (range.start, range.end.saturating_sub(range.start));
                (self.bound_headers(), Run { list: RANGE, first, len, ..Run::zeroed() })
            }
        };
        let (bound_params, params) = match params {
            Params::Known(params) => (Bound::Uniform, Uniform::Bytes(bytemuck::bytes_of(params))),
            Params::Found(array, idx) => {
                let offset = u32::try_from(array_bytes::<K::Uniform>(idx)).unwrap_or(u32::MAX);
                (Bound::Found(array.raw()?), Uniform::At(offset))
            }
        };
        let mut run = vec![self.bound_headers(), bound, Bound::Uniform, bound_params];
        run.extend(work.map(|(bound, _)| bound));
        let share = (list.capacity() as f64 / written.len.max(1) as f64).min(1.0);
        let bytes = share * self.bytes(&own) + self.bytes(&run);
        let pipeline = self.pipelines.kernel::<K>(&self.device, shader);
        let groups = self.bind(&pipeline, &[run, own]);
        let dispatch = |value: u32, grid: Grid<'_>| {
            let run = Run { value, ..over };
            let uniforms = [Uniform::Bytes(bytemuck::bytes_of(&run)), params];
            self.recorder.borrow_mut().dispatch(&pipeline, &groups, uniforms, grid, bytes);
        };
        if shader.form.is_in_order() {
            let n = match list {
                Elements::Listed(list) => self.len(list)?,
                Elements::Range(_) => over.len,
            };
            (0..n).step_by(IN_ORDER).for_each(|first| dispatch(first, Grid::Groups(1)));
        } else {
            dispatch(work.map_or(0, |(_, value)| value), self.grid(list));
        }
        Ok(())
    }

    /// Runs a kernel that writes an array and nothing else.
    pub(super) fn run_over<K: Kernel, T: Element>(
        &self,
        shader: &Shader,
        list: &List,
        params: Params<'_, Self, K::Uniform>,
        inputs: Views<'_, K, GpuMemory>,
        output: &mut Buffer<T>,
    ) {
        let written = list.state().and_then(|list| {
            self.run::<K>(shader, list, params, inputs, Written::one(&output.bound()?, output.len), None)
        });
        if let Err(error) = written {
            output.memory = Err(error);
        }
    }

    /// Runs a kernel that writes two arrays.
    pub(super) fn write_both<K: Kernel, T: Element, U: Element>(
        &self,
        shader: &Shader,
        list: &List,
        params: Params<'_, Self, K::Uniform>,
        inputs: Views<'_, K, GpuMemory>,
        first: &mut Buffer<T>,
        second: &mut Buffer<U>,
    ) {
        let written = list.state().and_then(|list| {
            let written = Written { arrays: &[first.bound()?, second.bound()?], len: second.len };
            self.run::<K>(shader, list, params, inputs, written, None)
        });
        if let Err(error) = written {
            first.memory = Err(error.clone());
            second.memory = Err(error);
        }
    }

    /// The lists of those kept and of those selected.
    pub(super) fn try_select<K: Select>(
        &self,
        list: &List,
        uniform: &K::Uniform,
        inputs: Views<'_, K, GpuMemory>,
        output: &Buffer<K::Output>,
    ) -> Result<[Arc<Indices>; 2], GpuError> {
        let list = self.listed(list)?;
        let bytes = decisions_bytes(list.capacity);
        let memory = self.work(bytes)?;
        let decisions = Bound::Array(&memory.buffer, bytes);
        let (kept, selected) = (self.list(list.capacity)?, self.list(list.capacity)?);
        let (elements, shader) = (Elements::Listed(list.clone()), Shader::select::<K>());
        let bound = output.bound()?;
        let written = Written::one(&bound, output.len);
        self.run::<K>(&shader, &elements, uniform.into(), inputs, written, Some((decisions, 0)))?;
        let places = Run {
            list: list.header.place,
            kept: kept.header.place,
            selected: selected.header.place,
            ..Run::zeroed()
        };
        let uniforms = [Uniform::Bytes(bytemuck::bytes_of(&places)), Uniform::NONE];
        let scan = self.pipelines.list(&self.device, ListShader::Scan);
        let groups = [vec![self.bound_headers(), decisions, Bound::Uniform]];
        self.dispatch(&scan, &groups, uniforms, Grid::Groups(1));
        let split = self.pipelines.list(&self.device, ListShader::Split);
        let groups = [
            vec![self.bound_headers(), list.bound(), Bound::Uniform],
            vec![decisions, kept.bound(), selected.bound()],
        ];
        self.dispatch(&split, &groups, uniforms, self.grid(&elements));
        Ok([kept, selected])
    }

    /// The list of the items written.
    pub(super) fn try_expand<K: Expand>(
        &self,
        list: &List,
        uniform: &K::Uniform,
        inputs: Views<'_, K, GpuMemory>,
        items: &Buffer<K::Item>,
        counts: &Buffer<u32>,
    ) -> Result<Arc<Indices>, GpuError> {
        let elements = list.state()?;
        let bytes = places_bytes(elements.capacity());
        let memory = self.work(bytes)?;
        let places = Bound::Array(&memory.buffer, bytes);
        let found = self.list(items.len)?;
        let (shader, bound) = (Shader::expand::<K>(), items.bound()?);
        let written = Written::one(&bound, items.len);
        self.run::<K>(&shader, elements, uniform.into(), inputs, written, Some((places, 0)))?;
        let (value, selected) = (u32::try_from(items.len).unwrap_or(u32::MAX), found.header.place);
        let run = match elements {
            Elements::Listed(list) => Run { list: list.header.place, value, selected, ..Run::zeroed() },
            Elements::Range(range) => {
                let len = range.end.saturating_sub(range.start);
                Run { list: RANGE, len, value, selected, ..Run::zeroed() }
            }
        };
        let uniforms = [Uniform::Bytes(bytemuck::bytes_of(&run)), Uniform::NONE];
        let place = self.pipelines.list(&self.device, ListShader::Place);
        let groups = [vec![self.bound_headers(), places, Bound::Uniform, counts.bound()?]];
        self.dispatch(&place, &groups, uniforms, Grid::Groups(1));
        self.run::<K>(&shader, elements, uniform.into(), inputs, written, Some((places, 1)))?;
        let number = self.pipelines.list(&self.device, ListShader::Number);
        let groups = [vec![self.bound_headers(), found.bound(), Bound::Uniform]];
        self.dispatch(&number, &groups, uniforms, self.grid(&Elements::Listed(found.clone())));
        Ok(found)
    }

    /// The lists of a sort, in memory that they share.
    pub(super) fn try_group_by(
        &self,
        keys: &Buffer<u32>,
        n_keys: u32,
    ) -> Result<Vec<Arc<Indices>>, GpuError> {
        let n_keys = n_keys.min(MOST_KEYS);
        let memory = Arc::new(self.work(array_bytes::<u32>(keys.len))?);
        let lists: Vec<_> = (0..n_keys).map(|_| self.list_in(&memory, keys.len)).collect::<Result<_, _>>()?;
        let bytes = counts_bytes(keys.len, n_keys);
        let counts = self.work(bytes)?;
        let (bound_keys, counts) = (keys.bound()?, Bound::Array(&counts.buffer, bytes));
        let run = Run { value: words(keys.n_bytes()), len: n_keys, ..Run::zeroed() };
        let run = Uniform::Bytes(bytemuck::bytes_of(&run));
        let mut places = [0_u32; MOST_KEYS as usize];
        places.iter_mut().zip(&lists).for_each(|(place, list)| *place = list.header.place);
        let places = Uniform::Bytes(bytemuck::bytes_of(&places));
        let n_groups = keys.len.div_ceil(GROUP);
        let pipeline = |shader| self.pipelines.list(&self.device, shader);
        let groups = [vec![bound_keys, counts, Bound::Uniform]];
        let grid = || Grid::Groups(n_groups);
        self.dispatch(&pipeline(ListShader::CountKeys), &groups, [run, Uniform::NONE], grid());
        let groups = [vec![self.bound_headers(), counts, Bound::Uniform, Bound::Uniform]];
        self.dispatch(&pipeline(ListShader::ScanKeys), &groups, [run, places], Grid::Groups(1));
        let all = Bound::Array(&memory.buffer, array_bytes::<u32>(keys.len));
        let groups = [vec![bound_keys, counts, all, Bound::Uniform]];
        self.dispatch(&pipeline(ListShader::PlaceKeys), &groups, [run, Uniform::NONE], grid());
        Ok(lists)
    }

    pub(super) fn try_filled<T: Element>(&self, len: usize, value: T) -> Result<Allocation, GpuError> {
        const { assert!(size_of::<T>() <= 64, "a value has 16 words at most") };
        let bytes = array_bytes::<T>(len);
        let memory = self.work(bytes)?;
        if bytes > 0 {
            let run = Run { list: words(array_bytes::<T>(1)), value: words(bytes), ..Run::zeroed() };
            let mut padded = [0; 64];
            padded[..size_of::<T>()].copy_from_slice(bytemuck::bytes_of(&value));
            let fill = self.pipelines.list(&self.device, ListShader::Fill);
            let groups = [vec![Bound::Array(&memory.buffer, bytes), Bound::Uniform, Bound::Uniform]];
            let grid = Grid::Groups((run.value as usize).div_ceil(GROUP));
            let uniforms = [bytemuck::bytes_of(&run), &padded].map(Uniform::Bytes);
            self.dispatch(&fill, &groups, uniforms, grid);
        }
        Ok(memory)
    }

    pub(super) fn try_upload<T: Element>(&self, data: &[T]) -> Result<Allocation, GpuError> {
        let memory = self.work(array_bytes::<T>(data.len()))?;
        if !data.is_empty() {
            self.recorder.borrow_mut().upload(&memory.buffer, bytemuck::cast_slice(data));
        }
        Ok(memory)
    }

    /// The list with memory for its indices: that of a range is made.
    pub(super) fn listed(&self, list: &List) -> Result<Arc<Indices>, GpuError> {
        match list.state()? {
            Elements::Listed(list) => Ok(list.clone()),
            Elements::Range(range) => self.try_list(range.start as usize..range.end as usize),
        }
    }

    pub(super) fn try_list(&self, range: Range<usize>) -> Result<Arc<Indices>, GpuError> {
        let len = range.len();
        let list = self.list(len)?;
        let value = words(array_bytes::<u32>(len));
        // Where there is a list, its indices have 32 bits.
        let first = u32::try_from(range.start).unwrap_or(u32::MAX);
        let run = Run { list: list.header.place, value, first, ..Run::zeroed() };
        let all = self.pipelines.list(&self.device, ListShader::All);
        let groups = [vec![self.bound_headers(), list.bound(), Bound::Uniform]];
        let grid = Grid::Groups(len.div_ceil(GROUP).max(1));
        self.dispatch(&all, &groups, [Uniform::Bytes(bytemuck::bytes_of(&run)), Uniform::NONE], grid);
        Ok(list)
    }
}

fn words(bytes: u64) -> u32 {
    u32::try_from(bytes / 4).unwrap_or_else(|_| unreachable!("no array is larger"))
}
