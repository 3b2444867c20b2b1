//! Every kernel over particles on both backends: random inputs, lists with gaps, sentinels past the end of what is written.

use bytemuck::Pod;
use glam::{Vec3, Vec4};
use vivace_cpu::Cpu;
use vivace_gpu::Gpu;
use vivace_kernels::pd::{
    Anchor, FusedResidual, LinearResidual, MoveByBlock, MoveByDiagonal, Omega, RelaxFused, RelaxLinear, Row,
    RowEnergy, SLICE, SpringBlock, SpringPull, SpringTap, Tap,
};
use vivace_kernels::step::{
    Blow, BlowUniform, CopyVector, Extrapolate, ExtrapolateUniform, Place, Predict, PredictUniform,
    SetVector, SetVectorUniform, SquaredDistance, SquaredLength, Sum, SumUniform, UpdateVelocity,
    UpdateVelocityUniform,
};
use vivace_kernels::{Backend, HostViews, Kernel, Map, View, pd, step};
use vivace_tests::naive::Naive;
use vivace_tests::random::Random;

use crate::cases::sample_of;
use crate::gpu;

const COUNTS: [u32; 11] = [0, 1, 2, 31, 32, 33, 255, 256, 257, 511, 1234];
/// Particles past those that a list may hold: they are read and never written.
const N_FIXED: u32 = 300;

/// Particles, rows that end in the fixed ones, triangles.
struct Data {
    n: u32,
    rows: Vec<Row>,
    taps: Vec<Tap>,
    springs: Vec<SpringTap>,
    vectors: [Vec<Vec4>; 3],
    numbers: Vec<f32>,
    offsets: Vec<u32>,
    corners: Vec<[u32; 3]>,
}

#[expect(clippy::cast_possible_truncation, reason = "any number will do")]
fn any_number(random: &mut Random) -> f32 {
    random.unit() as f32
}

impl Data {
    fn new(n: u32) -> Self {
        let mut random = Random::new(u64::from(n) + 3);
        let mut unit = move || any_number(&mut random);
        let mut column = Random::new(5);
        let n_all = (n + N_FIXED) as usize;
        let vector = |_| Vec4::new(unit() - 0.5, unit() - 0.5, unit() - 0.5, (4.0 * unit()).floor());
        let vectors: Vec<Vec4> = (0..3 * n_all).map(vector).collect();
        let mut random = Random::new(u64::from(n) + 4);
        let mut unit = move || any_number(&mut random);
        let n_rows = n.next_multiple_of(SLICE);
        let most = 9;
        let row = |i: u32| Row {
            first: i / SLICE * SLICE * most + i % SLICE,
            n_springs: i % 7,
            n: i % 7 + i % 3,
            inverse_diagonal: 0.1 + unit(),
        };
        let rows: Vec<Row> = (0..n).map(row).collect();
        let n_taps = n_rows * most;
        let tap = |_| Tap { column: n + column.below(N_FIXED), weight: 2.0 };
        let spring = |k: u32| SpringTap {
            pull: 0.5 * (k % 5) as f32,
            stiffness: 1.5,
            compliance: 0.3,
            linear: 0.25 * (k % 3) as f32,
        };
        let mut random = Random::new(9);
        let triangle = |_| [(); 3].map(|()| random.below(n + N_FIXED));
        Self {
            n,
            rows,
            taps: (0..n_taps).map(tap).collect(),
            springs: (0..n_taps).map(spring).collect(),
            numbers: vectors.iter().map(|v| v.x).collect(),
            vectors: [0, 1, 2].map(|k| vectors[k * n_all..(k + 1) * n_all].to_vec()),
            offsets: (0..=n).map(|i| i * 2 + i / 2).collect(),
            corners: (0..3 * n + 3).map(triangle).collect(),
        }
    }
}

/// The data on a backend, and a list of three particles of four.
struct On<'a, B: Backend> {
    backend: &'a B,
    list: B::List,
    rows: B::Buffer<Row>,
    taps: B::Buffer<Tap>,
    springs: B::Buffer<SpringTap>,
    pulls: B::Buffer<f32>,
    vectors: [B::Buffer<Vec4>; 3],
    blocks: B::Buffer<[Vec4; 2]>,
    numbers: B::Buffer<f32>,
    offsets: B::Buffer<u32>,
    corners: B::Buffer<[u32; 3]>,
}

