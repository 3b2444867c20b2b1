//! A run of each kernel over any backend, on arrays with sentinels past their end and lists with gaps.

use vivace_graph::ConstraintGraph;
use vivace_kernels::coloring::{
    AcceptColor, AcceptColorUniform, ColorInstead, DegreeWeight, FirstFit, IsColored, LacksColor,
    LacksColorUniform, LeaveNeighbors, LocalMaximum, LocalMaximumUniform, NeighborHasColor,
    NeighborHasColorUniform, ProposeColor, ProposeColorUniform, RandomWeight, RandomWeightUniform, SetValue,
    SetValueUniform, TakeColor, TakeColorUniform, UNCOLORED,
};
use vivace_kernels::{Backend, HostViews, Kernel, Select, pcg};
use vivace_tests::generators::random;
use vivace_tests::random::Random;

/// What stands past the end of each array that is written.
const SENTINEL: u32 = 0xdead_beef;
const N_SENTINELS: usize = 300;

/// A graph and arrays for its vertices.
pub(crate) struct Data {
    pub(crate) n: u32,
    graph: ConstraintGraph,
    /// Small, and sometimes none.
    colors: Vec<u32>,
    /// Small, so that many are equal; sometimes 0.
    weights: Vec<u32>,
    /// Vertices, and sometimes none.
    vertices: Vec<u32>,
    key: u32,
}

impl Data {
    pub(crate) fn new(n: u32, seed: u64) -> Self {
        let mut random_numbers = Random::new(seed);
        let graph = random(n, 3 * n as usize, seed);
        let mut array = |below: u32, rarely: u32| -> Vec<u32> {
            let value = |_| {
                if random_numbers.below(4) == 0 { rarely } else { random_numbers.below(below.max(1)) }
            };
            (0..n).map(value).collect()
        };
        let (colors, weights, vertices) = (array(70, UNCOLORED), array(5, 0), array(n, UNCOLORED));
        Self { n, graph, colors, weights, vertices, key: pcg::key(seed, n) }
    }
}

/// What a run leaves: the whole array that it wrote, and the lists that it made.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Left {
    pub(crate) array: Vec<u32>,
    pub(crate) lists: Vec<Vec<u32>>,
}

/// Three of four vertices, by hash.
#[derive(Debug)]
struct Sample;

impl Kernel for Sample {
    const NAME: &'static str = "sample";
    const WGSL: &'static [&'static str] = &[
        pcg::WGSL,
        "struct Params { key: u32 }
         @group(0) @binding(3) var<uniform> params: Params;
         @group(1) @binding(0) var<storage, read_write> own: array<u32>;
         fn select_element(v: u32) -> bool {
             own[v] = own[v] + 1u;
             return (hash(v, params.key) & 3u) != 0u;
         }",
    ];
    type Uniform = u32;
    type Inputs = ();
}

impl Select for Sample {
    type Output = u32;

    fn select(v: u32, key: &u32, (): HostViews<'_, Self>, own: &mut u32) -> bool {
        *own = own.wrapping_add(1);
        pcg::hash(v, *key) & 3 != 0
    }
}

/// An array with sentinels past its end.
fn guarded<B: Backend>(backend: &B, values: &[u32]) -> B::Buffer<u32> {
    backend.upload(&[values, &[SENTINEL; N_SENTINELS]].concat())
}

fn sentinels<B: Backend>(backend: &B, data: &Data) -> B::Buffer<u32> {
    backend.filled(data.n as usize + N_SENTINELS, SENTINEL)
}

/// Three of four vertices.
fn sample<B: Backend>(backend: &B, data: &Data) -> B::List {
    sample_of(backend, data.n as usize, data.key)
}

/// Three of four indices below `n`.
pub(crate) fn sample_of<B: Backend>(backend: &B, n: usize, key: u32) -> B::List {
    let mut all = backend.all(n);
    let mut own = backend.filled(n, 0);
    backend.select::<Sample>(&mut all, &key, (), &mut own)
}

/// The graph on a backend.
struct Csr<B: Backend>(B::Buffer<u32>, B::Buffer<u32>);

