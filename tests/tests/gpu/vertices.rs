//! Every kernel over particles on both backends: random inputs, lists with gaps, sentinels past the end of what is written.

use bytemuck::Pod;
use glam::{Vec3, Vec4};
use vivace_cpu::Cpu;
use vivace_gpu::Gpu;
use vivace_kernels::constraint::Xpbd;
use vivace_kernels::linear::{
    AddScaled, AddScaledUniform, Divide, Dot, FindScalars, FindScalarsUniform, Multiply, Pick, PickUniform,
    Scalars, Substitute, SubstituteUniform, SumPairs, Sweep, SweepUniform, Turn,
};
use vivace_kernels::pd::{
    Anchor, FusedResidual, LinearResidual, MoveByBlock, MoveByDiagonal, Omega, RelaxFused, RelaxLinear, Row,
    RowEnergy, SLICE, ShiftAnchor, SpringBlock, SpringPull, SpringTap, Tap,
};
use vivace_kernels::step::{
    Blow, BlowUniform, CopyVector, CopyVectorWhere, CopyVectorWhereUniform, Decide, DecideUniform,
    Extrapolate, ExtrapolateUniform, PickWeight, PickWeightUniform, Place, Predict, PredictUniform,
    SetVector, SetVectorUniform, SquaredDistance, SquaredLength, Sum, SumUniform, UpdateVelocity,
    UpdateVelocityUniform, Watch, Weight,
};
use vivace_kernels::{Backend, HostViews, Kernel, Map, PARAMS_BYTES, Params, View, linear, pd, step};
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
    /// Some of which contacts have shifted.
    anchors: Vec<Vec4>,
    mobility: Vec<f32>,
    numbers: Vec<f32>,
    offsets: Vec<u32>,
    corners: Vec<[u32; 3]>,
    watches: Vec<Watch>,
    scalars: Vec<Scalars>,
    pairs: Vec<[Vec4; 2]>,
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
        // Bounds on either side of a sum of a few hundred numbers around 0, levels at both ends, steps that are quiet for long.
        let mut any = Random::new(6);
        let mut watch = |_| Watch {
            lowest: 40.0 * any_number(&mut any) - 20.0,
            kept: any_number(&mut any),
            level: any.below(6),
            quiet_steps: any.below(8),
            began_at: any.below(5),
            n_backoffs: any.below(9),
            has_backed_off: any.below(2),
            is_back: any.below(2),
        };
        let watches = (0..n_all).map(&mut watch).collect();
        let scalar = |v: &Vec4| Scalars { rho: *v, enough: *v * 99.0, alpha: *v * 0.5, beta: *v * 2.0 };
        let scalars = vectors.iter().map(scalar).collect();
        let pairs = vectors.iter().map(|&v| [v, v * v]).collect();
        Self {
            n,
            watches,
            scalars,
            pairs,
            rows,
            taps: (0..n_taps).map(tap).collect(),
            springs: (0..n_taps).map(spring).collect(),
            anchors: vectors[n_all..2 * n_all].iter().map(|v| v.truncate().extend(v.w - 1.5)).collect(),
            mobility: vectors.iter().map(|v| 1.0 + v.y).collect(),
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
    anchors: B::Buffer<Vec4>,
    mobility: B::Buffer<f32>,
    blocks: B::Buffer<[Vec4; 2]>,
    numbers: B::Buffer<f32>,
    offsets: B::Buffer<u32>,
    corners: B::Buffer<[u32; 3]>,
    watch: B::Buffer<Watch>,
    scalars: B::Buffer<Scalars>,
    pairs: B::Buffer<[Vec4; 2]>,
    weights: B::Buffer<ExtrapolateUniform>,
    numbers_len: usize,
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
            anchors: backend.upload(&data.anchors),
            mobility: backend.upload(&data.mobility),
            blocks: backend.upload(&blocks),
            numbers: backend.upload(&data.numbers),
            offsets: backend.upload(&data.offsets),
            corners: backend.upload(&data.corners),
            watch: backend.upload(&[Watch { level: 1, began_at: 2, is_back: 1, ..Watch::default() }]),
            scalars: backend.upload(&data.scalars),
            pairs: backend.upload(&data.pairs),
            weights: backend.upload(&[1.0, 0.7].map(|omega| [ExtrapolateUniform { omega }; 64]).concat()),
            numbers_len: data.numbers.len(),
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

/// Weights of iterations picked from a table of three levels.
fn pick<B: Backend, U: Weight>(on: &On<'_, B>) -> Result<(&'static str, Vec<f32>), B::Error> {
    let backend = on.backend;
    let numbers: Vec<f32> = (0_u8..42).map(f32::from).collect();
    let table = backend.upload(bytemuck::cast_slice::<f32, U>(&numbers));
    let before = vec![U::zeroed(); on.numbers_len];
    let uniform = PickWeightUniform { k: 4, stride: 50, n: 7 };
    let inputs = (backend.view(&on.watch), backend.view(&table));
    let left = written(on, &before, |own| backend.map::<PickWeight<U>>(&on.list, &uniform, inputs, own))?;
    Ok((PickWeight::<U>::NAME, left))
}

/// Anchors after contacts.
fn shift<'a, B: Backend>(
    on: &On<'_, B>,
    anchors: &[Vec4],
    inputs: (View<'a, B, Vec4>, View<'a, B, Vec4>, View<'a, B, f32>),
) -> Result<(&'static str, Vec<f32>), B::Error> {
    let left = written(on, anchors, |own| on.backend.update::<ShiftAnchor>(&on.list, &(), inputs, own))?;
    Ok((ShiftAnchor::NAME, left))
}

/// The names of the kernels, and what each of them leaves.
fn all<B: Backend>(backend: &B, data: &Data) -> Result<Vec<(&'static str, Vec<f32>)>, B::Error> {
    let on = On::new(backend, data);
    let (rows, taps) = (backend.view(&on.rows), backend.view(&on.taps));
    let (pulls, springs) = (backend.view(&on.pulls), backend.view(&on.springs));
    let (a, b, c) = (on.vector(0), on.vector(1), on.vector(2));
    let (anchors, mobility) = (backend.view(&on.anchors), backend.view(&on.mobility));
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
    let decide = DecideUniform {
        n_sums: data.n.min(step::BLOCK),
        k: 8,
        is_last: 1,
        tolerated_rise: 1e-4,
        most: 4,
        recovery: 6,
        rounding: 0.5,
    };
    let find = FindScalarsUniform { stage: 0, n_sums: data.n.min(step::BLOCK), squared_tolerance: 1.0 };
    let (scalars, pairs) = (backend.view(&on.scalars), backend.view(&on.pairs));
    let n_sums = data.n.div_ceil(step::BLOCK);
    let sum = SumUniform { first: 3, n_sums, n_numbers: data.n };
    let sums = backend.range(3..3 + n_sums);
    let places: Vec<u32> = (0..data.n).map(|i| (7 * i + 3) % (data.n + N_FIXED)).collect();
    let places = backend.upload(&places);
    let first = data.n / 3;
    Ok(vec![
        map!(Anchor, &(), (a, b), vectors),
        map!(FusedResidual, &(), (rows, taps, pulls, anchors, a), vectors),
        map!(AddScaled, &AddScaledUniform { factor: -1.0, by_alpha: 1 }, (scalars, a), vectors),
        map!(AddScaled, &AddScaledUniform { factor: 1.0, by_alpha: 0 }, (scalars, a), vectors),
        map!(Divide, &(), (rows, a), vectors),
        map!(FindScalars, &FindScalarsUniform { stage: 0, ..find }, (pairs,), &data.scalars),
        map!(FindScalars, &FindScalarsUniform { stage: 1, ..find }, (pairs,), &data.scalars),
        map!(FindScalars, &FindScalarsUniform { stage: 2, ..find }, (pairs,), &data.scalars),
        map!(Multiply, &(), (rows, taps, anchors, a), vectors),
        map!(Pick, &PickUniform { adds: 0 }, (backend.view(&places), a), vectors),
        map!(Pick, &PickUniform { adds: 1 }, (backend.view(&places), a), vectors),
        (Substitute::NAME, {
            let (level, first) = (backend.range(first..data.n), SubstituteUniform { first });
            let run = |own: &mut _| backend.update::<Substitute>(&level, &first, (rows, taps), own);
            written(&on, vectors, run)?
        }),
        map!(Turn, &(), (scalars, a), vectors),
        (Sweep::NAME, {
            // Members of a color, whose neighbors are others.
            let run = |own: &mut B::Buffer<Vec4>| {
                for is_backward in [0, 1] {
                    backend.update::<Sweep>(list, &SweepUniform { is_backward }, (rows, taps, a), own);
                }
            };
            written(&on, vectors, run)?
        }),
        (Dot::NAME, written(&on, &data.pairs, |own| backend.map::<Dot>(&sums, &sum, (a, b, c), own))?),
        (
            SumPairs::NAME,
            written(&on, &data.pairs, |own| backend.map::<SumPairs>(&sums, &sum, (pairs,), own))?,
        ),
        map!(LinearResidual, &(), (rows, taps, anchors, c, a), vectors),
        map!(MoveByBlock, &omega, (rows, a, anchors, backend.view(&on.blocks)), vectors),
        map!(MoveByDiagonal, &omega, (rows, a, anchors), vectors),
        update!(RelaxFused, (rows, taps, pulls, anchors)),
        update!(RelaxLinear, (rows, taps, anchors, a)),
        map!(RowEnergy, &(), (rows, taps, springs, b, a), &data.numbers),
        shift(&on, &data.anchors, (a, c, mobility))?,
        shift(&on, &data.anchors, (a, a, mobility))?,
        map!(SpringBlock, &(), (rows, taps, springs, a), &blocks),
        map!(SpringPull, &(), (rows, taps, pulls, a), vectors),
        map!(Blow, &blow, (backend.view(&on.offsets), backend.view(&on.corners), a, b), vectors),
        map!(CopyVector, &(), (a,), vectors),
        map!(CopyVectorWhere, &CopyVectorWhereUniform { is_back: 0 }, (backend.view(&on.watch), a), vectors),
        map!(CopyVectorWhere, &CopyVectorWhereUniform { is_back: 1 }, (backend.view(&on.watch), a), vectors),
        map!(Decide, &decide, (backend.view(&on.numbers),), &data.watches),
        map!(Decide, &DecideUniform { k: 0, ..decide }, (backend.view(&on.numbers),), &data.watches),
        map!(Decide, &DecideUniform { is_last: 0, ..decide }, (backend.view(&on.numbers),), &data.watches),
        map!(Extrapolate, &ExtrapolateUniform { omega: 1.3 }, (a,), vectors),
        (Place::NAME, written(&on, vectors, |own| backend.update::<Place>(list, &(), (a,), own))?),
        (
            Extrapolate::NAME,
            written(&on, vectors, |own| {
                let found = Params::Found(&on.weights, PARAMS_BYTES / size_of::<ExtrapolateUniform>());
                backend.map::<Extrapolate>(list, found, (a,), own);
            })?,
        ),
        pick::<B, Omega>(&on)?,
        pick::<B, ExtrapolateUniform>(&on)?,
        pick::<B, Xpbd>(&on)?,
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
    for shader in pd::SHADERS.iter().chain(&linear::SHADERS).chain(&step::SHADERS) {
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
