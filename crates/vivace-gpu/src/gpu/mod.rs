//! The device: opening it, its memory, and what the host sees of it.

mod backend;
mod run;

use std::cell::{Cell, RefCell};
use std::collections::HashMap;
use std::sync::{Arc, OnceLock};

use vivace_kernels::Element;

use crate::list::{HEADER_BYTES, Header, HeaderWords, Headers, Indices, N_HEADERS};
use crate::memory::{Allocation, Buffer, Pool, Purpose, array_bytes};
use crate::pipeline::Pipelines;
use crate::recorder::{GROUP, Recorder};
use crate::{GpuError, ReadBack};

/// Bind groups that are kept; more mean that array lengths have changed over and over.
const MOST_BIND_GROUPS: usize = 1024;

/// A pipeline, and the arrays bound to it with the bytes of each.
type BindGroupKey = (wgpu::ComputePipeline, Vec<(wgpu::Buffer, u64)>);

/// A GPU as a [`vivace_kernels::Backend`].
///
/// It records commands in the order of its calls, so it stays on one thread at a time; make another for another thread.
pub struct Gpu {
    device: wgpu::Device,
    adapter: wgpu::AdapterInfo,
    pool: Arc<Pool<wgpu::Buffer>>,
    pipelines: Pipelines,
    bind_groups: RefCell<HashMap<BindGroupKey, Vec<wgpu::BindGroup>>>,
    pub(crate) recorder: RefCell<Recorder>,
    /// The places of headers, and the headers.
    headers: Arc<Headers>,
    header_array: wgpu::Buffer,
    /// All headers as the host last saw them, and how often it has looked.
    seen: RefCell<Vec<HeaderWords>>,
    n_looks: Cell<u64>,
    grids: Grids,
    lost: Arc<OnceLock<String>>,
}

/// Who says how large a dispatch over a list is. `cargo xtask bench-gpu` compares the two: over an empty list an indirect dispatch costs
/// next to nothing, one by bounds what its room costs; over full lists there is no difference on a software adapter.
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
            // Without wgpu's own checks of indirect dispatches, each of which is a dispatch more: the grids here come from `header` in run.wgsl, which stays inside the limits.
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
            // For a profile; nothing else needs it.
            required_features: adapter.features() & wgpu::Features::TIMESTAMP_QUERY,
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

    /// The queue, for pipelines of the caller's that read the arrays here, see [`Buffer::raw`].
    pub fn queue(&self) -> wgpu::Queue {
        self.recorder.borrow().queue().clone()
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
            let memory = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
            let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
                label: None,
                size,
                usage: purpose.usage(),
                mapped_at_creation: false,
            });
            if pollster::block_on(memory.pop()).is_some() {
                return Err(GpuError::OutOfMemory { bytes: size, allocated });
            }
            if self.is_usable(&buffer) { Ok(buffer) } else { Err(self.lost()) }
        })
    }

    /// A lost device makes buffers without complaint, and panics when they are used: so each is written to once, no bytes.
    fn is_usable(&self, buffer: &wgpu::Buffer) -> bool {
        let use_of_it = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        self.recorder.borrow().queue().write_buffer(buffer, 0, &[]);
        pollster::block_on(use_of_it.pop()).is_none()
    }

    /// A list with room for `capacity` indices, nothing in it yet.
    fn list(&self, capacity: usize) -> Result<Arc<Indices>, GpuError> {
        let memory = Arc::new(self.work(array_bytes::<u32>(capacity))?);
        self.list_in(&memory, capacity)
    }

    /// A list in memory that it may share.
    fn list_in(&self, memory: &Arc<Allocation>, capacity: usize) -> Result<Arc<Indices>, GpuError> {
        let header = self.headers.take(self.n_looks.get())?;
        Ok(Arc::new(Indices { memory: memory.clone(), capacity, header }))
    }

    /// Begins to copy an array to the host, as it is after all that was recorded so far, which is handed over to the device. The
    /// host does not wait: it goes on, and asks the copy later.
    ///
    /// # Errors
    /// Why there is no such array, or no memory for its copy.
    pub fn read_back<T: Element>(&self, array: &Buffer<T>) -> Result<ReadBack<T>, GpuError> {
        self.copy_back(array.raw()?, array.len)
    }

    /// A copy of the first `len` elements of a buffer.
    fn copy_back<T: Element>(&self, buffer: &wgpu::Buffer, len: usize) -> Result<ReadBack<T>, GpuError> {
        let bytes = array_bytes::<T>(len);
        let copy = if bytes == 0 {
            None
        } else {
            let staging = self.allocate(Purpose::Staging, bytes)?;
            let submission = self.recorder.borrow_mut().copy_out(buffer, &staging.buffer, bytes);
            Some((staging, submission))
        };
        Ok(ReadBack::new(self.device.clone(), self.lost.clone(), len, copy))
    }

    /// The first `len` elements of a buffer, when all that was recorded is done.
    fn download<T: Element>(&self, buffer: &wgpu::Buffer, len: usize) -> Result<Vec<T>, GpuError> {
        self.copy_back(buffer, len)?.wait()
    }

    /// The first elements of a buffer, when all that was recorded is done.
    fn download_to<T: Element>(&self, buffer: &wgpu::Buffer, elements: &mut [T]) -> Result<(), GpuError> {
        self.copy_back(buffer, elements.len())?.wait_in(elements)
    }

    pub(crate) fn lost(&self) -> GpuError {
        GpuError::lost(&self.lost)
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

    /// Where a list begins in its memory, and its length.
    fn extent(&self, list: &Indices) -> Result<[u32; 2], GpuError> {
        let len = self.len(list)?;
        let first = if len == 0 { 0 } else { self.seen.borrow()[list.header.place as usize][4] };
        Ok([first, len])
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
}

impl std::fmt::Debug for Gpu {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Gpu").field("adapter", &self.adapter.name).finish_non_exhaustive()
    }
}

pub(crate) const HEADERS_BYTES: u64 = N_HEADERS as u64 * HEADER_BYTES;

/// What a device costs before it holds anything.
pub(crate) const FIXED_BYTES: u64 = HEADERS_BYTES + Recorder::UNIFORMS_SIZE as u64;

/// Bytes of the decisions of a select: nine words a group, as in `decisions.wgsl`.
pub(crate) fn decisions_bytes(capacity: usize) -> u64 {
    array_bytes::<[u32; 9]>(capacity.div_ceil(GROUP))
}

/// Bytes of where the items of an expansion go: 258 words a group, as in `places.wgsl`.
pub(crate) fn places_bytes(capacity: usize) -> u64 {
    array_bytes::<[u32; GROUP + 2]>(capacity.div_ceil(GROUP))
}

/// Bytes of the counts of a sort: one for each group and key.
pub(crate) fn counts_bytes(n: usize, n_keys: u32) -> u64 {
    array_bytes::<u32>(n.div_ceil(GROUP) * n_keys as usize)
}

/// The most bytes of an array: what the device can bind, as long as its words have 32-bit indices, and in whole steps of the pool.
fn largest_array(limits: &wgpu::Limits) -> u64 {
    let bytes = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
    bytes.min(4 * u64::from(u32::MAX)) / 256 * 256
}
