//! Every shader, without a GPU: it is valid, binds what its declaration says, and can be said in every language of a driver.

use naga::back::{glsl, hlsl, msl, spv};
use naga::proc::BoundsCheckPolicies;
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{AddressSpace, Module, ShaderStage, StorageAccess, TypeInner};
use vivace_kernels::coloring::{AcceptColor, ProposeColor, SHADERS};
use vivace_kernels::constraint::{
    Attachment, Bending, Constraint, Spring, TetStrain, TetVolume, TriangleStrain,
};
use vivace_kernels::{Form, ListShader, Shader, collision, linear, local, pbd, pd, step};

/// The kernels over a kind.
struct Kind {
    name: &'static str,
    shaders: Vec<Shader>,
    /// Bytes and offsets of its rest data on the host.
    size: usize,
    offsets: &'static [usize],
}

impl Kind {
    fn new<C: Constraint<N, R>, const N: usize, const R: usize>(offsets: &'static [usize]) -> Self {
        let shaders = local::shaders::<C, N, R>().into();
        Self { name: C::NAME, shaders, size: size_of::<C>(), offsets }
    }
}

macro_rules! kinds {
    ($($kind:ident<$n:literal, $r:literal>($($field:ident),*)),* $(,)?) => {
        /// Every kind, with its fields.
        fn kinds() -> Vec<Kind> {
            vec![$(Kind::new::<$kind, $n, $r>(&[$(std::mem::offset_of!($kind, $field)),*])),*]
        }
    };
}
kinds!(
    Attachment < 1,
    1 > (target, stiffness),
    Bending < 4,
    1 > (row, rest, weight),
    Spring < 2,
    1 > (rest, stiffness),
    TetStrain < 4,
    3 > (columns, weight),
    TetVolume < 4,
    3 > (columns, weight, range, edges, inverse_det),
    TriangleStrain < 3,
    2 > (columns, weight, limit),
);

/// Every kernel, with the kind that it is over.
fn kernels() -> Vec<(String, Shader)> {
    let without_kind = SHADERS
        .iter()
        .chain(&collision::SHADERS)
        .chain(&linear::SHADERS)
        .chain(&pbd::SHADERS)
        .chain(&pd::SHADERS)
        .chain(&step::SHADERS);
    let without_kind = without_kind.map(|&shader| (shader.name.to_owned(), shader));
    let of_kind = |kind: Kind| {
        let name = move |shader: Shader| (format!("{} of {}", shader.name, kind.name), shader);
        kind.shaders.into_iter().map(name).collect::<Vec<_>>()
    };
    without_kind.chain(kinds().into_iter().flat_map(of_kind)).collect()
}

/// Name and text of each.
fn all() -> Vec<(String, String)> {
    let kernels = kernels().into_iter().map(|(name, shader)| (name, shader.wgsl()));
    kernels.chain(ListShader::ALL.map(|shader| (shader.name().to_owned(), shader.wgsl()))).collect()
}

/// The module, valid with no more than WebGPU promises.
fn parsed(name: &str, wgsl: &str) -> (Module, ModuleInfo) {
    let module = naga::front::wgsl::parse_str(wgsl);
    let module = module.unwrap_or_else(|error| panic!("{}", error.emit_to_string_with_path(wgsl, name)));
    let info = Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module);
    let info = info.unwrap_or_else(|error| panic!("{}", error.emit_to_string_with_path(wgsl, name)));
    (module, info)
}

/// What a storage binding allows, or `None` for a uniform.
fn access(module: &Module, group: u32, binding: u32) -> Option<StorageAccess> {
    let at = Some(naga::ResourceBinding { group, binding });
    let (_, variable) = module.global_variables.iter().find(|(_, variable)| variable.binding == at)?;
    match variable.space {
        AddressSpace::Storage { access } => Some(access),
        _ => None,
    }
}

/// What is wrong with how a kernel binds its arrays and its uniform.
fn wrong_bindings(shader: &Shader) -> Option<String> {
    let (module, _) = parsed(shader.name, &shader.wgsl());
    let n_bound = shader.n_inputs + shader.form.n_outputs();
    for (binding, place) in (0..).zip(0..n_bound) {
        let is_output = place >= shader.n_inputs;
        let expected =
            if is_output { StorageAccess::LOAD | StorageAccess::STORE } else { StorageAccess::LOAD };
        // Atomics are a kind of access of their own.
        let found = access(&module, 1, binding).map(|access| access - StorageAccess::ATOMIC);
        if found != Some(expected) {
            return Some(format!("binding {binding} has {found:?} in place of {expected:?}"));
        }
    }
    let own = |variable: &naga::GlobalVariable| variable.binding.is_some_and(|at| at.group == 1);
    let n_own = module.global_variables.iter().filter(|(_, variable)| own(variable)).count();
    if n_own != n_bound {
        return Some(format!("{n_own} arrays in place of {n_bound}"));
    }
    let uniform = Some(naga::ResourceBinding { group: 0, binding: 3 });
    let params = module.global_variables.iter().find(|(_, variable)| variable.binding == uniform);
    let span = params.map_or(0, |(_, params)| match module.types[params.ty].inner {
        TypeInner::Struct { span, .. } => span as usize,
        _ => usize::MAX,
    });
    (span != shader.uniform_bytes)
        .then(|| format!("a uniform of {span} bytes in place of {}", shader.uniform_bytes))
}