impl<B: Backend> Csr<B> {
    fn new(backend: &B, data: &Data) -> Self {
        let csr = data.graph.csr();
        Self(backend.upload(csr.offsets()), backend.upload(csr.items()))
    }
}

fn left<B: Backend>(backend: &B, array: B::Buffer<u32>, lists: &[B::List]) -> Result<Left, B::Error> {
    let lists = lists.iter().map(|list| backend.indices(list)).collect::<Result<_, _>>()?;
    Ok(Left { array: backend.read(array)?, lists })
}

pub(crate) fn sample_and_the_rest<B: Backend>(backend: &B, data: &Data) -> Result<Left, B::Error> {
    let mut own = sentinels(backend, data);
    let mut list = backend.all(data.n as usize);
    let all = list.clone();
    let first = backend.select::<Sample>(&mut list, &data.key, (), &mut own);
    let mut rest = first.clone();
    let second = backend.select::<Sample>(&mut rest, &(data.key + 1), (), &mut own);
    left(backend, own, &[all, list, first, rest, second])
}

pub(crate) fn set_value<B: Backend>(backend: &B, data: &Data) -> Result<Left, B::Error> {
    let (list, mut own) = (sample(backend, data), sentinels(backend, data));
    backend.map::<SetValue>(&list, &SetValueUniform { value: data.key }, (), &mut own);
    left(backend, own, &[list])
}

pub(crate) fn random_weight<B: Backend>(backend: &B, data: &Data) -> Result<Left, B::Error> {
    let (list, mut weight) = (sample(backend, data), sentinels(backend, data));
    backend.map::<RandomWeight>(&list, &RandomWeightUniform { key: data.key }, (), &mut weight);
    left(backend, weight, &[list])
}

pub(crate) fn degree_weight<B: Backend>(backend: &B, data: &Data) -> Result<Left, B::Error> {
    let (list, mut weight, csr) = (sample(backend, data), sentinels(backend, data), Csr::new(backend, data));
    backend.map::<DegreeWeight>(&list, &(), (backend.view(&csr.0),), &mut weight);
    left(backend, weight, &[list])
}

pub(crate) fn propose_color<B: Backend>(backend: &B, data: &Data) -> Result<Left, B::Error> {
    let (list, mut proposal, csr) =
        (sample(backend, data), sentinels(backend, data), Csr::new(backend, data));
    let colors = backend.upload(&data.colors);
    let inputs = (backend.view(&csr.0), backend.view(&csr.1), backend.view(&colors));
    for (shrink_q8, palette_cap) in [(640, 7), (256, u32::MAX), (1 << 24, 3)] {
        let uniform = ProposeColorUniform { key: data.key, shrink_q8, palette_cap };
        // Different elements in each run, so that none hides another.
        let mut part = list.clone();
        let mut own = backend.filled(data.n as usize, 0);
        let part = backend.select::<Sample>(&mut part, &(data.key ^ shrink_q8), (), &mut own);
        backend.map::<ProposeColor>(&part, &uniform, inputs, &mut proposal);
    }
    left(backend, proposal, &[list])
}

pub(crate) fn accept_color<B: Backend>(backend: &B, data: &Data) -> Result<Left, B::Error> {
    let csr = Csr::new(backend, data);
    let (proposal, mut color) = (backend.upload(&data.weights), sentinels(backend, data));
    let inputs = (backend.view(&csr.0), backend.view(&csr.1), backend.view(&proposal));
    let mut lists = Vec::new();
    for rule in 0..3 {
        let mut list = sample(backend, data);
        let uniform = AcceptColorUniform { key: data.key, rule };
        lists.push(backend.select::<AcceptColor>(&mut list, &uniform, inputs, &mut color));
        lists.push(list);
    }
    left(backend, color, &lists)
}

pub(crate) fn local_maximum<B: Backend>(backend: &B, data: &Data) -> Result<Left, B::Error> {
    let (mut list, csr) = (sample(backend, data), Csr::new(backend, data));
    let (weight, mut lost_to) = (backend.upload(&data.weights), guarded(backend, &data.vertices));
    let inputs = (backend.view(&csr.0), backend.view(&csr.1), backend.view(&weight));
    let uniform = LocalMaximumUniform { key: data.key };
    let maxima = backend.select::<LocalMaximum>(&mut list, &uniform, inputs, &mut lost_to);
    left(backend, lost_to, &[list, maxima])
}

