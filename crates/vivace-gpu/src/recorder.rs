//! Records dispatches: all of them in one compute pass, until a copy or the host needs the pass to end.

use crate::pipeline::{Pipeline, UNIFORM_BYTES};
use crate::profile::Profiler;

/// Uniforms of one submission, of which each dispatch takes one or two; when they are used up, what was recorded is submitted.
pub(crate) const N_UNIFORMS: usize = 2048;

/// Groups in a row of the grid, as in `run.wgsl`.
const ROW: u32 = 32_768;

/// Invocations in a group, as in `run.wgsl`.
pub(crate) const GROUP: usize = 256;

/// How large a dispatch is.
pub(crate) enum Grid<'a> {
    /// So many groups.
    Groups(usize),
    /// What the device has written at this offset.
    Indirect(&'a wgpu::Buffer, u64),
}

/// The parameters at a binding of uniforms.
#[derive(Clone, Copy)]
pub(crate) enum Uniform<'a> {
    /// From the host.
    Bytes(&'a [u8]),
    /// Where the device has made them: at this offset of the array that is bound.
    At(u32),
}

impl Uniform<'_> {
    pub(crate) const NONE: Self = Self::Bytes(&[]);
}

/// How an array of uniforms is bound.
pub(crate) fn uniform_binding(buffer: &wgpu::Buffer) -> wgpu::BindingResource<'_> {
    let size = wgpu::BufferSize::new(UNIFORM_BYTES as u64);
    wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer, offset: 0, size })
}

pub(crate) struct Recorder {
    device: wgpu::Device,
    queue: wgpu::Queue,
    /// The uniforms on the device: one array, which each submission writes anew before it runs.
    uniforms: wgpu::Buffer,
    written: Vec<u8>,
    // The pass goes before the encoder it records into.
    pass: Option<wgpu::ComputePass<'static>>,
    encoder: Option<wgpu::CommandEncoder>,
    n_dispatches: u64,
    /// Times dispatches, if it is there: each has a pass of its own then.
    profiler: Option<Profiler>,
}

impl Recorder {
    /// Bytes of the uniforms on the device.
    pub(crate) const UNIFORMS_SIZE: usize = N_UNIFORMS * UNIFORM_BYTES;

    pub(crate) fn new(device: wgpu::Device, queue: wgpu::Queue) -> Self {
        let uniforms = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("uniforms"),
            size: Self::UNIFORMS_SIZE as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        Self {
            device,
            queue,
            uniforms,
            written: Vec::new(),
            pass: None,
            encoder: None,
            n_dispatches: 0,
            profiler: None,
        }
    }

    /// Where uniforms are bound from.
    pub(crate) fn uniform_binding(&self) -> wgpu::BindingResource<'_> {
        uniform_binding(&self.uniforms)
    }

    /// Records one dispatch. `uniforms` are those of group 0 in binding order; `bytes` is what it counts for in a profile.
    pub(crate) fn dispatch(
        &mut self,
        pipeline: &Pipeline,
        groups: &[wgpu::BindGroup],
        uniforms: [Uniform<'_>; 2],
        grid: Grid<'_>,
        bytes: f64,
    ) {
        if self.written.len() + 2 * UNIFORM_BYTES > Self::UNIFORMS_SIZE {
            self.submit();
        }
        let offsets = uniforms.map(|uniform| match uniform {
            Uniform::Bytes(bytes) => self.write(bytes),
            Uniform::At(offset) => offset,
        });
        let pass = self.pass(pipeline.name, bytes);
        pass.set_pipeline(&pipeline.pipeline);
        for (place, group) in (0..).zip(groups) {
            let n_uniforms = if place == 0 { pipeline.n_uniforms } else { 0 };
            pass.set_bind_group(place, group, &offsets[..n_uniforms]);
        }
        match grid {
            Grid::Groups(n) => {
                let n = u32::try_from(n).unwrap_or_else(|_| unreachable!("elements have 32-bit indices"));
                pass.dispatch_workgroups(n.min(ROW), n.div_ceil(ROW), 1);
            }
            Grid::Indirect(buffer, offset) => pass.dispatch_workgroups_indirect(buffer, offset),
        }
        self.n_dispatches += 1;
    }

    /// Copies the first `bytes` after all that was recorded before, which is handed over with it.
    pub(crate) fn copy_out(
        &mut self,
        from: &wgpu::Buffer,
        to: &wgpu::Buffer,
        bytes: u64,
    ) -> wgpu::SubmissionIndex {
        self.pass = None;
        let mut encoder = self.encoder.take().unwrap_or_else(|| self.new_encoder());
        encoder.copy_buffer_to_buffer(from, 0, to, 0, bytes);
        self.submit_encoder(encoder)
    }

    /// Writes to a buffer, after all that was recorded before.
    pub(crate) fn upload(&mut self, buffer: &wgpu::Buffer, bytes: &[u8]) {
        self.submit();
        self.queue.write_buffer(buffer, 0, bytes);
    }

    /// Hands over what was recorded.
    pub(crate) fn submit(&mut self) {
        self.pass = None;
        if let Some(encoder) = self.encoder.take() {
            self.submit_encoder(encoder);
        }
    }

    fn submit_encoder(&mut self, mut encoder: wgpu::CommandEncoder) -> wgpu::SubmissionIndex {
        if let Some(profiler) = &mut self.profiler {
            profiler.resolve(&mut encoder);
        }
        if !self.written.is_empty() {
            self.queue.write_buffer(&self.uniforms, 0, &self.written);
            self.written.clear();
        }
        self.queue.submit([encoder.finish()])
    }

    /// From now on dispatches are timed by this one. What was recorded so far is handed over, and the last profiler back.
    pub(crate) fn replace_profiler(&mut self, profiler: Option<Profiler>) -> Option<Profiler> {
        self.submit();
        std::mem::replace(&mut self.profiler, profiler)
    }

    /// The queue.
    pub(crate) fn queue(&self) -> &wgpu::Queue {
        &self.queue
    }

    /// Dispatches recorded so far.
    pub(crate) fn n_dispatches(&self) -> u64 {
        self.n_dispatches
    }

    fn write(&mut self, uniform: &[u8]) -> u32 {
        let offset = self.written.len();
        if uniform.is_empty() {
            return 0;
        }
        self.written.extend_from_slice(uniform);
        self.written.resize(offset + UNIFORM_BYTES, 0);
        u32::try_from(offset).unwrap_or_else(|_| unreachable!("below {}", Self::UNIFORMS_SIZE))
    }

    fn new_encoder(&self) -> wgpu::CommandEncoder {
        self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("vivace") })
    }

    /// The pass that a dispatch goes to: the one that all share, or one with timestamps.
    fn pass(&mut self, name: &'static str, bytes: f64) -> &mut wgpu::ComputePass<'static> {
        if self.pass.is_none() || self.profiler.is_some() {
            self.pass = None;
            let mut encoder = self.encoder.take().unwrap_or_else(|| self.new_encoder());
            let timestamp_writes = self.profiler.as_mut().map(|profiler| profiler.time(name, bytes));
            let descriptor = wgpu::ComputePassDescriptor { label: Some("vivace"), timestamp_writes };
            self.pass = Some(encoder.begin_compute_pass(&descriptor).forget_lifetime());
            self.encoder = Some(encoder);
        }
        self.pass.as_mut().unwrap_or_else(|| unreachable!("set above"))
    }
}