#[test]
fn bindings_match_their_declaration() {
    for (name, shader) in kernels() {
        assert_eq!(wrong_bindings(&shader), None, "{name} {:?}", shader.form);
    }
    let mut wrong = Shader::select::<AcceptColor>();
    wrong.n_inputs = 2;
    assert_eq!(
        wrong_bindings(&wrong),
        Some("binding 2 has Some(StorageAccess(LOAD)) in place of StorageAccess(LOAD | STORE)".to_owned())
    );
    let mut wrong = Shader::map::<ProposeColor>();
    wrong.uniform_bytes = 4;
    assert_eq!(wrong_bindings(&wrong), Some("a uniform of 12 bytes in place of 4".to_owned()));
}

/// Size and offsets of the struct `Rest` in a shader.
fn rest_layout(wgsl: &str) -> (usize, Vec<usize>) {
    let (module, _) = parsed("rest", wgsl);
    let is_rest = |ty: &naga::Type| ty.name.as_deref() == Some("Rest");
    let (_, rest) = module.types.iter().find(|(_, ty)| is_rest(ty)).expect("rest data");
    let TypeInner::Struct { members, span } = &rest.inner else { panic!("a struct") };
    (*span as usize, members.iter().map(|member| member.offset as usize).collect())
}

#[test]
fn rest_data_lie_alike() {
    for kind in kinds() {
        for shader in &kind.shaders {
            assert_eq!(rest_layout(&shader.wgsl()), (kind.size, kind.offsets.to_vec()), "{}", kind.name);
        }
    }
    let padded = "struct Rest { at: vec3<f32>, weights: vec2<f32> }
        @group(0) @binding(0) var<storage, read_write> rest: array<Rest>;
        @compute @workgroup_size(1) fn main() { rest[0].at = vec3(0.0); }";
    assert_eq!(rest_layout(padded), (32, vec![0, 16]));
}

#[test]
fn limits_of_web_gpu_are_kept() {
    for (name, wgsl) in all() {
        let (module, info) = parsed(&name, &wgsl);
        let [entry] = &module.entry_points[..] else { panic!("{name}: one entry point each") };
        assert_eq!((entry.name.as_str(), entry.stage), ("main", ShaderStage::Compute), "{name}");
        assert!(entry.workgroup_size.iter().product::<u32>() <= 256, "{name}");
        let used = module.global_variables.iter().filter(|(handle, variable)| {
            matches!(variable.space, AddressSpace::Storage { .. })
                && !info.get_entry_point(0)[*handle].is_empty()
        });
        assert!(used.count() <= 8, "{name}: more storage buffers than WebGPU promises");
    }
}

#[test]
fn every_driver_is_spoken_to() {
    let main = || "main".to_owned();
    for (name, wgsl) in all() {
        let (module, info) = parsed(&name, &wgsl);
        let spv = spv::write_vec(&module, &info, &spv::Options::default(), None);
        assert!(spv.unwrap_or_else(|error| panic!("{name}, SPIR-V: {error}")).len() > 100);
        let options = msl::Options { lang_version: (2, 0), ..msl::Options::default() };
        let msl = msl::write_string(&module, &info, &options, &msl::PipelineOptions::default());
        assert!(msl.unwrap_or_else(|error| panic!("{name}, MSL: {error}")).0.contains("kernel void"));
        let mut text = String::new();
        hlsl::Writer::new(&mut text, &hlsl::Options::default(), &hlsl::PipelineOptions::default())
            .write(&module, &info, None)
            .unwrap_or_else(|error| panic!("{name}, HLSL: {error}"));
        assert!(text.contains("[numthreads("), "{name}");
        let mut text = String::new();
        let pipeline = glsl::PipelineOptions {
            shader_stage: ShaderStage::Compute,
            entry_point: main(),
            multiview: None,
        };
        glsl::Writer::new(
            &mut text,
            &module,
            &info,
            &glsl::Options::default(),
            &pipeline,
            BoundsCheckPolicies::default(),
        )
        .and_then(|mut writer| writer.write())
        .unwrap_or_else(|error| panic!("{name}, GLSL: {error}"));
        assert!(text.contains("layout(local_size_x"), "{name}");
    }
}

#[test]
fn forms_and_kernels_come_together() {
    for form in [Form::UpdateInOrder, Form::ScatterInOrder] {
        let kernels = kernels();
        let mut in_order = kernels.iter().filter(|(_, shader)| shader.form == form).peekable();
        assert!(in_order.peek().is_some(), "{form:?}");
        for (name, shader) in in_order {
            assert!(shader.wgsl().contains("@workgroup_size(1)"), "{name}");
        }
    }
}
