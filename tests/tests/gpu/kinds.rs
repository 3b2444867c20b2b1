//! Every kernel over every kind of constraint on both backends: random, degenerate and inverted inputs, lists with gaps, sentinels
//! past the end of what is written.

use bytemuck::{Pod, Zeroable};
use glam::{Mat3, Quat, Vec3, Vec4};
use vivace_cpu::Cpu;
use vivace_gpu::Gpu;
use vivace_kernels::coloring::{IsColored, UNCOLORED};
use vivace_kernels::constraint::{
    Attachment, Bending, Constraint, Spring, TetStrain, TetVolume, TriangleStrain, Xpbd,
};
use vivace_kernels::local::{
    Block, Correct, Energy, Gather, Moves, Multiply, Project, Pull, PullFused, XpbdEnergy, XpbdGradient,
    shaders,
};
use vivace_kernels::{Backend, Element, pcg};
use vivace_tests::generators::to_u32;
use vivace_tests::naive::Naive;
use vivace_tests::random::Random;

use crate::cases::sample_of;
use crate::gpu;

const COUNTS: [u32; 11] = [0, 1, 2, 63, 64, 65, 255, 256, 257, 511, 1234];
const N_SENTINELS: usize = 300;
const SENTINEL: f32 = -7.25e11;

/// Constraints of one kind and where their particles are.
struct Scene<C, const N: usize> {
    key: u32,
    particles: Vec<[u32; N]>,
    rest: Vec<C>,
    q: Vec<Vec4>,
    offsets: Vec<u32>,
    slots: Vec<u32>,
    /// 0 for constraints that share no particle that moves; [`UNCOLORED`] for the others.
    colors: Vec<u32>,
    lambdas: Vec<Vec4>,
}

impl<C: Copy, const N: usize> Scene<C, N> {
    fn new(samples: &[(C, [Vec3; N])], n: u32, seed: u64, is_regular: bool) -> Self {
        let mut random = Random::new(seed);
        let kinds = to_u32(samples.len());
        let (mut particles, mut rest, mut q) = (Vec::new(), Vec::new(), Vec::new());
        for k in 0..n {
            let (of, x) = samples[(k % kinds) as usize];
            rest.push(of);
            let class = if is_regular { 0 } else { k / kinds };
            let at = deformed(x, class, &mut random);
            q.extend(at.map(|x| x.extend(if random.below(5) == 0 { 0.0 } else { unit(&mut random) })));
            // Every other one borrows its particles, place by place, from constraints of the same sample.
            let mut owner = || {
                let other = random.below(n / kinds + 1) * kinds + k % kinds;
                if k % 2 == 1 && other < n { other } else { k }
            };
            particles.push(std::array::from_fn(|slot| owner() * to_u32(N) + to_u32(slot)));
        }
        let mut at = vec![Vec::new(); q.len()];
        for (slot, &particle) in (0..).zip(particles.iter().flatten()) {
            at[particle as usize].push(slot);
        }
        let mut offsets = vec![0];
        offsets.extend(at.iter().scan(0, |end, slots: &Vec<u32>| {
            *end += to_u32(slots.len());
            Some(*end)
        }));
        let mut taken = vec![false; q.len()];
        let mut color = |particles: &[u32; N]| {
            let moving = particles.iter().map(|&p| p as usize).filter(|&p| q[p].w > 0.0);
            if moving.clone().any(|p: usize| taken[p]) {
                return UNCOLORED;
            }
            moving.for_each(|p| taken[p] = true);
            0
        };
        let colors = particles.iter().map(&mut color).collect();
        let lambdas = rest.iter().map(|_| Vec4::splat(unit(&mut random) - 0.5)).collect();
        Self { key: pcg::key(seed, n), particles, rest, q, offsets, slots: at.concat(), colors, lambdas }
    }
}

/// Uniform in (0, 1].
fn unit(random: &mut Random) -> f32 {
    f32::from(u16::try_from(random.below(1 << 16)).expect("below 2^16")).mul_add(1.0 / 65536.0, 1.0 / 65536.0)
}