pub(crate) fn neighbor_has_color<B: Backend>(backend: &B, data: &Data) -> Result<Left, B::Error> {
    let (mut list, csr) = (sample(backend, data), Csr::new(backend, data));
    let (color, mut weight) = (backend.upload(&data.weights), sentinels(backend, data));
    let inputs = (backend.view(&csr.0), backend.view(&csr.1), backend.view(&color));
    let uniform = NeighborHasColorUniform { color: 3 };
    let selected = backend.select::<NeighborHasColor>(&mut list, &uniform, inputs, &mut weight);
    left(backend, weight, &[list, selected])
}

pub(crate) fn is_colored<B: Backend>(backend: &B, data: &Data) -> Result<Left, B::Error> {
    let (mut list, mut color) = (sample(backend, data), guarded(backend, &data.colors));
    let selected = backend.select::<IsColored>(&mut list, &(), (), &mut color);
    left(backend, color, &[list, selected])
}

/// An independent set: what may be updated at once.
fn independent<B: Backend>(backend: &B, data: &Data, csr: &Csr<B>) -> B::List {
    let mut list = backend.all(data.n as usize);
    let mut weight = backend.filled(data.n as usize, 0);
    let mut lost_to = backend.filled(data.n as usize, UNCOLORED);
    backend.map::<RandomWeight>(&list, &RandomWeightUniform { key: data.key }, (), &mut weight);
    let inputs = (backend.view(&csr.0), backend.view(&csr.1), backend.view(&weight));
    backend.select::<LocalMaximum>(&mut list, &LocalMaximumUniform { key: 0 }, inputs, &mut lost_to)
}

pub(crate) fn first_fit<B: Backend>(backend: &B, data: &Data) -> Result<Left, B::Error> {
    let (csr, mut color) = (Csr::new(backend, data), guarded(backend, &data.colors));
    let list = independent(backend, data, &csr);
    backend.update::<FirstFit>(&list, &(), (backend.view(&csr.0), backend.view(&csr.1)), &mut color);
    left(backend, color, &[list])
}

pub(crate) fn first_fit_in_order<B: Backend>(backend: &B, data: &Data) -> Result<Left, B::Error> {
    let (list, csr, mut color) =
        (sample(backend, data), Csr::new(backend, data), guarded(backend, &data.colors));
    backend.update_in_order::<FirstFit>(&list, &(), (backend.view(&csr.0), backend.view(&csr.1)), &mut color);
    left(backend, color, &[list])
}

pub(crate) fn take_color<B: Backend>(backend: &B, data: &Data) -> Result<Left, B::Error> {
    let (list, csr, mut color) =
        (sample(backend, data), Csr::new(backend, data), guarded(backend, &data.weights));
    let inputs = (backend.view(&csr.0), backend.view(&csr.1));
    backend.update_in_order::<TakeColor>(&list, &TakeColorUniform { color: 3 }, inputs, &mut color);
    left(backend, color, &[list])
}

/// Weights are small, so that many counters meet 0.
pub(crate) fn leave_neighbors<B: Backend>(backend: &B, data: &Data) -> Result<Left, B::Error> {
    let (list, csr, mut weight) =
        (sample(backend, data), Csr::new(backend, data), guarded(backend, &data.weights));
    let inputs = (backend.view(&csr.0), backend.view(&csr.1));
    backend.count_down::<LeaveNeighbors>(&list, &(), inputs, &mut weight);
    left(backend, weight, &[list])
}

/// Values of one word, of three and of sixteen.
pub(crate) fn filled<B: Backend>(backend: &B, data: &Data) -> Result<Left, B::Error> {
    let n = data.n as usize;
    let words: [u32; 16] = std::array::from_fn(|k| pcg::hash(data.key, 1 << k));
    let mut array = backend.read(backend.filled(n, data.key))?;
    array.extend(backend.read(backend.filled(n, [data.key, 2, 3]))?.into_iter().flatten());
    array.extend(backend.read(backend.filled(n, words))?.into_iter().flatten());
    Ok(Left { array, lists: vec![backend.indices(&backend.all(n))?] })
}

