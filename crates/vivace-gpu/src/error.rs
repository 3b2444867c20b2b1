//! What can go wrong with a device.

use std::sync::OnceLock;

/// Why a device could not be had, or did not do what it was asked to.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum GpuError {
    /// No driver answers.
    #[error(
        "no GPU adapter: install the graphics driver of this machine (on Linux with the Vulkan loader, libvulkan1), or Mesa's \
         software driver (package mesa-vulkan-drivers; vulkan-swrast on Arch, mesa-vulkan-swrast on Alpine)"
    )]
    NoAdapter,
    /// The adapter lacks what WebGPU promises.
    #[error(
        "{adapter} has no {feature}: take an adapter with Vulkan, Metal or DirectX 12, or update its driver"
    )]
    MissingFeature {
        /// Name of the adapter.
        adapter: String,
        /// What it lacks.
        feature: &'static str,
    },
    /// The device was made with a limit below what the kernels take, which is below WebGPU's default.
    #[error(
        "the device allows {limit} = {found}, and {needed} is needed: request it with wgpu::Limits::default()"
    )]
    Limit {
        /// The field of `wgpu::Limits`.
        limit: &'static str,
        /// The least that will do.
        needed: u64,
        /// What the device has.
        found: u64,
    },
    /// The adapter gave no device.
    #[error("{adapter} gives no device: {reason}")]
    NoDevice {
        /// Name of the adapter.
        adapter: String,
        /// What it says.
        reason: String,
    },
    /// The device has no clock that kernels could be timed by.
    #[error(
        "{adapter} times no kernels: there are no timestamp queries; take an adapter that has them (wgpu::Features::TIMESTAMP_QUERY), \
         and request them with a device of your own"
    )]
    NoTimestamps {
        /// Name of the adapter.
        adapter: String,
    },
    /// An array larger than the device can bind.
    #[error("an array of {bytes} bytes: this device binds no more than {limit}")]
    TooLarge {
        /// Size of the array.
        bytes: u64,
        /// What the device can bind.
        limit: u64,
    },
    /// No memory left.
    #[error("the device has no memory left for {bytes} bytes more; {allocated} are in use here")]
    OutOfMemory {
        /// Size of the array.
        bytes: u64,
        /// Bytes allocated before.
        allocated: u64,
    },
    /// More lists at the same time than there is room for.
    #[error("more than {0} lists at the same time")]
    TooManyLists(u32),
    /// The device is gone, and all that it held.
    #[error("the device was lost ({0}): make a new one and begin again")]
    Lost(String),
}

impl GpuError {
    /// The device is gone, for this reason if it gave one.
    pub(crate) fn lost(reason: &OnceLock<String>) -> Self {
        let reason = reason.get().filter(|reason| !reason.is_empty());
        Self::Lost(reason.cloned().unwrap_or_else(|| "it does not answer".to_owned()))
    }
}