/// `x` somewhat deformed, or (from class 3 on) so that a matrix of its edges is singular, inverted, small or large.
fn deformed<const N: usize>(x: [Vec3; N], class: u32, random: &mut Random) -> [Vec3; N] {
    let mut vector = || Vec3::from_array(std::array::from_fn(|_| unit(random) - 0.5));
    let turn = Mat3::from_quat(Quat::from_vec4(vector().extend(0.6)).normalize());
    let moved = x.map(|x| turn * (x + 0.4 * vector()) + Vec3::ONE);
    match class % 11 {
        0..3 => moved,
        3 => x.map(|x| x * Vec3::new(1.0, 1.0, -1.0)),
        4 => moved.map(|x| -2.0 * x),
        5 => x.map(|x| x * Vec3::new(1.0, 1.0, 0.0)),
        6 => x.map(|x| Vec3::ONE * x.x),
        7 => [moved[0]; N],
        8 => std::array::from_fn(|slot| moved[slot % (N - 1).max(1)]),
        9 => moved.map(|x| 1e-3 * x),
        _ => moved.map(|x| 1e3 * x),
    }
}

/// What a kernel writes, over a list with gaps, into an array that held `before`.
fn written<B: Backend, T: Element>(
    backend: &B,
    key: u32,
    n: usize,
    before: T,
    run: impl FnOnce(&B::List, &mut B::Buffer<T>),
) -> Result<Vec<f32>, B::Error> {
    let mut all = vec![before; n];
    let words = N_SENTINELS * size_of::<T>() / 4;
    all.extend_from_slice(bytemuck::cast_slice(&vec![SENTINEL; words]));
    let (list, mut output) = (sample_of(backend, n, key), backend.upload(&all));
    run(&list, &mut output);
    Ok(bytemuck::cast_slice(&backend.read(output)?).to_vec())
}

/// What [`Correct`] leaves of positions and multipliers: all at once on constraints of one color, or in order on those of all.
fn corrected<B: Backend, C: Constraint<N, R>, const N: usize, const R: usize>(
    backend: &B,
    scene: &Scene<C, N>,
    is_in_order: bool,
) -> Result<Vec<f32>, B::Error> {
    let mut lambdas = scene.lambdas.clone();
    lambdas.extend_from_slice(&[Vec4::splat(SENTINEL); N_SENTINELS]);
    let (mut q, mut lambdas) = (backend.upload(&scene.q), backend.upload(&lambdas));
    let (particles, rest) = (backend.upload(&scene.particles), backend.upload(&scene.rest));
    let inputs = (backend.view(&particles), backend.view(&rest));
    let mut list = sample_of(backend, scene.rest.len(), scene.key);
    if is_in_order {
        backend.scatter_in_order::<Correct<C, N, R>, N>(&list, &XPBD, inputs, &mut q, &mut lambdas);
    } else {
        let mut colors = backend.upload(&scene.colors);
        let of_color = backend.select::<IsColored>(&mut list, &(), (), &mut colors);
        backend.scatter::<Correct<C, N, R>, N>(&of_color, &XPBD, inputs, &mut q, &mut lambdas);
    }
    Ok(bytemuck::cast_slice(&[backend.read(lambdas)?, backend.read(q)?].concat()).to_vec())
}

const XPBD: Xpbd = Xpbd { squared_h: 0.01, omega: 1.2 };

