//! Time per kernel, as the device's own clock tells it.

use std::collections::BTreeMap;

use crate::GpuError;
use crate::recorder::N_UNIFORMS;

/// Dispatches that are timed in one submission, two queries each. There are no more, for each has a uniform at least.
const MOST_TIMED: u32 = wgpu::QUERY_SET_MAX_QUERIES / 2;
const _: () =
    assert!(N_UNIFORMS <= MOST_TIMED as usize, "a submission has more dispatches than can be timed");

/// How long each kernel took on the device.
///
/// While it is taken, each dispatch has a compute pass of its own, with a timestamp before and after it; otherwise all share one.
/// So a profile says where time goes; how long the whole takes, a clock on the host says, without a profile.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Profile {
    kernels: Vec<KernelTime>,
}

/// All dispatches of the kernels of one name.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KernelTime {
    /// The kernel's name; `fill`, `all`, `scan` and `split` are what happens between kernels.
    pub name: &'static str,
    /// Dispatches.
    pub n_dispatches: u64,
    /// Time on the device \[s\].
    pub seconds: f64,
    /// Bytes of the arrays that were bound. Each array counts once a dispatch, read or written, however often its elements are
    /// gathered; where a kernel runs over a part of the array that it writes (a color, a list, for as long as the list could be),
    /// that share of all its arrays. Headers and uniforms do not count. So these are bytes that have to move, not bytes that do.
    pub bytes: f64,
}

impl Profile {
    /// Kernels by time, the longest first.
    #[must_use]
    pub fn kernels(&self) -> &[KernelTime] {
        &self.kernels
    }

    /// Dispatches.
    #[must_use]
    pub fn n_dispatches(&self) -> u64 {
        self.kernels.iter().map(|kernel| kernel.n_dispatches).sum()
    }

    /// Time of all dispatches on the device, without what lies between them \[s\].
    #[must_use]
    pub fn seconds(&self) -> f64 {
        self.kernels.iter().map(|kernel| kernel.seconds).sum()
    }

    fn new(by_name: BTreeMap<&'static str, KernelTime>) -> Self {
        let mut kernels: Vec<KernelTime> = by_name.into_values().collect();
        kernels.sort_by(|a, b| b.seconds.total_cmp(&a.seconds));
        Self { kernels }
    }
}

impl KernelTime {
    /// Mean time of a dispatch \[s\].
    #[must_use]
    pub fn seconds_per_dispatch(&self) -> f64 {
        self.seconds / self.n_dispatches as f64
    }

    /// [`KernelTime::bytes`] over time \[bytes / s\].
    #[must_use]
    pub fn bandwidth(&self) -> f64 {
        self.bytes / self.seconds
    }
}

