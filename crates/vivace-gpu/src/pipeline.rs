//! Pipelines, made when they are first used.

use std::any::TypeId;
use std::cell::RefCell;
use std::collections::HashMap;
use std::sync::Arc;

use vivace_kernels::{Form, ListShader, Shader};

/// Bytes of a kernel's uniform, at most, and the distance of uniforms from each other.
pub(crate) const UNIFORM_BYTES: usize = 256;

/// What stands at a binding.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Binding {
    Read,
    Write,
    Uniform,
}
use Binding::{Read, Uniform, Write};

/// A compute pipeline and the layouts of its groups: one for the run, and one for the kernel's own arrays if it has any.
pub(crate) struct Pipeline {
    /// The kernel's.
    pub(crate) name: &'static str,
    pub(crate) pipeline: wgpu::ComputePipeline,
    pub(crate) layouts: Vec<wgpu::BindGroupLayout>,
    /// Uniforms of group 0, which are bound at an offset that is given with each dispatch.
    pub(crate) n_uniforms: usize,
}

/// Which pipeline.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum Key {
    Kernel(TypeId, Form),
    List(ListShader),
}

/// All pipelines of a device.
#[derive(Default)]
pub(crate) struct Pipelines {
    made: RefCell<HashMap<Key, Arc<Pipeline>>>,
}

impl Pipelines {
    /// The pipeline of kernel `K` in the form that `shader` has.
    pub(crate) fn kernel<K: 'static>(&self, device: &wgpu::Device, shader: &Shader) -> Arc<Pipeline> {
        self.get(Key::Kernel(TypeId::of::<K>(), shader.form), || {
            let run = [Read, Read, Uniform, Uniform, Write];
            let n_run = if matches!(shader.form, Form::Select | Form::Expand) { 5 } else { 4 };
            let mut own = vec![Read; shader.n_inputs];
            own.resize(shader.n_inputs + shader.form.n_outputs(), Write);
            Pipeline::new(device, shader.name, &shader.wgsl(), &[&run[..n_run], &own])
        })
    }

    /// A pipeline between kernels.
    pub(crate) fn list(&self, device: &wgpu::Device, shader: ListShader) -> Arc<Pipeline> {
        self.get(Key::List(shader), || {
            let groups: &[&[Binding]] = match shader {
                ListShader::Fill => &[&[Write, Uniform, Uniform]],
                ListShader::All | ListShader::Scan => &[&[Write, Write, Uniform]],
                ListShader::Split => &[&[Read, Read, Uniform], &[Read, Write, Write]],
                ListShader::Place => &[&[Write, Write, Uniform, Write]],
                ListShader::Number => &[&[Read, Write, Uniform]],
                ListShader::CountKeys => &[&[Read, Write, Uniform]],
                ListShader::ScanKeys => &[&[Write, Write, Uniform, Uniform]],
                ListShader::PlaceKeys => &[&[Read, Read, Write, Uniform]],
            };
            Pipeline::new(device, shader.name(), &shader.wgsl(), groups)
        })
    }

    fn get(&self, key: Key, make: impl FnOnce() -> Pipeline) -> Arc<Pipeline> {
        self.made.borrow_mut().entry(key).or_insert_with(|| Arc::new(make())).clone()
    }
}

impl Pipeline {
    fn new(device: &wgpu::Device, name: &'static str, wgsl: &str, groups: &[&[Binding]]) -> Self {
        let layout = |bindings: &&[Binding]| {
            let entries: Vec<_> =
                (0..).zip(*bindings).map(|(place, binding)| binding.layout(place)).collect();
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some(name),
                entries: &entries,
            })
        };
        let layouts: Vec<_> = groups.iter().map(layout).collect();
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(name),
            source: wgpu::ShaderSource::Wgsl(wgsl.into()),
        });
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(name),
            bind_group_layouts: &layouts.iter().map(Some).collect::<Vec<_>>(),
            immediate_size: 0,
        });
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(name),
            layout: Some(&layout),
            module: &module,
            entry_point: Some("main"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        let n_uniforms = groups[0].iter().filter(|&&binding| binding == Uniform).count();
        Self { name, pipeline, layouts, n_uniforms }
    }
}

impl Binding {
    fn layout(self, place: u32) -> wgpu::BindGroupLayoutEntry {
        let ty = match self {
            Read | Write => wgpu::BufferBindingType::Storage { read_only: self == Read },
            Uniform => wgpu::BufferBindingType::Uniform,
        };
        wgpu::BindGroupLayoutEntry {
            binding: place,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: self == Uniform, min_binding_size: None },
            count: None,
        }
    }
}
