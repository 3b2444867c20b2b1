//! Each kernel on both backends, at counts around the size of a group; and twins that are wrong on purpose.

use vivace_cpu::Cpu;
use vivace_gpu::{Gpu, Grids};
use vivace_kernels::coloring::SHADERS;
use vivace_kernels::{Backend, HostViews, Kernel, Map, Select, pcg};

use crate::cases::{self, Data, Left};
use crate::gpu;

/// Around the 64 and 256 invocations of a group and its multiples, and past what one group can scan by one element each.
const COUNTS: [u32; 13] = [0, 1, 2, 63, 64, 65, 255, 256, 257, 511, 1000, 1234, 70_000];
const SEEDS: [u64; 2] = [1, 20_161_124];

/// The first place where two runs differ, in words.
fn difference(gpu: &Left, cpu: &Left) -> Option<String> {
    let first = |gpu: &[u32], cpu: &[u32]| {
        let differs = gpu.iter().zip(cpu).position(|(a, b)| a != b);
        differs
            .or((gpu.len() != cpu.len()).then_some(gpu.len().min(cpu.len())))
            .map(|i| format!("at {i}: {:?} on the GPU, {:?} on the CPU", gpu.get(i), cpu.get(i)))
    };
    let arrays = first(&gpu.array, &cpu.array).map(|place| format!("array {place}"));
    let lists = || gpu.lists.iter().zip(&cpu.lists).enumerate();
    arrays.or_else(|| lists().find_map(|(k, (a, b))| Some(format!("list {k} {}", first(a, b)?))))
}

/// The first difference of a case over all counts and seeds.
fn mismatch(
    gpu: &Gpu,
    on_gpu: impl Fn(&Gpu, &Data) -> Left,
    on_cpu: impl Fn(&Data) -> Left,
) -> Option<String> {
    COUNTS.iter().flat_map(|&n| SEEDS.map(|seed| (n, seed))).find_map(|(n, seed)| {
        let data = Data::new(n, seed);
        let place = difference(&on_gpu(gpu, &data), &on_cpu(&data))?;
        Some(format!("{n} elements, seed {seed}: {place}"))
    })
}

macro_rules! mismatch {
    ($gpu:expr, $case:path) => {
        mismatch(
            $gpu,
            |gpu, data| $case(gpu, data).unwrap_or_else(|error| panic!("{error}")),
            |data| {
                let Ok(left) = $case(&Cpu::new(), data);
                left
            },
        )
    };
}

macro_rules! conform {
    ($($case:ident),* $(,)?) => {
        /// Names of all cases.
        const CASES: &[&str] = &[$(stringify!($case)),*];
        $(
            #[test]
            fn $case() {
                for grids in [Grids::Indirect, Grids::Bounds] {
                    assert_eq!(mismatch!(&gpu().with_grids(grids), cases::$case), None, "{grids:?}");
                }
            }
        )*
    };
}

conform!(
    accept_color,
    accept_color_of_all,
    color_instead,
    degree_weight,
    filled,
    first_fit,
    first_fit_in_order,
    grouped,
    is_colored,
    lacks_color,
    leave_neighbors,
    local_maximum,
    neighbor_has_color,
    propose_color,
    random_weight,
    ranges,
    sample_and_the_rest,
    set_value,
    take_color,
);

#[test]
fn every_kernel_has_a_case() {
    for shader in &SHADERS {
        assert!(CASES.contains(&shader.name), "{}", shader.name);
    }
}

/// A kernel whose twin may be wrong: `FAULT` picks its text.
#[derive(Debug)]
struct Twin<const FAULT: usize>;

/// How the twins of [`Twin`] begin, and what each does.
const BEGIN: &str = "@group(1) @binding(0) var<storage, read_write> own: array<u32>;";
const TEXTS: [&str; 6] = [
    "fn map(v: u32) { own[v] = hash(v, 5u) & 7u; } fn select_element(v: u32) -> bool { map(v); return own[v] < 3u; }",
    // Off by one value in eight.
    "fn map(v: u32) { own[v] = min(hash(v, 5u) & 7u, 6u); } fn select_element(v: u32) -> bool { own[v] = hash(v, 5u) & 7u; return own[v] < 3u; }",
    // Writes beside its element.
    "fn map(v: u32) { own[v + 1u] = hash(v, 5u) & 7u; } fn select_element(v: u32) -> bool { own[v] = hash(v, 5u) & 7u; return own[v] < 3u; }",
    // Writes past the end of the list.
    "fn map(v: u32) { own[v] = hash(v, 5u) & 7u; own[v + 299u] = 0u; } fn select_element(v: u32) -> bool { own[v] = hash(v, 5u) & 7u; return own[v] < 3u; }",
    // Selects what it should not.
    "fn map(v: u32) { own[v] = hash(v, 5u) & 7u; } fn select_element(v: u32) -> bool { map(v); return own[v] <= 3u; }",
    // Forgets to write what it does not select.
    "fn map(v: u32) { own[v] = hash(v, 5u) & 7u; } fn select_element(v: u32) -> bool { if (hash(v, 5u) & 7u) < 3u { map(v); return true; } return false; }",
];

impl<const FAULT: usize> Kernel for Twin<FAULT> {
    const NAME: &'static str = "twin";
    const WGSL: &'static [&'static str] = &[pcg::WGSL, BEGIN, TEXTS[FAULT]];
    type Uniform = ();
    type Inputs = ();
}

impl<const FAULT: usize> Map for Twin<FAULT> {
    type Output = u32;

    fn map(v: u32, (): &(), (): HostViews<'_, Self>, own: &mut u32) {
        *own = pcg::hash(v, 5) & 7;
    }
}

impl<const FAULT: usize> Select for Twin<FAULT> {
    type Output = u32;

    fn select(v: u32, (): &(), (): HostViews<'_, Self>, own: &mut u32) -> bool {
        *own = pcg::hash(v, 5) & 7;
        *own < 3
    }
}

fn twin<const FAULT: usize, B: Backend>(backend: &B, data: &Data) -> Result<Left, B::Error> {
    let len = data.n as usize + 300;
    let (mut mapped, mut own) = (backend.filled(len, u32::MAX), backend.filled(len, u32::MAX));
    let mut list = backend.all(data.n as usize);
    backend.map::<Twin<FAULT>>(&list, &(), (), &mut mapped);
    let selected = backend.select::<Twin<FAULT>>(&mut list, &(), (), &mut own);
    let array = [backend.read(mapped)?, backend.read(own)?].concat();
    Ok(Left { array, lists: vec![backend.indices(&list)?, backend.indices(&selected)?] })
}

/// A comparison counts once it has been seen to fail.
#[test]
fn a_wrong_twin_is_noticed() {
    let gpu = gpu();
    assert_eq!(mismatch!(&gpu, twin::<0, _>), None);
    assert_ne!(mismatch!(&gpu, twin::<1, _>), None);
    assert_ne!(mismatch!(&gpu, twin::<2, _>), None);
    assert_ne!(mismatch!(&gpu, twin::<3, _>), None);
    assert_ne!(mismatch!(&gpu, twin::<4, _>), None);
    assert_ne!(mismatch!(&gpu, twin::<5, _>), None);
}