impl<'a, B: Backend> On<'a, B> {
    fn new(backend: &'a B, data: &Data) -> Self {
        let pulls: Vec<f32> = data.springs.iter().map(|spring| spring.pull).collect();
        let block = |v: &Vec4| [(*v * 0.5 + Vec4::splat(1.0)), *v * 0.3];
        let blocks: Vec<_> = data.vectors[1].iter().map(block).collect();
        Self {
            list: sample_of(backend, data.n as usize, 77),
            rows: backend.upload(&data.rows),
            taps: backend.upload(&data.taps),
            springs: backend.upload(&data.springs),
            pulls: backend.upload(&pulls),
            vectors: [0, 1, 2].map(|k| backend.upload(&data.vectors[k])),
            blocks: backend.upload(&blocks),
            numbers: backend.upload(&data.numbers),
            offsets: backend.upload(&data.offsets),
            corners: backend.upload(&data.corners),
            backend,
        }
    }

    fn vector(&self, k: usize) -> View<'_, B, Vec4> {
        self.backend.view(&self.vectors[k])
    }
}

/// The words of what a run leaves of `before`.
fn written<B: Backend, T: Pod + Send + Sync>(
    on: &On<'_, B>,
    before: &[T],
    run: impl FnOnce(&mut B::Buffer<T>),
) -> Result<Vec<f32>, B::Error> {
    let mut output = on.backend.upload(before);
    run(&mut output);
    Ok(bytemuck::cast_slice(&on.backend.read(output)?).to_vec())
}

/// The names of the kernels, and what each of them leaves.
fn all<B: Backend>(backend: &B, data: &Data) -> Result<Vec<(&'static str, Vec<f32>)>, B::Error> {
    let on = On::new(backend, data);
    let (rows, taps) = (backend.view(&on.rows), backend.view(&on.taps));
    let (pulls, springs) = (backend.view(&on.pulls), backend.view(&on.springs));
    let (a, b, c) = (on.vector(0), on.vector(1), on.vector(2));
    let (vectors, list, omega) = (&data.vectors[2], &on.list, Omega { omega: 1.3 });
    let blocks: Vec<_> = vectors.iter().map(|&v| [v, v]).collect();
    macro_rules! map {
        ($kernel:ident, $uniform:expr, $inputs:expr, $before:expr) => {
            (
                $kernel::NAME,
                written(&on, $before, |own| backend.map::<$kernel>(list, $uniform, $inputs, own))?,
            )
        };
    }
    macro_rules! update {
        ($kernel:ident, $inputs:expr) => {
            (
                $kernel::NAME,
                written(&on, vectors, |own| backend.update::<$kernel>(list, &omega, $inputs, own))?,
            )
        };
    }
    let blow = BlowUniform {
        gravity: Vec3::new(0.0, -9.81, 0.5),
        h: 0.03,
        velocity: Vec3::new(1.0, -2.0, 0.5),
        sixth_of_drag: 2.5,
        skin: 0.1,
        padding: [0; 3],
    };
    let n_sums = data.n.div_ceil(step::BLOCK);
    let sum = SumUniform { first: 3, n_sums, n_numbers: data.n };
    let sums = backend.range(3..3 + n_sums);
    Ok(vec![
        map!(Anchor, &(), (a, b), vectors),
        map!(FusedResidual, &(), (rows, taps, pulls, b, a), vectors),
        map!(LinearResidual, &(), (rows, taps, b, c, a), vectors),
        map!(MoveByBlock, &omega, (rows, a, backend.view(&on.blocks)), vectors),
        map!(MoveByDiagonal, &omega, (rows, a), vectors),
        update!(RelaxFused, (rows, taps, pulls, b)),
        update!(RelaxLinear, (rows, taps, b, a)),
        map!(RowEnergy, &(), (rows, taps, springs, b, a), &data.numbers),
        map!(SpringBlock, &(), (rows, taps, springs, a), &blocks),
        map!(SpringPull, &(), (rows, taps, pulls, a), vectors),
        map!(Blow, &blow, (backend.view(&on.offsets), backend.view(&on.corners), a, b), vectors),
        map!(CopyVector, &(), (a,), vectors),
        map!(Extrapolate, &ExtrapolateUniform { omega: 1.3 }, (a,), vectors),
        (Place::NAME, written(&on, vectors, |own| backend.update::<Place>(list, &(), (a,), own))?),
        map!(Predict, &PredictUniform { h: 0.03 }, (a, b, c), vectors),
        map!(SetVector, &SetVectorUniform { value: Vec4::new(1.0, 2.0, 3.0, 4.0) }, (), vectors),
        map!(SquaredDistance, &(), (a, b), &data.numbers),
        map!(SquaredLength, &(), (a,), &data.numbers),
        ("sum", {
            let numbers = backend.view(&on.numbers);
            written(&on, &data.numbers, |own| backend.map::<Sum>(&sums, &sum, (numbers,), own))?
        }),
        map!(UpdateVelocity, &UpdateVelocityUniform { scale: 30.5 }, (a, b), vectors),
    ])
}

