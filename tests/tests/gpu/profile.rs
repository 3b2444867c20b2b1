//! Time per kernel. The numbers are anybody's; what is counted is not.

use vivace_coloring::{Algorithm, Vivace};
use vivace_gpu::{Gpu, GpuError, KernelTime, wgpu};
use vivace_kernels::Backend;
use vivace_kernels::coloring::{SetValue, SetValueUniform};
use vivace_tests::generators::tets;

use crate::device::device;
use crate::gpu;

/// A device that has timestamps, as every adapter has that these tests run on.
fn timed() -> Gpu {
    let gpu = gpu();
    assert!(gpu.has_timestamps(), "{} has no timestamp queries", gpu.adapter().name);
    gpu
}

#[test]
fn every_dispatch_is_timed_under_its_kernels_name() {
    let gpu = timed();
    let n_before = gpu.n_dispatches();
    let (array, profile) = gpu
        .profile(|gpu| {
            let mut array = gpu.filled(1000, 0_u32);
            let all = gpu.all(1000);
            (0..5).for_each(|value| gpu.map::<SetValue>(&all, &SetValueUniform { value }, (), &mut array));
            array
        })
        .unwrap();
    assert_eq!(gpu.read(array).unwrap(), vec![4; 1000]);
    assert_eq!(profile.n_dispatches(), gpu.n_dispatches() - n_before);
    let of = |name: &str| -> KernelTime {
        *profile.kernels().iter().find(|kernel| kernel.name == name).expect("a kernel of this name")
    };
    assert_eq!([of("fill"), of("all"), of("set_value")].map(|kernel| kernel.n_dispatches), [1, 1, 5]);
    // The list's indices and the array, 4 bytes each: five times.
    assert_eq!([of("fill"), of("all"), of("set_value")].map(|kernel| kernel.bytes), [4e3, 4e3, 5.0 * 8e3]);
    assert!(profile.kernels().is_sorted_by(|a, b| a.seconds >= b.seconds));
    assert!(profile.kernels().iter().all(|kernel| kernel.seconds >= 0.0 && kernel.seconds < 60.0));
    assert!(profile.seconds() > 0.0);
}

/// A color is a part of the array that is written.
#[test]
fn a_part_counts_as_a_part() {
    let gpu = timed();
    let mut array = gpu.filled(1000, 0_u32);
    let part = gpu.all(250);
    let uniform = SetValueUniform { value: 1 };
    let ((), profile) = gpu.profile(|gpu| gpu.map::<SetValue>(&part, &uniform, (), &mut array)).unwrap();
    assert_eq!(profile.kernels()[0].bytes, 1e3 + 1e3);
}

/// More dispatches than one submission times.
#[test]
fn long_profiles_lose_nothing() {
    let gpu = timed();
    let mut array = gpu.filled(10, 0_u32);
    let all = gpu.all(10);
    let set = |gpu: &Gpu| {
        (0..5000).for_each(|value| gpu.map::<SetValue>(&all, &SetValueUniform { value }, (), &mut array));
    };
    let ((), profile) = gpu.profile(set).unwrap();
    assert_eq!(profile.n_dispatches(), 5000);
}

/// Passes are split, and nothing else is different: rounds that wait for the device, lists, colors.
#[test]
fn a_profile_changes_no_coloring() {
    let (gpu, graph) = (timed(), tets(5000, 3));
    for algorithm in Algorithm::ALL.into_iter().filter(Algorithm::is_seeded) {
        let (outcome, profile) = gpu.profile(|gpu| algorithm.color_on(gpu, &graph)).unwrap();
        assert_eq!(outcome.unwrap(), algorithm.color(&graph), "{algorithm}");
        assert!(profile.n_dispatches() > 10, "{algorithm}");
        let n_before = gpu.n_dispatches();
        let outcome = algorithm.color_on(&gpu, &graph).unwrap();
        assert_eq!(outcome, algorithm.color(&graph), "{algorithm}, afterwards");
        assert_eq!(gpu.n_dispatches() - n_before, profile.n_dispatches(), "{algorithm}");
    }
}

/// One that begins anew forgets what was before, and one that has not begun is empty.
#[test]
fn a_profile_lasts_from_its_beginning_to_its_end() {
    let gpu = timed();
    let mut array = gpu.filled(10, 0_u32);
    let all = gpu.all(10);
    let mut set = |value| gpu.map::<SetValue>(&all, &SetValueUniform { value }, (), &mut array);
    set(1);
    assert_eq!(gpu.end_profile().unwrap().n_dispatches(), 0);
    gpu.begin_profile().unwrap();
    set(2);
    gpu.begin_profile().unwrap();
    (3..6).for_each(&mut set);
    assert_eq!(gpu.end_profile().unwrap().n_dispatches(), 3);
    set(6);
    assert_eq!(gpu.end_profile().unwrap().n_dispatches(), 0);
}

#[test]
fn without_a_clock_nothing_is_done_and_told_why() {
    let (device, queue) = device(wgpu::Limits::default());
    let gpu = Gpu::from_device(device, queue).unwrap();
    assert!(!gpu.has_timestamps());
    let error = gpu.profile(|_| unreachable!("not to be done")).unwrap_err();
    assert_eq!(error, GpuError::NoTimestamps { adapter: gpu.adapter().name.clone() });
    assert!(error.to_string().contains("TIMESTAMP_QUERY"), "{error}");
    assert!(Algorithm::Vivace(Vivace::DEFAULT).color_on(&gpu, &tets(100, 1)).is_ok());
}

#[test]
fn a_lost_device_has_no_profile() {
    let gpu = timed();
    gpu.device().destroy();
    assert!(matches!(gpu.profile(|gpu| gpu.filled(10, 0_u32)), Err(GpuError::Lost(_))));
}