/// A dispatch that is timed: its kernel's name, and the bytes that count.
type Timed = (&'static str, f64);

/// Puts timestamps around dispatches.
pub(crate) struct Profiler {
    device: wgpu::Device,
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    /// What was recorded since the last submission.
    recorded: Vec<Timed>,
    /// Timestamps of earlier submissions, on their way.
    submitted: Vec<(wgpu::Buffer, Vec<Timed>)>,
}

impl Profiler {
    pub(crate) fn new(device: wgpu::Device) -> Self {
        let queries = device.create_query_set(&wgpu::QuerySetDescriptor {
            label: Some("timestamps"),
            ty: wgpu::QueryType::Timestamp,
            count: 2 * MOST_TIMED,
        });
        let resolved = timestamps(&device, wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC);
        Self { device, queries, resolved, recorded: Vec::new(), submitted: Vec::new() }
    }

    fn n_recorded(&self) -> u32 {
        u32::try_from(self.recorded.len()).unwrap_or(MOST_TIMED)
    }

    /// The timestamps of a pass that holds one dispatch.
    pub(crate) fn time(&mut self, name: &'static str, bytes: f64) -> wgpu::ComputePassTimestampWrites<'_> {
        let first = 2 * self.n_recorded();
        self.recorded.push((name, bytes));
        wgpu::ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(first),
            end_of_pass_write_index: Some(first + 1),
        }
    }

    /// Records, at the end of a submission, that its timestamps are to be seen.
    pub(crate) fn resolve(&mut self, encoder: &mut wgpu::CommandEncoder) {
        if self.recorded.is_empty() {
            return;
        }
        let (n, recorded) = (2 * self.n_recorded(), std::mem::take(&mut self.recorded));
        let seen = timestamps(&self.device, wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST);
        encoder.resolve_query_set(&self.queries, 0..n, &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, &seen, 0, u64::from(n) * 8);
        self.submitted.push((seen, recorded));
    }

    /// What was timed, in ticks of so many seconds. Waits for the device. `None` if it was lost.
    pub(crate) fn finish(self, tick: f64) -> Option<Profile> {
        for (seen, _) in &self.submitted {
            seen.map_async(wgpu::MapMode::Read, .., |_| ());
        }
        self.device.poll(wgpu::PollType::wait_indefinitely()).ok()?;
        let mut by_name = BTreeMap::new();
        for (seen, timed) in &self.submitted {
            let mapped = seen.get_mapped_range(..).ok()?;
            let (ticks, _) = bytemuck::cast_slice::<u8, u64>(&mapped).as_chunks::<2>();
            for (&(name, bytes), &[begin, end]) in timed.iter().zip(ticks) {
                let none = KernelTime { name, n_dispatches: 0, seconds: 0.0, bytes: 0.0 };
                let kernel = by_name.entry(name).or_insert(none);
                kernel.n_dispatches += 1;
                kernel.seconds += end.saturating_sub(begin) as f64 * tick;
                kernel.bytes += bytes;
            }
        }
        Some(Profile::new(by_name))
    }
}

fn timestamps(device: &wgpu::Device, usage: wgpu::BufferUsages) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("timestamps"),
        size: 2 * u64::from(MOST_TIMED) * 8,
        usage,
        mapped_at_creation: false,
    })
}

impl crate::Gpu {
    /// Whether this device has a clock for [`crate::Gpu::profile`].
    #[must_use]
    pub fn has_timestamps(&self) -> bool {
        self.device().features().contains(wgpu::Features::TIMESTAMP_QUERY)
    }

    /// Times every dispatch from here to [`crate::Gpu::end_profile`]. What is computed is what is computed without a profile. One that
    /// has begun and not ended is dropped.
    ///
    /// # Errors
    /// The device has no timestamp queries.
    pub fn begin_profile(&self) -> Result<(), GpuError> {
        if !self.has_timestamps() {
            return Err(GpuError::NoTimestamps { adapter: self.adapter().name.clone() });
        }
        let profiler = Profiler::new(self.device().clone());
        self.recorder.borrow_mut().replace_profiler(Some(profiler));
        Ok(())
    }

    /// How long each kernel took since [`crate::Gpu::begin_profile`]; nothing if there was none. Waits for the device.
    ///
    /// # Errors
    /// The device was lost.
    pub fn end_profile(&self) -> Result<Profile, GpuError> {
        let profiler = self.recorder.borrow_mut().replace_profiler(None);
        self.wait()?;
        let Some(profiler) = profiler else { return Ok(Profile::default()) };
        let tick = f64::from(self.queue().get_timestamp_period()) * 1e-9;
        profiler.finish(tick).ok_or_else(|| self.lost())
    }

    /// Does `work`, and says how long each kernel in it took.
    ///
    /// # Errors
    /// The device has no timestamp queries (nothing is done then), or was lost.
    pub fn profile<R>(&self, work: impl FnOnce(&Self) -> R) -> Result<(R, Profile), GpuError> {
        self.begin_profile()?;
        let result = work(self);
        Ok((result, self.end_profile()?))
    }
}
