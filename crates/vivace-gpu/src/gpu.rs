//! The device, and how the forms of kernels run on it.

use std::cell::{Cell, RefCell};
use std::collections::HashMap;
use std::sync::{Arc, OnceLock, mpsc};

use bytemuck::Zeroable;
use vivace_kernels::{
    Backend, CountDown, Element, Form, Inputs, Kernel, ListShader, Map, RoundCount, Select, Shader, Update,
    View, ViewVisitor, Views,
};

use crate::list::{HEADER_BYTES, Header, Headers, Indices, N_HEADERS};
use crate::memory::{Allocation, Buffer, GpuMemory, Pool, Purpose, array_bytes};
use crate::pipeline::{Pipeline, Pipelines, UNIFORM_BYTES};
use crate::recorder::{GROUP, Grid, Recorder};
use crate::{GpuError, List};

/// Rounds in the first batch. The paper's coloring ends within it on a mesh.
const FIRST_BATCH: u32 = 8;

/// Elements that an invocation updates in order, as in `update_in_order.wgsl`.
const IN_ORDER: usize = 4;

/// Bind groups that are kept; more mean that array lengths have changed over and over.
const MOST_BIND_GROUPS: usize = 1024;

/// A pipeline, and the arrays bound to it with the bytes of each.
type BindGroupKey = (wgpu::ComputePipeline, Vec<(wgpu::Buffer, u64)>);

/// No batch is longer: each of its rounds keeps a header.
const LARGEST_BATCH: u32 = 128;

/// A GPU as a [`Backend`].
///
/// It records commands in the order of its calls, so it stays on one thread at a time; make another for another thread.
pub struct Gpu {
    device: wgpu::Device,
    adapter: wgpu::AdapterInfo,
    pool: Arc<Pool<wgpu::Buffer>>,
    pipelines: Pipelines,
    bind_groups: RefCell<HashMap<BindGroupKey, Vec<wgpu::BindGroup>>>,
    recorder: RefCell<Recorder>,
    /// The places of headers, and the headers.
    headers: Arc<Headers>,
    header_array: wgpu::Buffer,
    /// All headers as the host last saw them, and how often it has looked.
    seen: RefCell<Vec<[u32; 4]>>,
    n_looks: Cell<u64>,
    grids: Grids,
    lost: Arc<OnceLock<String>>,
}

/// Who says how large a dispatch over a list is. On a software adapter (`cargo xtask bench-gpu`; no GPU was at hand) a dispatch over
/// an empty list takes 1.3 us if indirect; by bounds 22 us with room for 256 elements, 5 ms for a million. Over full lists there is
/// no difference.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Grids {
    /// The device, from the list's length: nothing is started in vain.
    #[default]
    Indirect,
    /// The host, from the most that the list can hold: groups past its end find nothing to do.
    Bounds,
}

impl Gpu {
    /// Opens the fastest adapter of this machine. Which one it is, [`Gpu::adapter`] tells; it may be a software one.
    ///
    /// # Errors
    /// There is none, or it lacks what WebGPU promises.
    pub fn new() -> Result<Self, GpuError> {
        let descriptor = wgpu::InstanceDescriptor {
            // Without wgpu's own checks of indirect dispatches, each of which is a dispatch more (on a software adapter 17 us in
            // place of 1.4 for an empty list): the grids here come from `header` in run.wgsl, which stays inside the limits.
            flags: wgpu::InstanceFlags::empty(),
            ..wgpu::InstanceDescriptor::new_without_display_handle_from_env()
        };
        pollster::block_on(Self::open(&wgpu::Instance::new(descriptor)))
    }