/// Ranges in place of lists: some that do not begin at 0, an empty one; mapped over, taken apart, one after another. Arrays written in part
/// and read in part.
pub(crate) fn ranges<B: Backend>(backend: &B, data: &Data) -> Result<Left, B::Error> {
    let (third, csr) = (data.n / 3, Csr::new(backend, data));
    let mut color = guarded(backend, &data.colors);
    backend.write(&mut color, &data.weights[third as usize..]);
    let (mut start, middle, none) =
        (backend.range(third / 4..third), backend.range(third..data.n), backend.range(third..third));
    for (list, value) in [(&none, 7), (&middle, 3)] {
        backend.map::<SetValue>(list, &SetValueUniform { value }, (), &mut color);
    }
    let inputs = (backend.view(&csr.0), backend.view(&csr.1));
    let small = backend.range(third / 2..(third / 2 + 9).min(data.n));
    backend.update_in_order::<TakeColor>(&small, &TakeColorUniform { color: 3 }, inputs, &mut color);
    let selected = backend.select::<Sample>(&mut start, &data.key, (), &mut color);
    let mut fetched = vec![0; third as usize + 1];
    backend.fetch(&color, &mut fetched)?;
    let mut left = left(backend, color, &[start, middle, none, small, selected])?;
    left.array.extend(fetched);
    Ok(left)
}

/// Vertices by color, some without; and what a run, a select and a row of lists make of such lists, which do not begin at 0.
pub(crate) fn grouped<B: Backend>(backend: &B, data: &Data) -> Result<Left, B::Error> {
    let colors: Vec<u32> = data.colors.iter().map(|&color| color % 67).collect();
    let keys = backend.upload(&colors);
    let (mut own, mut lists) = (sentinels(backend, data), Vec::new());
    for n_keys in [1, 5, vivace_kernels::MOST_KEYS] {
        let mut grouped = backend.group_by(&keys, n_keys);
        for (value, list) in (0..).zip(&grouped) {
            backend.map::<SetValue>(list, &SetValueUniform { value }, (), &mut own);
        }
        let selected = grouped.iter_mut().step_by(3);
        lists.extend(selected.map(|list| backend.select::<Sample>(list, &data.key, (), &mut own)));
        lists.extend(grouped);
    }
    left(backend, own, &lists)
}

pub(crate) fn lacks_color<B: Backend>(backend: &B, data: &Data) -> Result<Left, B::Error> {
    let list = sample(backend, data);
    let (colors, mut counters) = (backend.upload(&data.colors), backend.filled(1 + N_SENTINELS, SENTINEL));
    let uniform = LacksColorUniform { n_colors: 60 };
    backend.count_down::<LacksColor>(&list, &uniform, (backend.view(&colors),), &mut counters);
    left(backend, counters, &[list])
}

pub(crate) fn color_instead<B: Backend>(backend: &B, data: &Data) -> Result<Left, B::Error> {
    let (list, mut color) = (sample(backend, data), guarded(backend, &data.colors));
    let [down, up] = [0, 1].map(|counter| backend.upload(&[counter]));
    let [weights, vertices] = [&data.weights, &data.vertices].map(|instead| backend.upload(instead));
    backend.map::<ColorInstead>(&list, &(), (backend.view(&down), backend.view(&weights)), &mut color);
    backend.map::<ColorInstead>(&list, &(), (backend.view(&up), backend.view(&vertices)), &mut color);
    left(backend, color, &[list])
}

/// All vertices alike, of which some have colors.
pub(crate) fn accept_color_of_all<B: Backend>(backend: &B, data: &Data) -> Result<Left, B::Error> {
    let (list, csr) = (sample(backend, data), Csr::new(backend, data));
    let (proposal, mut color) = (backend.upload(&data.weights), guarded(backend, &data.colors));
    let inputs = (backend.view(&csr.0), backend.view(&csr.1), backend.view(&proposal));
    let uniform = AcceptColorUniform { key: data.key, rule: 0 };
    backend.map::<AcceptColor>(&list, &uniform, inputs, &mut color);
    left(backend, color, &[list])
}
