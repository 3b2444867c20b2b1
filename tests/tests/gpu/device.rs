//! Memory, limits, and what is told when something is missing.

use std::process::Command;

use vivace_coloring::{Algorithm, ColorOnError, Vivace};
use vivace_gpu::{Buffer, Footprint, Gpu, GpuError, List, wgpu};
use vivace_kernels::coloring::{DegreeWeight, IsColored, SetValue, SetValueUniform};
use vivace_kernels::{Backend, RoundCount};
use vivace_tests::generators::{isolated, random, star, tets};

use crate::gpu;

const PAPER: Algorithm = Algorithm::Vivace(Vivace::DEFAULT);

/// A device of the caller's, with the given limits.
pub(crate) fn device(limits: wgpu::Limits) -> (wgpu::Device, wgpu::Queue) {
    pollster::block_on(async {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
        let adapter = instance.request_adapter(&wgpu::RequestAdapterOptions::default()).await;
        let adapter = adapter.expect("an adapter");
        let descriptor = wgpu::DeviceDescriptor { required_limits: limits, ..Default::default() };
        adapter.request_device(&descriptor).await.expect("a device with these limits")
    })
}

#[test]
fn memory_is_known_before_it_is_taken() {
    let graphs = [isolated(0), isolated(1), star(3000), random(5000, 40_000, 1), tets(20_000, 2)];
    for (graph, algorithm) in graphs
        .iter()
        .flat_map(|graph| Algorithm::ALL.into_iter().map(move |algorithm| (graph, algorithm)))
        .filter(|(_, algorithm)| algorithm.is_seeded())
    {
        let (n, m) = (graph.n_vertices(), graph.n_edges());
        let expected = Footprint::of(|device| algorithm.rehearse(device, n, m));
        let gpu = gpu();
        algorithm.color_on(&gpu, graph).unwrap();
        assert_eq!(gpu.allocated(), expected, "{algorithm}, {n} vertices, {m} edges");
        algorithm.color_on(&gpu, graph).unwrap();
        assert_eq!(gpu.allocated(), expected, "the second time nothing is allocated");
        gpu.trim();
        assert_eq!(gpu.allocated(), Footprint::of(|_| ()));
    }
}

#[test]
fn the_callers_device_does() {
    let graph = tets(3000, 1);
    let (device, queue) = device(wgpu::Limits::default());
    let gpu = Gpu::from_device(device, queue).unwrap();
    assert_eq!(PAPER.color_on(&gpu, &graph).unwrap(), PAPER.color(&graph));
    assert_eq!(gpu.is_software(), gpu.adapter().device_type == wgpu::DeviceType::Cpu);
}

/// A device may move to another thread, and arrays may be shared.
#[test]
fn threads_may_own_devices() {
    fn send<T: Send>() {}
    fn sync<T: Sync>() {}
    send::<Gpu>();
    send::<List>();
    sync::<Buffer<u32>>();
}

#[test]
fn a_limit_too_low_is_told() {
    let limits = wgpu::Limits { max_storage_buffers_per_shader_stage: 4, ..wgpu::Limits::default() };
    let (device, queue) = device(limits);
    let error = Gpu::from_device(device, queue).unwrap_err();
    let limit = "max_storage_buffers_per_shader_stage";
    assert_eq!(error, GpuError::Limit { limit, needed: 8, found: 4 });
}

#[test]
fn an_array_too_large_is_refused_with_its_size_and_the_next_fits() {
    let limits = wgpu::Limits { max_storage_buffer_binding_size: 1 << 16, ..wgpu::Limits::default() };
    let (device, queue) = device(limits);
    let gpu = Gpu::from_device(device, queue).unwrap();
    for algorithm in Algorithm::ALL.into_iter().filter(Algorithm::is_seeded) {
        let error = algorithm.color_on(&gpu, &isolated(20_000)).unwrap_err();
        let expected = GpuError::TooLarge { bytes: 80_000, limit: 1 << 16 };
        assert_eq!(error, ColorOnError::Backend(expected), "{algorithm}");
        assert!(error.to_string().contains("80000") && error.to_string().contains("65536"), "{error}");
    }
    assert_eq!(PAPER.color_on(&gpu, &star(100)).unwrap(), PAPER.color(&star(100)));
}