    async fn open(instance: &wgpu::Instance) -> Result<Self, GpuError> {
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            ..wgpu::RequestAdapterOptions::default()
        };
        let adapter = instance.request_adapter(&options).await.map_err(|_| GpuError::NoAdapter)?;
        let name = adapter.get_info().name;
        let flags = adapter.get_downlevel_capabilities().flags;
        for (flag, feature) in [
            (wgpu::DownlevelFlags::COMPUTE_SHADERS, "compute shaders"),
            (wgpu::DownlevelFlags::INDIRECT_EXECUTION, "indirect dispatches"),
        ] {
            if !flags.contains(flag) {
                return Err(GpuError::MissingFeature { adapter: name, feature });
            }
        }
        let limits = adapter.limits();
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("vivace"),
            required_limits: wgpu::Limits {
                max_buffer_size: limits.max_buffer_size,
                max_storage_buffer_binding_size: limits.max_storage_buffer_binding_size,
                ..wgpu::Limits::default()
            },
            ..wgpu::DeviceDescriptor::default()
        };
        let device = adapter.request_device(&descriptor).await;
        let (device, queue) =
            device.map_err(|error| GpuError::NoDevice { adapter: name, reason: error.to_string() })?;
        let gpu = Self::from_device(device, queue)?;
        let lost = gpu.lost.clone();
        gpu.device.set_device_lost_callback(move |_, reason| {
            let _ = lost.set(reason);
        });
        Ok(gpu)
    }

    /// Takes the caller's device and queue, beside whatever else the caller does with them. Faster where their instance was made
    /// without `wgpu::InstanceFlags::VALIDATION_INDIRECT_CALL`, which adds a dispatch to each indirect one. Whether the device is
    /// lost, the caller's own callback tells first; here it shows in what is read.
    ///
    /// # Errors
    /// A limit of the device is below what the kernels take.
    pub fn from_device(device: wgpu::Device, queue: wgpu::Queue) -> Result<Self, GpuError> {
        let limits = device.limits();
        for (limit, needed, found) in [
            ("max_storage_buffers_per_shader_stage", 8, limits.max_storage_buffers_per_shader_stage),
            ("max_compute_invocations_per_workgroup", 256, limits.max_compute_invocations_per_workgroup),
            ("max_compute_workgroup_size_x", 256, limits.max_compute_workgroup_size_x),
            ("max_compute_workgroups_per_dimension", 32_768, limits.max_compute_workgroups_per_dimension),
            (
                "max_dynamic_uniform_buffers_per_pipeline_layout",
                2,
                limits.max_dynamic_uniform_buffers_per_pipeline_layout,
            ),
        ] {
            if found < needed {
                return Err(GpuError::Limit { limit, needed: needed.into(), found: found.into() });
            }
        }
        let header_array = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("headers"),
            size: HEADERS_BYTES,
            usage: Purpose::Work.usage() | wgpu::BufferUsages::INDIRECT,
            mapped_at_creation: false,
        });
        Ok(Self {
            adapter: device.adapter_info(),
            pool: Arc::new(Pool::new(largest_array(&limits))),
            pipelines: Pipelines::default(),
            bind_groups: RefCell::default(),
            recorder: RefCell::new(Recorder::new(device.clone(), queue)),
            headers: Headers::new(),
            header_array,
            seen: RefCell::default(),
            n_looks: Cell::new(0),
            grids: Grids::default(),
            lost: Arc::default(),
            device,
        })
    }

    /// The same with other grids; for measuring what they cost.
    #[must_use]
    pub fn with_grids(mut self, grids: Grids) -> Self {
        self.grids = grids;
        self
    }

    /// Which adapter this is: its name, and whether it is a GPU at all.
    pub fn adapter(&self) -> &wgpu::AdapterInfo {
        &self.adapter
    }

    /// Whether a CPU plays the GPU here. Its times are no GPU's times.
    pub fn is_software(&self) -> bool {
        self.adapter.device_type == wgpu::DeviceType::Cpu
    }

    /// The device.
    pub fn device(&self) -> &wgpu::Device {
        &self.device
    }

    /// Bytes allocated on the device, in use or waiting to be used again.
    pub fn allocated(&self) -> u64 {
        FIXED_BYTES + self.pool.allocated()
    }

    /// Frees what waits to be used again.
    pub fn trim(&self) {
        self.bind_groups.borrow_mut().clear();
        self.pool.trim();
    }

    /// Dispatches recorded so far.
    pub fn n_dispatches(&self) -> u64 {
        self.recorder.borrow().n_dispatches()
    }

    /// How often the host has waited to see the lengths of lists.
    pub fn n_looks(&self) -> u64 {
        self.n_looks.get()
    }

    /// Hands over to the device what was recorded, without waiting for it.
    pub fn submit(&self) {
        self.recorder.borrow_mut().submit();
    }

    /// Hands over what was recorded, and waits until it is done.
    ///
    /// # Errors
    /// The device was lost.
    pub fn wait(&self) -> Result<(), GpuError> {
        self.submit();
        let done = self.device.poll(wgpu::PollType::wait_indefinitely());
        if done.is_err() || self.lost.get().is_some() { Err(self.lost()) } else { Ok(()) }
    }

    /// Memory for an array.
    fn work(&self, bytes: u64) -> Result<Allocation, GpuError> {
        self.allocate(Purpose::Work, bytes)
    }

    fn allocate(&self, purpose: Purpose, bytes: u64) -> Result<Allocation, GpuError> {
        self.pool.take(purpose, bytes, |size, allocated| {
            let scope = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
            let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
                label: None,
                size,
                usage: purpose.usage(),
                mapped_at_creation: false,
            });
            match pollster::block_on(scope.pop()) {
                None => Ok(buffer),
                Some(_) => Err(GpuError::OutOfMemory { bytes: size, allocated }),
            }
        })
    }

    /// A list with room for `capacity` indices, nothing in it yet.
    fn list(&self, capacity: usize) -> Result<Arc<Indices>, GpuError> {
        let memory = self.work(array_bytes::<u32>(capacity))?;
        let header = self.headers.take(self.n_looks.get())?;
        Ok(Arc::new(Indices { memory, capacity, header }))
    }

    /// The first `len` elements of a buffer, when all that was recorded is done.
    fn download<T: Element>(&self, buffer: &wgpu::Buffer, len: usize) -> Result<Vec<T>, GpuError> {
        let bytes = array_bytes::<T>(len);
        if bytes == 0 {
            return Ok(vec![T::zeroed(); len]);
        }
        let staging = self.allocate(Purpose::Staging, bytes)?;
        let mut recorder = self.recorder.borrow_mut();
        recorder.copy(buffer, &staging.buffer, bytes);
        recorder.submit();
        let (sender, receiver) = mpsc::channel();
        staging.buffer.map_async(wgpu::MapMode::Read, ..bytes, move |mapped| {
            let _ = sender.send(mapped);
        });
        let polled = self.device.poll(wgpu::PollType::wait_indefinitely());
        if polled.is_err() || !matches!(receiver.try_recv(), Ok(Ok(()))) {
            return Err(self.lost());
        }
        let mut elements = vec![T::zeroed(); len];
        let mapped = staging.buffer.get_mapped_range(..bytes).map_err(|_| self.lost())?;
        bytemuck::cast_slice_mut(&mut elements).copy_from_slice(&mapped);
        drop(mapped);
        staging.buffer.unmap();
        Ok(elements)
    }

    fn lost(&self) -> GpuError {
        let reason = self.lost.get().filter(|reason| !reason.is_empty());
        GpuError::Lost(reason.cloned().unwrap_or_else(|| "it does not answer".to_owned()))
    }

    /// Waits for what was recorded, and sees all lengths.
    fn look(&self) -> Result<(), GpuError> {
        *self.seen.borrow_mut() = self.download(&self.header_array, N_HEADERS as usize)?;
        self.n_looks.set(self.n_looks.get() + 1);
        Ok(())
    }

    /// The length of a list, if the host has looked since it was made.
    fn seen_len(&self, header: &Header) -> Option<u32> {
        (header.n_looks < self.n_looks.get()).then(|| self.seen.borrow()[header.place as usize][3])
    }

    /// The length of a list. Waits for the device if the host has not looked since the list was made.
    fn len(&self, list: &Indices) -> Result<u32, GpuError> {
        if list.capacity == 0 {
            return Ok(0);
        }
        if self.seen_len(&list.header).is_none() {
            self.look()?;
        }
        Ok(self.seen_len(&list.header).unwrap_or(0))
    }

    /// Records one dispatch that binds `groups`.
    fn dispatch(&self, pipeline: &Pipeline, groups: &[Vec<Bound<'_>>], uniforms: [&[u8]; 2], grid: Grid<'_>) {
        let groups = self.bind(pipeline, groups);
        self.recorder.borrow_mut().dispatch(pipeline, &groups, uniforms, grid);
    }

    /// Bind groups of what is bound, made once: buffers come back from the pool, so the same are asked for again and again.
    fn bind(&self, pipeline: &Pipeline, groups: &[Vec<Bound<'_>>]) -> Vec<wgpu::BindGroup> {
        let arrays = groups.iter().flatten().filter_map(|bound| match *bound {
            Bound::Array(buffer, bytes) => Some((buffer.clone(), bytes)),
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
                    },
                })
                .collect();
            let descriptor = wgpu::BindGroupDescriptor { label: None, layout, entries: &entries };
            self.device.create_bind_group(&descriptor)
        };
        pipeline.layouts.iter().zip(groups).map(bind).collect()
    }

    fn bound_headers(&self) -> Bound<'_> {
        Bound::Array(&self.header_array, HEADERS_BYTES)
    }

    /// The grid of a run over a list.
    fn grid(&self, list: &Indices) -> Grid<'_> {
        match self.grids {
            Grids::Indirect => {
                Grid::Indirect(&self.header_array, u64::from(list.header.place) * HEADER_BYTES)
            }
            Grids::Bounds => Grid::Groups(list.capacity.div_ceil(GROUP)),
        }
    }

    /// Runs a kernel over a list. `output` is the array it writes; `decisions` is where a select writes what it decides.
    fn run<K: Kernel>(
        &self,
        shader: &Shader,
        list: &Indices,
        uniform: &K::Uniform,
        inputs: Views<'_, K, GpuMemory>,
        output: Bound<'_>,
        decisions: Option<Bound<'_>>,
    ) -> Result<(), GpuError> {
        const { assert!(size_of::<K::Uniform>() <= UNIFORM_BYTES, "a uniform has 256 bytes at most") };
        let mut own = Binder { bound: Vec::with_capacity(K::Inputs::LEN + 1), failed: None };
        K::Inputs::visit(inputs, &mut own);
        if let Some(error) = own.failed {
            return Err(error);
        }
        let mut own = own.bound;
        own.push(output);
        let mut over = vec![self.bound_headers(), list.bound(), Bound::Uniform, Bound::Uniform];
        over.extend(decisions);
        let pipeline = self.pipelines.kernel::<K>(&self.device, shader);
        let groups = self.bind(&pipeline, &[over, own]);
        let dispatch = |value: u32, grid: Grid<'_>| {
            let run = Run { list: list.header.place, value, ..Run::zeroed() };
            let uniforms = [bytemuck::bytes_of(&run), bytemuck::bytes_of(uniform)];
            self.recorder.borrow_mut().dispatch(&pipeline, &groups, uniforms, grid);
        };
        if shader.form == Form::UpdateInOrder {
            (0..self.len(list)?).step_by(IN_ORDER).for_each(|first| dispatch(first, Grid::Groups(1)));
        } else {
            dispatch(0, self.grid(list));
        }
        Ok(())
    }

    /// Runs a kernel that writes an array and nothing else.
    fn write<K: Kernel, T: Element>(
        &self,
        shader: &Shader,
        list: &List,
        uniform: &K::Uniform,
        inputs: Views<'_, K, GpuMemory>,
        output: &mut Buffer<T>,
    ) {
        let written =
            list.state().and_then(|list| self.run::<K>(shader, list, uniform, inputs, output.bound()?, None));
        if let Err(error) = written {
            output.memory = Err(error);
        }
    }

    /// The lists of those kept and of those selected.
    fn try_select<K: Select>(
        &self,
        list: &List,
        uniform: &K::Uniform,
        inputs: Views<'_, K, GpuMemory>,
        output: &Buffer<K::Output>,
    ) -> Result<[Arc<Indices>; 2], GpuError> {
        let list = list.state()?;
        let bytes = decisions_bytes(list.capacity);
        let memory = self.work(bytes)?;
        let decisions = Bound::Array(&memory.buffer, bytes);
        let (kept, selected) = (self.list(list.capacity)?, self.list(list.capacity)?);
        self.run::<K>(&Shader::select::<K>(), list, uniform, inputs, output.bound()?, Some(decisions))?;
        let places = Run {
            list: list.header.place,
            kept: kept.header.place,
            selected: selected.header.place,
            value: 0,
        };
        let uniforms = [bytemuck::bytes_of(&places), &[]];
        let scan = self.pipelines.list(&self.device, ListShader::Scan);
        let groups = [vec![self.bound_headers(), decisions, Bound::Uniform]];
        self.dispatch(&scan, &groups, uniforms, Grid::Groups(1));
        let split = self.pipelines.list(&self.device, ListShader::Split);
        let groups = [
            vec![self.bound_headers(), list.bound(), Bound::Uniform],
            vec![decisions, kept.bound(), selected.bound()],
        ];
        self.dispatch(&split, &groups, uniforms, self.grid(list));
        Ok([kept, selected])
    }

    fn try_filled<T: Element>(&self, len: usize, value: T) -> Result<Allocation, GpuError> {
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
            self.dispatch(&fill, &groups, [bytemuck::bytes_of(&run), &padded], grid);
        }
        Ok(memory)
    }

    fn try_upload<T: Element>(&self, data: &[T]) -> Result<Allocation, GpuError> {
        let memory = self.work(array_bytes::<T>(data.len()))?;
        if !data.is_empty() {
            self.recorder.borrow_mut().upload(&memory.buffer, bytemuck::cast_slice(data));
        }
        Ok(memory)
    }

    fn try_all(&self, len: usize) -> Result<Arc<Indices>, GpuError> {
        let list = self.list(len)?;
        let value = words(array_bytes::<u32>(len));
        let run = Run { list: list.header.place, value, ..Run::zeroed() };
        let all = self.pipelines.list(&self.device, ListShader::All);
        let groups = [vec![self.bound_headers(), list.bound(), Bound::Uniform]];
        let grid = Grid::Groups(len.div_ceil(GROUP).max(1));
        self.dispatch(&all, &groups, [bytemuck::bytes_of(&run), &[]], grid);
        Ok(list)
    }

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

    fn all(&self, len: usize) -> List {
        List { state: self.try_all(len) }
    }

    fn indices(&self, list: &List) -> Result<Vec<u32>, GpuError> {
        let list = list.state()?;
        self.download(&list.memory.buffer, self.len(list)? as usize)
    }

    fn map<K: Map>(
        &self,
        list: &List,
        uniform: &K::Uniform,
        inputs: Views<'_, K, GpuMemory>,
        output: &mut Buffer<K::Output>,
    ) {
        self.write::<K, _>(&Shader::map::<K>(), list, uniform, inputs, output);
    }

    fn update<K: Update>(
        &self,
        list: &List,
        uniform: &K::Uniform,
        inputs: Views<'_, K, GpuMemory>,
        state: &mut Buffer<K::State>,
    ) {
        self.write::<K, _>(&Shader::update::<K>(), list, uniform, inputs, state);
    }

    /// One invocation at a time: for the few that a coloring leaves over, whose number is known since its last round.
    fn update_in_order<K: Update>(
        &self,
        list: &List,
        uniform: &K::Uniform,
        inputs: Views<'_, K, GpuMemory>,
        state: &mut Buffer<K::State>,
    ) {
        self.write::<K, _>(&Shader::update_in_order::<K>(), list, uniform, inputs, state);
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
                list.state = Ok(kept);
                List { state: Ok(selected) }
            }
            Err(error) => {
                output.memory = Err(error.clone());
                list.state = Err(error.clone());
                List { state: Err(error) }
            }
        }
    }

    fn count_down<K: CountDown>(
        &self,
        list: &List,
        uniform: &K::Uniform,
        inputs: Views<'_, K, GpuMemory>,
        counters: &mut Buffer<u32>,
    ) {
        self.write::<K, _>(&Shader::count_down::<K>(), list, uniform, inputs, counters);
    }

    /// Records a batch of rounds, submits it, and only then looks whether the list has become empty. Rounds after that do nothing:
    /// dispatches over an empty list have no groups. Each batch is as long as all before it together, so at most half of the rounds
    /// are such, and waiting for the device, some ten rounds' time, happens a few times in all. The lengths at the beginning of each
    /// round stay in the headers, so the count is that of a host that looks before every round.
    fn rounds(&self, limit: u32, list: &mut List, mut round: impl FnMut(u32, &mut List)) -> RoundCount {
        let mut count = RoundCount::default();
        let mut begun = Vec::new();
        let mut next = 0;
        while let Ok(indices) = list.state()
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

impl std::fmt::Debug for Gpu {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Gpu").field("adapter", &self.adapter.name).finish_non_exhaustive()
    }
}