/// The names of the kernels, and what each of them leaves.
fn all<B: Backend, C: Constraint<N, R>, const N: usize, const R: usize>(
    backend: &B,
    scene: &Scene<C, N>,
) -> Result<Vec<(&'static str, Vec<f32>)>, B::Error> {
    let (n, n_particles, key) = (scene.rest.len(), scene.q.len(), scene.key);
    let (particles, rest) = (backend.upload(&scene.particles), backend.upload(&scene.rest));
    let (offsets, slots) = (backend.upload(&scene.offsets), backend.upload(&scene.slots));
    let q = backend.upload(&scene.q);
    let of_constraint = || (backend.view(&particles), backend.view(&rest), backend.view(&q));
    let of_particle = || {
        let (offsets, slots) = (backend.view(&offsets), backend.view(&slots));
        (offsets, slots, backend.view(&particles), backend.view(&rest), backend.view(&q))
    };
    // Any p will do, and what was written where the list has no gap is compared beside it.
    let p: Vec<[Vec4; R]> = (0..n).map(|k| [scene.q[k] * 0.3; R]).collect();
    let p = backend.upload(&p);
    let before = Vec4::new(0.5, -0.25, 2.0, 0.0);
    let busiest: Vec<f32> = (0..n).map(|k| if k % 3 == 0 { 1.0 } else { 4.0 }).collect();
    let (busiest, lambdas) = (backend.upload(&busiest), backend.upload(&scene.lambdas));
    let moves: Vec<[Vec4; N]> = (0..n).map(|k| [scene.q[k] * 0.3; N]).collect();
    let moves = backend.upload(&moves);
    Ok(vec![
        ("block", {
            let run = |list: &_, own: &mut _| backend.map::<Block<C, N, R>>(list, &(), of_particle(), own);
            written(backend, key, n_particles, [before, before * 0.5], run)?
        }),
        ("correct", corrected(backend, scene, false)?),
        ("correct", corrected(backend, scene, true)?),
        ("energy", {
            let run = |list: &_, own: &mut _| backend.map::<Energy<C, N, R>>(list, &(), of_constraint(), own);
            written(backend, key, n, 3.0, run)?
        }),
        ("gather", {
            let inputs = (backend.view(&offsets), backend.view(&slots), backend.view(&moves));
            let run = |list: &_, own: &mut _| backend.map::<Gather<C, N, R>>(list, &(), inputs, own);
            written(backend, key, n_particles, before, run)?
        }),
        ("moves", {
            let (particles, rest, q) = of_constraint();
            let inputs = (particles, rest, q, backend.view(&busiest), backend.view(&lambdas));
            let run = |list: &_, own: &mut _| backend.map::<Moves<C, N, R>>(list, &XPBD, inputs, own);
            written(backend, key, n, [before; N], run)?
        }),
        ("multiply", {
            let (particles, rest, q) = of_constraint();
            let inputs = (particles, rest, q, backend.view(&busiest));
            let run = |list: &_, own: &mut _| backend.map::<Multiply<C, N, R>>(list, &XPBD, inputs, own);
            written(backend, key, n, before, run)?
        }),
        ("project", {
            let run =
                |list: &_, own: &mut _| backend.map::<Project<C, N, R>>(list, &(), of_constraint(), own);
            written(backend, key, n, [before; R], run)?
        }),
        ("pull", {
            let inputs =
                (backend.view(&offsets), backend.view(&slots), backend.view(&rest), backend.view(&p));
            let run = |list: &_, own: &mut _| backend.map::<Pull<C, N, R>>(list, &(), inputs, own);
            written(backend, key, n_particles, before, run)?
        }),
        ("pull_fused", {
            let run =
                |list: &_, own: &mut _| backend.map::<PullFused<C, N, R>>(list, &(), of_particle(), own);
            written(backend, key, n_particles, before, run)?
        }),
        ("xpbd_energy", {
            let run =
                |list: &_, own: &mut _| backend.map::<XpbdEnergy<C, N, R>>(list, &(), of_constraint(), own);
            written(backend, key, n, 3.0, run)?
        }),
        ("xpbd_gradient", {
            let run =
                |list: &_, own: &mut _| backend.map::<XpbdGradient<C, N, R>>(list, &(), of_particle(), own);
            written(backend, key, n_particles, before, run)?
        }),
    ])
}

/// The first place where two runs differ by more than `bound`, of the largest number or 1.
fn difference(a: &[f32], b: &[f32], bound: f32) -> Option<String> {
    let largest = b.iter().filter(|b| **b != SENTINEL).fold(1.0_f32, |most, b| b.abs().max(most));
    let differs = |(a, b): (&f32, &f32)| {
        let same = a == b || (a.is_nan() && b.is_nan());
        !(same || (*b != SENTINEL && (a - b).abs() <= bound * largest))
    };
    let at = a.iter().zip(b).position(differs).or((a.len() != b.len()).then_some(usize::MAX))?;
    Some(format!("at {at}: {:?} on the GPU, {:?} on the CPU", a.get(at), b.get(at)))
}