/// What is computed from what is missing is missing for the same reason.
#[test]
fn failures_pass_on() {
    let limits = wgpu::Limits { max_storage_buffer_binding_size: 1 << 16, ..wgpu::Limits::default() };
    let (device, queue) = device(limits);
    let gpu = Gpu::from_device(device, queue).unwrap();
    let (too_long, too_large) = (gpu.all(20_000), gpu.filled(20_000, 0_u32));
    let all = || gpu.all(100);
    let (mut by_list, mut by_input) = (gpu.filled(100, 0_u32), gpu.filled(100, 0_u32));
    gpu.map::<SetValue>(&too_long, &SetValueUniform { value: 1 }, (), &mut by_list);
    gpu.map::<DegreeWeight>(&all(), &(), (gpu.view(&too_large),), &mut by_input);
    let (mut by_select, mut list) = (gpu.filled(20_000, 0_u32), all());
    let selected = gpu.select::<IsColored>(&mut list, &(), (), &mut by_select);
    let (mut by_long_list, mut long_list) = (gpu.filled(100, 0_u32), gpu.all(20_000));
    let of_long_list = gpu.select::<IsColored>(&mut long_list, &(), (), &mut by_long_list);
    let mut left = gpu.all(20_000);
    assert_eq!(gpu.rounds(5, &mut left, |_, _| {}), RoundCount::default());
    let expected = Some(GpuError::TooLarge { bytes: 80_000, limit: 1 << 16 });
    for array in [by_list, by_input, by_select, by_long_list, too_large] {
        assert_eq!(gpu.read(array).err(), expected);
    }
    for list in [list, selected, long_list, of_long_list, left, too_long] {
        assert_eq!(gpu.indices(&list).err(), expected);
    }
    assert!(gpu.indices(&all()).is_ok());
}

#[test]
fn a_lost_device_is_told() {
    let gpu = gpu();
    let before = gpu.filled(100, 7_u32);
    assert!(PAPER.color_on(&gpu, &star(100)).is_ok());
    gpu.device().destroy();
    assert!(matches!(gpu.wait(), Err(GpuError::Lost(_))));
    assert!(matches!(gpu.read(before), Err(GpuError::Lost(_))));
    for algorithm in Algorithm::ALL.into_iter().filter(Algorithm::is_seeded) {
        let error = algorithm.color_on(&gpu, &star(100)).unwrap_err();
        assert!(matches!(error, ColorOnError::Backend(GpuError::Lost(_))), "{algorithm}: {error}");
    }
}

/// Whatever is asked of a lost device: new sizes, new kernels, arrays that it had.
#[test]
fn a_lost_device_does_not_panic() {
    let callers = || {
        let (device, queue) = device(wgpu::Limits::default());
        Gpu::from_device(device, queue).unwrap()
    };
    for gpu in [gpu(), callers()] {
        let before = gpu.upload(&[7_u32; 100]);
        gpu.device().destroy();
        for n in [10, 100, 10_000] {
            for algorithm in Algorithm::ALL.into_iter().filter(Algorithm::is_seeded) {
                let error = algorithm.color_on(&gpu, &star(n)).unwrap_err();
                assert!(matches!(error, ColorOnError::Backend(GpuError::Lost(_))), "{algorithm}: {error}");
            }
        }
        assert!(matches!(gpu.read(before), Err(GpuError::Lost(_))));
    }
}

#[test]
fn lists_without_end_are_refused() {
    let gpu = gpu();
    let lists: Vec<_> = (0..1025).map(|_| gpu.all(10)).collect();
    assert_eq!(gpu.indices(&lists[1024]).unwrap_err(), GpuError::TooManyLists(1024));
    assert_eq!(gpu.indices(&lists[1023]).unwrap(), (0..10).collect::<Vec<u32>>());
    drop(lists);
    assert!(gpu.indices(&gpu.all(10)).is_ok());
}

#[test]
#[ignore = "run by the next test, where no driver can be found"]
fn open_an_adapter() {
    assert_eq!(Gpu::new().unwrap_err(), GpuError::NoAdapter);
}

#[test]
fn a_missing_adapter_is_told() {
    let mut child = Command::new(std::env::current_exe().unwrap());
    child.args(["--exact", "device::open_an_adapter", "--ignored"]).env("WGPU_BACKEND", "none");
    assert!(child.output().unwrap().status.success());
    assert!(GpuError::NoAdapter.to_string().contains("mesa-vulkan-drivers"));
}