/// The first place where two runs differ by more than `bound` of the number, or of 1.
fn difference(a: &[f32], b: &[f32], bound: f32) -> Option<String> {
    let differs = |(a, b): (&f32, &f32)| {
        let is_close = (a - b).abs() <= bound * b.abs().max(1.0);
        !(a.to_bits() == b.to_bits() || is_close)
    };
    let at = a.iter().zip(b).position(differs).or((a.len() != b.len()).then_some(usize::MAX))?;
    Some(format!("at {at}: {:?} on the GPU, {:?} on the CPU", a.get(at), b.get(at)))
}

/// Sums, products, quotients and square roots: a GPU may fuse products with sums. Mesa's software adapter rounds as the CPU does but in two
/// kernels that multiply with a square root: neither changes positions bit by bit without wind.
fn bound(gpu: &Gpu, kernel: &str) -> f32 {
    match kernel {
        _ if !gpu.is_software() => 1e-4,
        "blow" | "row_energy" => 2e-6,
        _ => 0.0,
    }
}

#[test]
fn every_kernel_leaves_what_it_leaves_on_the_cpu() {
    let device = gpu();
    let mut names = Vec::new();
    for n in COUNTS {
        let data = Data::new(n);
        let on_gpu = all(&device, &data).unwrap();
        let (Ok(on_cpu), Ok(naive)) = (all(&Cpu::new(), &data), all(&Naive::default(), &data));
        for (((name, gpu), (_, cpu)), (_, naive)) in on_gpu.iter().zip(&on_cpu).zip(&naive) {
            assert_eq!(difference(cpu, naive, 0.0), None, "{name}, {n} particles: naive");
            assert_eq!(difference(gpu, cpu, bound(&device, name)), None, "{name}, {n} particles");
        }
        names = on_gpu.into_iter().map(|(name, _)| name).collect();
    }
    for shader in pd::SHADERS.iter().chain(&step::SHADERS) {
        assert!(names.contains(&shader.name), "{}", shader.name);
    }
}

/// A twin that may be wrong: `FAULT` picks its text.
#[derive(Debug)]
struct Twin<const FAULT: usize>;

const BEGIN: &str = "
    struct Params { omega: f32 }
    @group(0) @binding(3) var<uniform> params: Params;
    @group(1) @binding(0) var<storage, read> previous: array<vec4<f32>>;
    @group(1) @binding(1) var<storage, read_write> q: array<vec4<f32>>;";
const TEXTS: [&str; 4] = [
    "fn map(i: u32) { let p = previous[i].xyz; q[i] = vec4(p + (q[i].xyz - p) * params.omega, q[i].w); }",
    // A hundred-thousandth too far.
    "fn map(i: u32) { let p = previous[i].xyz; q[i] = vec4(p + (q[i].xyz - p) * params.omega * 1.001, q[i].w); }",
    // Forgets the mass.
    "fn map(i: u32) { let p = previous[i].xyz; q[i] = vec4(p + (q[i].xyz - p) * params.omega, 0.0); }",
    // Moves the next particle.
    "fn map(i: u32) { let p = previous[i].xyz; q[i + 1u] = vec4(p + (q[i].xyz - p) * params.omega, q[i].w); }",
];

impl<const FAULT: usize> Kernel for Twin<FAULT> {
    const NAME: &'static str = "twin";
    const WGSL: &'static [&'static str] = &[BEGIN, TEXTS[FAULT]];
    type Uniform = ExtrapolateUniform;
    type Inputs = (Vec4,);
}

impl<const FAULT: usize> Map for Twin<FAULT> {
    type Output = Vec4;

    fn map(i: u32, uniform: &ExtrapolateUniform, inputs: HostViews<'_, Self>, q: &mut Vec4) {
        Extrapolate::map(i, uniform, inputs, q);
    }
}

fn twin<B: Backend, const FAULT: usize>(backend: &B, data: &Data) -> Result<Vec<f32>, B::Error> {
    let on = On::new(backend, data);
    let uniform = ExtrapolateUniform { omega: 1.3 };
    written(&on, &data.vectors[2], |own| {
        backend.map::<Twin<FAULT>>(&on.list, &uniform, (on.vector(0),), own);
    })
}

/// A comparison counts once it has been seen to fail.
#[test]
fn a_wrong_twin_is_noticed() {
    fn mismatch<const FAULT: usize>(gpu: &Gpu) -> Option<String> {
        let data = Data::new(257);
        let Ok(on_cpu) = twin::<_, FAULT>(&Cpu::new(), &data);
        difference(&twin::<_, FAULT>(gpu, &data).unwrap(), &on_cpu, 1e-4)
    }
    let gpu = gpu();
    assert_eq!(mismatch::<0>(&gpu), None);
    assert!(mismatch::<1>(&gpu).is_some());
    assert!(mismatch::<2>(&gpu).is_some());
    assert!(mismatch::<3>(&gpu).is_some());
}