/// The first difference of a kind's kernels, over all counts. Everything here is sums, products, quotients and square roots, but
/// drivers may put sums in another order. A software adapter rounds each as the CPU does, so even what hangs on rounding (the rotation
/// nearest to a plane) comes out alike; one that fuses products with sums need only be finite there.
fn mismatch<C: Constraint<N, R>, const N: usize, const R: usize>(
    gpu: &Gpu,
    samples: &[(C, [Vec3; N])],
) -> Option<String> {
    let rounds_alike = gpu.is_software();
    let bound = if rounds_alike { 1e-6 } else { 1e-5 };
    for (n, is_regular) in COUNTS.iter().flat_map(|&n| [(n, true), (n, false)]) {
        let scene = Scene::new(samples, n, u64::from(n) + 7, is_regular);
        let on_gpu = all(gpu, &scene).unwrap_or_else(|error| panic!("{error}"));
        let (Ok(on_cpu), Ok(naive)) = (all(&Cpu::new(), &scene), all(&Naive::default(), &scene));
        let names = shaders::<C, N, R>().map(|shader| shader.name);
        assert!(on_cpu.iter().map(|(name, _)| *name).eq(names), "every kernel has a case");
        for (((name, gpu), (_, cpu)), (_, naive)) in on_gpu.iter().zip(&on_cpu).zip(&naive) {
            assert_eq!(difference(cpu, naive, 0.0), None, "{name}: naive");
            let found = if is_regular || rounds_alike {
                difference(gpu, cpu, bound)
            } else {
                let lost = |(gpu, cpu): (&f32, &f32)| cpu.is_finite() && !gpu.is_finite();
                gpu.iter().zip(cpu).position(lost).map(|at| format!("at {at}: not finite"))
            };
            if let Some(place) = found {
                return Some(format!("{} {name}, {n} constraints, regular {is_regular}: {place}", C::NAME));
            }
        }
    }
    None
}

const TRIANGLE: [Vec3; 3] = [Vec3::new(0.1, 0.0, 0.2), Vec3::new(1.1, 0.2, 0.0), Vec3::new(0.3, 0.9, 0.1)];
const HINGE: [Vec3; 4] =
    [Vec3::new(0.0, 0.1, 0.0), Vec3::new(1.0, 0.0, 0.1), Vec3::new(0.4, -0.9, 0.0), Vec3::new(0.6, 0.7, 0.5)];
const TET: [Vec3; 4] =
    [Vec3::new(0.0, 0.1, 0.0), Vec3::new(1.1, 0.0, 0.1), Vec3::new(0.1, 1.2, 0.2), Vec3::new(-0.1, 0.2, 1.0)];

#[test]
fn attachment() {
    let sample = (Attachment { target: Vec3::new(0.3, 0.2, 0.1), stiffness: 3.0 }, [Vec3::X]);
    assert_eq!(mismatch(&gpu(), &[sample]), None);
}

fn springs<C>(spring: impl Fn(Spring) -> C) -> Vec<(C, [Vec3; 2])> {
    let x = [Vec3::new(0.1, 0.2, 0.3), Vec3::new(1.0, 0.8, -0.2)];
    [1.2, 2.0].map(|rest| (spring(Spring { rest, stiffness: 3.0 * rest }), x)).into()
}

#[test]
fn spring() {
    assert_eq!(mismatch(&gpu(), &springs(|spring| spring)), None);
}

#[test]
fn bending() {
    let (flat, curved) = (Bending::flat(HINGE, 3.0).unwrap(), Bending::rest(HINGE, 2.0).unwrap());
    assert_eq!(mismatch(&gpu(), &[(flat, HINGE), (curved, HINGE)]), None);
}

#[test]
fn triangle_strain() {
    let sample = |limit| (TriangleStrain::rest(TRIANGLE, 3.0, limit).unwrap(), TRIANGLE);
    assert_eq!(mismatch(&gpu(), &[sample(0.0), sample(0.2)]), None);
}

#[test]
fn tet_strain() {
    let [a, b, c, d] = TET;
    let sample = |x| (TetStrain::rest(x, 3.0).unwrap(), x);
    assert_eq!(mismatch(&gpu(), &[sample(TET), sample([a, c, b, d])]), None);
}

#[test]
fn tet_volume() {
    let sample = |range| (TetVolume::rest(TET, 3.0, range).unwrap(), TET);
    assert_eq!(mismatch(&gpu(), &[sample([1.0, 1.0]), sample([0.9, 1.2])]), None);
}

/// A spring whose twin may be wrong: `FAULT` picks its text.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(transparent)]
struct Twin<const FAULT: usize>(Spring);

/// What a twin's `column` and `project` return, right first; and who changes with each.
const BEGIN: &str = "
    const N = 2u;
    const R = 1u;
    struct Rest { rest: f32, stiffness: f32 }
    fn weight(rest: Rest) -> f32 { return rest.stiffness; }
    fn deviation(rest: Rest, q: array<vec3<f32>, N>) -> Deviation {
        let r = residual(rest, q);
        let c = length3(r[0]);
        let u = r[0] * select(0.0, 1.0 / c, c > 0.0);
        return Deviation(c, array(-u, u));
    }
    fn block(rest: Rest, q: array<vec3<f32>, N>, slot: u32) -> mat3x3<f32> { return scalar_block(rest.stiffness); }";