/// Which lists a run is about, as in `run.wgsl`.
#[derive(Debug, Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct Run {
    list: u32,
    kept: u32,
    selected: u32,
    value: u32,
}

pub(crate) const HEADERS_BYTES: u64 = N_HEADERS as u64 * HEADER_BYTES;

/// What a device costs before it holds anything.
pub(crate) const FIXED_BYTES: u64 = HEADERS_BYTES + Recorder::UNIFORMS_SIZE as u64;

/// Bytes of the decisions of a select: nine words a group, as in `decisions.wgsl`.
pub(crate) fn decisions_bytes(capacity: usize) -> u64 {
    array_bytes::<[u32; 9]>(capacity.div_ceil(GROUP))
}

/// What is bound of an array without elements: a device takes no less than one of them.
const EMPTY_BYTES: u64 = 64;

/// What is bound to a binding.
#[derive(Clone, Copy)]
enum Bound<'a> {
    /// The first bytes of a buffer.
    Array(&'a wgpu::Buffer, u64),
    /// The uniforms, at an offset that comes with the dispatch.
    Uniform,
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

/// The most bytes of an array: what the device can bind, as long as its words have 32-bit indices, and in whole steps of the pool.
fn largest_array(limits: &wgpu::Limits) -> u64 {
    let bytes = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
    bytes.min(4 * u64::from(u32::MAX)) / 256 * 256
}

fn words(bytes: u64) -> u32 {
    u32::try_from(bytes / 4).unwrap_or_else(|_| unreachable!("no array is larger"))
}
