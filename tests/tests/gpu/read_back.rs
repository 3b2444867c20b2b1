//! Copies on their way to the host, and arrays in the hands of the caller's pipelines.

use vivace_gpu::{Buffer, Gpu, GpuError, wgpu};
use vivace_kernels::Backend;
use vivace_kernels::coloring::{SetValue, SetValueUniform};

use crate::gpu;

fn set(gpu: &Gpu, array: &mut Buffer<u32>, value: u32) {
    let all = gpu.all(array.len());
    gpu.map::<SetValue>(&all, &SetValueUniform { value }, (), array);
}

#[test]
fn each_copy_holds_what_its_array_held() {
    let gpu = gpu();
    let mut array = gpu.filled(1000, 0_u32);
    let mut copies = Vec::new();
    for value in 1..=4 {
        set(&gpu, &mut array, value);
        copies.push((value, gpu.read_back(&array).unwrap()));
    }
    set(&gpu, &mut array, 5);
    for (value, copy) in copies.into_iter().rev() {
        assert_eq!(copy.len(), 1000);
        assert_eq!(copy.wait().unwrap(), vec![value; 1000]);
    }
    assert_eq!(gpu.read(array).unwrap(), vec![5; 1000]);
}

#[test]
fn a_copy_that_is_asked_for_again_and_again_arrives() {
    let gpu = gpu();
    let mut array = gpu.filled(1 << 20, 0_u32);
    let all = gpu.all(array.len());
    (0..1000).for_each(|value| gpu.map::<SetValue>(&all, &SetValueUniform { value }, (), &mut array));
    let mut copy = gpu.read_back(&array).unwrap();
    let elements = loop {
        if let Some(elements) = copy.try_read().unwrap() {
            break elements;
        }
        std::thread::yield_now();
    };
    assert!(elements.len() == 1 << 20 && elements.iter().all(|&element| element == 999));
    assert_eq!(copy.try_read().unwrap(), Some(elements), "they stay");
}

/// What comes after a copy does not show in it, whichever is waited for first.
#[test]
fn a_copy_holds_what_was_before_it_alone() {
    let gpu = gpu();
    let mut array = gpu.filled(1 << 20, 7_u32);
    let first = gpu.read_back(&array).unwrap();
    let all = gpu.all(array.len());
    (0..1000).for_each(|value| gpu.map::<SetValue>(&all, &SetValueUniform { value }, (), &mut array));
    let last = gpu.read_back(&array).unwrap();
    let [first, last] = [first, last].map(|copy| copy.wait().unwrap());
    assert!(first.iter().all(|&element| element == 7) && last.iter().all(|&element| element == 999));
}

#[test]
fn memory_of_a_copy_is_used_again_whether_it_arrived_or_not() {
    let gpu = gpu();
    let array = gpu.filled(1000, 3_u32);
    drop(gpu.read_back(&array).unwrap());
    let allocated = gpu.allocated();
    for _ in 0..3 {
        drop(gpu.read_back(&array).unwrap());
        let mut copy = gpu.read_back(&array).unwrap();
        gpu.wait().unwrap();
        assert_eq!(copy.try_read().unwrap(), Some(vec![3; 1000]));
    }
    assert_eq!(gpu.allocated(), allocated);
}

#[test]
fn a_copy_of_nothing_is_there_at_once() {
    let gpu = gpu();
    let mut copy = gpu.read_back(&gpu.filled(0, 0_u32)).unwrap();
    assert!(copy.is_empty());
    assert_eq!(copy.try_read().unwrap(), Some(Vec::new()));
    assert_eq!(copy.wait().unwrap(), Vec::<u32>::new());
}

#[test]
fn a_copy_can_be_awaited_on_another_thread() {
    let gpu = gpu();
    let copy = gpu.read_back(&gpu.filled(100, 9_u32)).unwrap();
    let elements = std::thread::spawn(move || copy.wait()).join().unwrap();
    assert_eq!(elements.unwrap(), vec![9; 100]);
}