const TEXTS: [&str; 4] = [
    "fn column(rest: Rest, slot: u32) -> array<f32, R> { return array(select(1.0, -1.0, slot == 0u)); }
     fn project(rest: Rest, aq: array<vec3<f32>, R>) -> array<vec3<f32>, R> { let l = length3(aq[0]); if l > 0.0 { return array(aq[0] * (rest.rest / l)); } return array(vec3(0.0)); }",
    // A ten-thousandth too long.
    "fn column(rest: Rest, slot: u32) -> array<f32, R> { return array(select(1.0, -1.0, slot == 0u)); }
     fn project(rest: Rest, aq: array<vec3<f32>, R>) -> array<vec3<f32>, R> { let l = length3(aq[0]); if l > 0.0 { return array(aq[0] * (1.0001 * rest.rest / l)); } return array(vec3(0.0)); }",
    // Both ends are pulled the same way.
    "fn column(rest: Rest, slot: u32) -> array<f32, R> { return array(1.0); }
     fn project(rest: Rest, aq: array<vec3<f32>, R>) -> array<vec3<f32>, R> { let l = length3(aq[0]); if l > 0.0 { return array(aq[0] * (rest.rest / l)); } return array(vec3(0.0)); }",
    // Coincident ends fall apart.
    "fn column(rest: Rest, slot: u32) -> array<f32, R> { return array(select(1.0, -1.0, slot == 0u)); }
     fn project(rest: Rest, aq: array<vec3<f32>, R>) -> array<vec3<f32>, R> { let l = length3(aq[0]); if l > 0.0 { return array(aq[0] * (rest.rest / l)); } return array(vec3(rest.rest)); }",
];

impl<const FAULT: usize> Constraint<2, 1> for Twin<FAULT> {
    const NAME: &'static str = "twin";
    // What springs take from others, and another text in place of their own.
    const WGSL: &'static [&'static str] = &[Spring::WGSL[0], BEGIN, TEXTS[FAULT]];
    type Multiplier = f32;

    fn weight(&self) -> f32 {
        self.0.weight()
    }

    fn column(&self, slot: usize) -> [f32; 1] {
        self.0.column(slot)
    }

    fn project(&self, aq: [Vec3; 1]) -> [Vec3; 1] {
        self.0.project(aq)
    }
}

/// A comparison counts once it has been seen to fail.
#[test]
fn a_wrong_kind_is_noticed() {
    let gpu = gpu();
    assert_eq!(mismatch(&gpu, &springs(Twin::<0>)), None);
    assert_ne!(mismatch(&gpu, &springs(Twin::<1>)), None);
    assert_ne!(mismatch(&gpu, &springs(Twin::<2>)), None);
    if gpu.is_software() {
        assert_ne!(mismatch(&gpu, &springs(Twin::<3>)), None);
    }
}

/// Enough springs that threads share them.
#[test]
fn threads_do_not_show() {
    let scene = Scene::new(&springs(|spring| spring), 20_000, 3, true);
    let Ok(expected) = corrected(&Naive::default(), &scene, false);
    for n_threads in [1, 2, 7] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
        let Ok(found) = pool.install(|| corrected(&Cpu::new(), &scene, false));
        assert_eq!(difference(&found, &expected, 0.0), None, "{n_threads} threads");
    }
}

/// Two constraints that move the same particle are no color.
#[test]
#[should_panic(expected = "correct: element 1 is written twice")]
fn what_is_shared_is_refused() {
    let springs = springs(|spring| spring);
    let mut scene = Scene::new(&springs, 2, 3, true);
    scene.particles = vec![[0, 1], [1, 2]];
    scene.q.iter_mut().for_each(|q| q.w = 1.0);
    (scene.colors, scene.key) = (vec![0, 0], (0..).find(|&key| sample_is_all(key)).unwrap());
    let _ = corrected(&Naive::default(), &scene, false);
}

/// Whether the sample of two is both.
fn sample_is_all(key: u32) -> bool {
    sample_of(&Naive::default(), 2, key).len() == 2
}
