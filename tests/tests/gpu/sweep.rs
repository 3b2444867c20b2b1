//! Kernels over other elements than words: a colored Gauss-Seidel sweep as the solver has it, its springs projected from the latest
//! positions. Positions are four floats, the anchor's weight and the inverse diagonal ride along in the fourth.

use bytemuck::{Pod, Zeroable};
use vivace_coloring::color;
use vivace_cpu::Cpu;
use vivace_kernels::{Backend, HostViews, Kernel, Select, Update};
use vivace_tests::generators::regular_hinge_cloth;
use vivace_tests::random::Random;

use crate::gpu;

/// One entry of a row of Y.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Tap {
    column: u32,
    /// −Y_ij \[N/m\].
    weight: f32,
    /// Stiffness times rest length \[N\]; 0 for what is no spring.
    pull: f32,
}

#[derive(Debug)]
struct Relax;

impl Kernel for Relax {
    const NAME: &'static str = "relax";
    const WGSL: &'static [&'static str] = &["
        struct Params { omega: f32 }
        struct Tap { column: u32, weight: f32, pull: f32 }
        @group(0) @binding(3) var<uniform> params: Params;
        @group(1) @binding(0) var<storage, read> offsets: array<u32>;
        @group(1) @binding(1) var<storage, read> taps: array<Tap>;
        @group(1) @binding(2) var<storage, read> anchors: array<vec4<f32>>;
        @group(1) @binding(3) var<storage, read> inverse_diagonal: array<f32>;
        @group(1) @binding(4) var<storage, read_write> q: array<vec4<f32>>;

        fn update(i: u32) {
            let at = q[i].xyz;
            var sum = anchors[i].w * (anchors[i].xyz - at);
            for (var k = offsets[i]; k < offsets[i + 1u]; k++) {
                let tap = taps[k];
                let d = q[tap.column].xyz - at;
                let squared = d.x * d.x + d.y * d.y + d.z * d.z;
                sum += d * (tap.weight - tap.pull / sqrt(max(squared, 1e-36)));
            }
            q[i] = vec4(at + params.omega * inverse_diagonal[i] * sum, 0.0);
        }"];
    type Uniform = f32;
    type Inputs = (u32, Tap, [f32; 4], f32);
}

impl Update for Relax {
    type State = [f32; 4];

    fn update(
        i: u32,
        omega: &f32,
        (offsets, taps, anchors, inverse_diagonal): HostViews<'_, Self>,
        q: &[[f32; 4]],
    ) -> [f32; 4] {
        let [x, y, z, _] = q[i as usize];
        let [ax, ay, az, weight] = anchors[i as usize];
        let mut sum = [weight * (ax - x), weight * (ay - y), weight * (az - z)];
        for tap in &taps[offsets[i as usize] as usize..offsets[i as usize + 1] as usize] {
            let [u, v, w, _] = q[tap.column as usize];
            let d = [u - x, v - y, w - z];
            let squared = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
            let weight = tap.weight - tap.pull / squared.max(1e-36).sqrt();
            (0..3).for_each(|axis| sum[axis] += d[axis] * weight);
        }
        let step = omega * inverse_diagonal[i as usize];
        [x + step * sum[0], y + step * sum[1], z + step * sum[2], 0.0]
    }
}

/// The members of one color.
#[derive(Debug)]
struct OfColor;

impl Kernel for OfColor {
    const NAME: &'static str = "of_color";
    const WGSL: &'static [&'static str] = &["
        @group(0) @binding(3) var<uniform> params: vec4<u32>;
        @group(1) @binding(0) var<storage, read_write> color: array<u32>;
        fn select_element(v: u32) -> bool { return color[v] == params.x; }"];
    type Uniform = [u32; 4];
    type Inputs = ();
}

impl Select for OfColor {
    type Output = u32;

    fn select(_: u32, wanted: &[u32; 4], (): HostViews<'_, Self>, color: &mut u32) -> bool {
        *color == wanted[0]
    }
}

/// Positions of a crumpled cloth after some sweeps.
fn relaxed<B: Backend>(backend: &B, width: usize, n_sweeps: u32) -> Result<Vec<[f32; 4]>, B::Error> {
    let graph = regular_hinge_cloth(width, width);
    let coloring = color(&graph);
    let n = graph.n_vertices();
    let mut random = Random::new(5);
    let mut unit = || f32::from(u16::try_from(random.below(1 << 16)).expect("below 2^16")) / 65536.0;
    let mut taps = Vec::new();
    let (mut anchors, mut inverse_diagonal, mut positions) = (Vec::new(), Vec::new(), Vec::new());
    for v in (0..).take(n) {
        let mut diagonal = 50.0;
        for (k, &column) in graph.neighbors(v).iter().enumerate() {
            let (weight, pull) = if k % 2 == 0 { (100.0, 1.0) } else { (1.0, 0.0) };
            taps.push(Tap { column, weight, pull });
            diagonal += weight;
        }
        inverse_diagonal.push(1.0 / diagonal);
        anchors.push([unit(), unit(), unit(), 50.0]);
        positions.push([unit(), unit(), unit(), 0.0]);
    }
    let offsets = backend.upload(graph.csr().offsets());
    let (taps, anchors) = (backend.upload(&taps), backend.upload(&anchors));
    let (inverse_diagonal, mut q) = (backend.upload(&inverse_diagonal), backend.upload(&positions));
    let mut colors = backend.upload(coloring.colors());
    let mut rest = backend.all(n);
    let classes: Vec<B::List> = (0..coloring.n_colors())
        .map(|c| backend.select::<OfColor>(&mut rest, &[c, 0, 0, 0], (), &mut colors))
        .collect();
    for _ in 0..n_sweeps {
        for class in &classes {
            let inputs = (
                backend.view(&offsets),
                backend.view(&taps),
                backend.view(&anchors),
                backend.view(&inverse_diagonal),
            );
            backend.update::<Relax>(class, &1.5, inputs, &mut q);
        }
    }
    backend.read(q)
}

/// Distance in representable numbers.
fn ulps(a: f32, b: f32) -> u64 {
    let ordered = |x: f32| {
        let bits = i64::from(x.to_bits() & 0x7fff_ffff);
        if x.is_sign_negative() { -bits } else { bits }
    };
    ordered(a).abs_diff(ordered(b))
}

/// A software adapter computes as the CPU does. A GPU may fuse multiplications with additions, which saves a rounding each: some
/// units in the last place of coordinates of 0 to 1.
#[test]
fn positions_agree() {
    let gpu = gpu();
    let on_gpu = relaxed(&gpu, 40, 10).unwrap();
    let Ok(on_cpu) = relaxed(&Cpu::new(), 40, 10);
    let pairs = || on_gpu.iter().flatten().zip(on_cpu.iter().flatten());
    if gpu.is_software() {
        let most = pairs().map(|(&a, &b)| ulps(a, b)).max();
        assert_eq!(most, Some(0));
    }
    let farthest = pairs().map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    assert!(farthest < 1e-5, "{farthest} m apart");
    assert!(on_cpu.iter().flatten().all(|x| x.is_finite()));
}