#[test]
fn a_lost_device_is_told_by_every_copy() {
    let gpu = gpu();
    let array = gpu.filled(100, 7_u32);
    let (mut asked, awaited) = (gpu.read_back(&array).unwrap(), gpu.read_back(&array).unwrap());
    let arrived = gpu.read_back(&array).unwrap();
    assert_eq!(arrived.wait().unwrap(), vec![7; 100]);
    gpu.device().destroy();
    let is_lost = |error: Option<GpuError>| matches!(error, Some(GpuError::Lost(_)));
    let answer = (0..1_000_000).find_map(|_| asked.try_read().transpose());
    assert!(matches!(answer, Some(Ok(_) | Err(GpuError::Lost(_)))), "{answer:?}");
    assert!(matches!(awaited.wait(), Ok(_) | Err(GpuError::Lost(_))));
    assert!(is_lost(gpu.read_back(&array).and_then(vivace_gpu::ReadBack::wait).err()));
    assert!(is_lost(gpu.read_back(&array).and_then(|mut copy| copy.try_read()).err()));
}

/// A device of the caller's tells nothing of its own accord.
#[test]
fn the_loss_of_the_callers_device_is_told() {
    let (device, queue) = crate::device::device(wgpu::Limits::default());
    let gpu = Gpu::from_device(device.clone(), queue).unwrap();
    let array = gpu.filled(100, 7_u32);
    assert_eq!(gpu.read_back(&array).unwrap().wait().unwrap(), vec![7; 100]);
    let mut pending = gpu.read_back(&array).unwrap();
    device.destroy();
    // What arrived before the loss may still be had; what did not is not waited for without end.
    let answer = (0..1_000_000).find_map(|_| pending.try_read().transpose());
    assert!(matches!(answer, Some(Ok(_) | Err(GpuError::Lost(_)))), "{answer:?}");
    assert!(matches!(gpu.read_back(&array).and_then(vivace_gpu::ReadBack::wait), Err(GpuError::Lost(_))));
}

/// A point at the center of every second pixel of a row, drawn by a pipeline of the caller's from the array itself.
#[test]
fn a_renderer_draws_from_the_array_itself() {
    const SIZE: u32 = 64;
    let gpu = gpu();
    let (device, queue) = (gpu.device(), gpu.queue());
    let center = |pixel: u32| (pixel as f32 + 0.5) / SIZE as f32 * 2.0 - 1.0;
    let points: Vec<[f32; 4]> = (0..SIZE).step_by(2).map(|pixel| [center(pixel), 0.0, 0.0, 7.0]).collect();
    let array = gpu.upload(&points);
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width: SIZE, height: 1, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8Unorm,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
    let pixels = gpu.filled(SIZE as usize, 0_u32);
    let pipeline = points_pipeline(device);
    gpu.submit();
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: &view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                store: wgpu::StoreOp::Store,
            },
        })],
        ..wgpu::RenderPassDescriptor::default()
    });
    pass.set_pipeline(&pipeline);
    pass.set_vertex_buffer(0, array.raw().unwrap().slice(..));
    pass.draw(0..u32::try_from(array.len()).unwrap(), 0..1);
    drop(pass);
    let layout =
        wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * SIZE), rows_per_image: None };
    let to = wgpu::TexelCopyBufferInfo { buffer: pixels.raw().unwrap(), layout };
    encoder.copy_texture_to_buffer(texture.as_image_copy(), to, texture.size());
    queue.submit([encoder.finish()]);
    let drawn = gpu.read_back(&pixels).unwrap().wait().unwrap();
    let expected: Vec<u32> = (0..SIZE).map(|pixel| if pixel % 2 == 0 { u32::MAX } else { 0 }).collect();
    assert_eq!(drawn, expected);
}

/// Draws a white pixel for each position, as the layout of positions is documented.
fn points_pipeline(device: &wgpu::Device) -> wgpu::RenderPipeline {
    const WGSL: &str = "
        @vertex fn place(@location(0) position: vec3f) -> @builtin(position) vec4f { return vec4f(position, 1.0); }
        @fragment fn paint() -> @location(0) vec4f { return vec4f(1.0); }";
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(WGSL.into()),
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: None,
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("place"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[Some(wgpu::VertexBufferLayout {
                array_stride: 16,
                step_mode: wgpu::VertexStepMode::Vertex,
                attributes: &wgpu::vertex_attr_array![0 => Float32x3],
            })],
        },
        primitive: wgpu::PrimitiveState {
            topology: wgpu::PrimitiveTopology::PointList,
            ..wgpu::PrimitiveState::default()
        },
        depth_stencil: None,
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("paint"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(wgpu::TextureFormat::Rgba8Unorm.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}
