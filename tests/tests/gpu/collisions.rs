//! Every kernel of collisions, and the forms that they alone have, on both backends: sheets that fly through one another, lists with gaps,
//! sentinels past the end of what is written.

use bytemuck::{Pod, Zeroable};
use glam::{UVec3, Vec3, Vec4};
use vivace_cpu::Cpu;
use vivace_gpu::Grids;
use vivace_kernels::Backend;
use vivace_kernels::collision::{
    Bound, BoundUniform, CHILDREN, ClaimColor, ClaimColorUniform, ClaimUniform, Contact, ContactDepth,
    ContactEnergy, ContactEnergyUniform, Deepest, DrawColor, Drift, DriftUniform, FindValue,
    FindValueUniform, Hit, HitUniform, Hold, HoldUniform, KeepOut, KeepThin, LEVELS, Meet, MeetSolid,
    MeetUniform, N_COLORS, NO_COLOR, Push, PushUniform, ReleaseColor, SHADERS, SettleColor, Shorten,
    ShortenUniform, Solid, SolidShape, SweptBox, SweptBoxUniform, Thin, Touch, TouchUniform,
};
use vivace_tests::naive::Naive;
use vivace_tests::random::Random;

use crate::cases::sample_of;
use crate::gpu;

const SENTINEL: u32 = 0x7f7f_7f7f;
const N_SENTINELS: usize = 70;
const KEY: u32 = 77;

/// Sheets of `n` × `n` particles.
struct Data {
    primitives: Vec<[u32; 4]>,
    n_triangles: u32,
    n_edges: u32,
    n_vertices: u32,
    rest: Vec<Vec4>,
    from: Vec<Vec4>,
    to: Vec<Vec4>,
    mobility: Vec<f32>,
    solids: Vec<Solid>,
    values: Vec<f32>,
    /// What earlier kernels leave, so that each is compared on the same.
    boxes: Vec<[Vec4; 2]>,
    pairs: Vec<[u32; 4]>,
    contacts: Vec<Contact>,
    drawn: Vec<u32>,
    entries: Vec<u32>,
    colors: Vec<u32>,
    lambdas: Vec<Vec4>,
    parts: Vec<u32>,
}

/// What a kernel leaves: words that have to be equal, and numbers that differ by no more than a bound.
#[derive(Debug, Clone, PartialEq)]
struct Left {
    kernel: &'static str,
    words: Vec<u32>,
    numbers: Vec<f32>,
    bound: f32,
}

impl Left {
    fn words<T: Pod>(kernel: &'static str, words: &[T]) -> Self {
        Self { kernel, words: bytemuck::cast_slice(words).to_vec(), numbers: Vec::new(), bound: 0.0 }
    }

    fn numbers<T: Pod>(kernel: &'static str, numbers: &[T], bound: f32) -> Self {
        Self { kernel, words: Vec::new(), numbers: bytemuck::cast_slice(numbers).to_vec(), bound }
    }

    fn contacts(kernel: &'static str, contacts: &[Contact], bound: f32) -> Self {
        let of = |c: &Contact| [c.particles.as_slice(), &[c.free]].concat();
        let numbers = |c: &Contact| {
            let vectors = [c.origin, c.normal, c.start].map(|v: Vec3| v.to_array()).concat();
            let rest = [c.distance, c.friction];
            [c.weights.to_array().as_slice(), &vectors, &rest].concat()
        };
        Self {
            kernel,
            words: contacts.iter().flat_map(of).collect(),
            numbers: contacts.iter().flat_map(numbers).collect(),
            bound,
        }
    }

    /// Where two differ.
    fn difference(&self, other: &Self) -> Option<String> {
        let words = self.words.iter().zip(&other.words).position(|(a, b)| a != b);
        let is_far = |(a, b): (&f32, &f32)| {
            let same = a.to_bits() == b.to_bits() || (a - b).abs() <= self.bound * (1.0 + a.abs());
            !same
        };
        let numbers = self.numbers.iter().zip(&other.numbers).position(is_far);
        let sizes = (self.words.len(), self.numbers.len()) != (other.words.len(), other.numbers.len());
        let place = words.map(|k| format!("word {k}: {} or {}", self.words[k], other.words[k]));
        let place = place
            .or_else(|| numbers.map(|k| format!("number {k}: {} or {}", self.numbers[k], other.numbers[k])))
            .or_else(|| sizes.then(|| format!("{} or {} words", self.words.len(), other.words.len())));
        place.map(|place| format!("{}: {place}", self.kernel))
    }
}

#[expect(clippy::cast_possible_truncation, reason = "any number will do")]
fn signed(random: &mut Random) -> f32 {
    random.unit() as f32 * 2.0 - 1.0
}

impl Data {
    fn new(n: u32, n_sheets: u32) -> Self {
        let mut random = Random::new(u64::from(n) + 11);
        let (mut triangles, mut edges) = (Vec::new(), Vec::new());
        let (mut rest, mut from, mut to) = (Vec::new(), Vec::new(), Vec::new());
        for sheet in 0..n_sheets {
            let first = sheet * n * n;
            for k in 0..n * n {
                let (x, y) = (k % n, k / n);
                let flat = Vec3::new(x as f32, 0.0, y as f32) * 0.1;
                let rough = Vec3::new(signed(&mut random), signed(&mut random), signed(&mut random));
                let at = flat + Vec3::Y * (0.06 * sheet as f32) + rough * 0.012;
                let way = Vec3::new(0.05, -0.11 * sheet as f32, 0.02) + rough * 0.03;
                // A few are pinned.
                let inverse_mass = if random.below(9) == 0 { 0.0 } else { 1.0 + random.below(3) as f32 };
                rest.push((flat + Vec3::Y * sheet as f32).extend(0.0));
                from.push(at.extend(inverse_mass));
                to.push((at + if inverse_mass > 0.0 { way } else { Vec3::ZERO }).extend(inverse_mass));
                let v = first + k;
                if x + 1 < n {
                    edges.push([v, v + 1]);
                }
                if y + 1 < n {
                    edges.push([v, v + n]);
                }
                if x + 1 < n && y + 1 < n {
                    edges.push([v + 1, v + n]);
                    triangles.extend([[v, v + 1, v + n], [v + 1, v + n + 1, v + n]]);
                }
            }
        }
        let count = |n: usize| u32::try_from(n).expect("few");
        let (n_triangles, n_edges, n_vertices) =
            (count(triangles.len()), count(edges.len()), count(from.len()));
        let primitives = (triangles.iter().map(|&[a, b, c]| [a, b, c, c]))
            .chain(edges.iter().map(|&[a, b]| [a, b, b, b]))
            .chain((0..n_vertices).map(|v| [v; 4]));
        let solid = |shape: SolidShape, size: Vec3, k: f32| Solid {
            rotations: [Vec4::W, Vec4::new(0.0, 0.6, 0.0, 0.8)],
            from: Vec3::new(0.2, -0.02 * k, 0.3),
            shape: shape as u32,
            to: Vec3::new(0.25, 0.01 * k, 0.3),
            friction: 0.3,
            size,
            slope: 1.5,
            min: Vec3::splat(-0.35),
            spacing: 0.1,
            nodes: UVec3::splat(8),
            slides: 1,
            distance: 0.02,
            margin: 0.03,
            padding: [0; 2],
        };
        let node = |k: u32| Vec3::new((k % 8) as f32, (k / 8 % 8) as f32, (k / 64) as f32) * 0.1 - 0.35;
        let mut data = Self {
            primitives: primitives.collect(),
            n_triangles,
            n_edges,
            n_vertices,
            mobility: from.iter().map(|v: &Vec4| 0.5 * v.w).collect(),
            rest,
            from,
            to,
            solids: vec![
                solid(SolidShape::Plane, Vec3::ZERO, 1.0),
                solid(SolidShape::Sphere, Vec3::splat(0.15), 0.0),
                solid(SolidShape::Capsule, Vec3::new(0.1, 0.05, 0.0), 2.0),
                solid(SolidShape::Cuboid, Vec3::new(0.2, 0.05, 0.1), 0.0),
                solid(SolidShape::Field, Vec3::ZERO, 1.0),
            ],
            values: (0..512).map(|k| node(k).length() - 0.2).collect(),
            boxes: Vec::new(),
            pairs: Vec::new(),
            contacts: Vec::new(),
            drawn: Vec::new(),
            entries: Vec::new(),
            colors: Vec::new(),
            lambdas: Vec::new(),
            parts: Vec::new(),
        };
        data.fill();
        data
    }

    /// Each kernel's input, from those before it on the CPU.
    fn fill(&mut self) {
        let cpu = Cpu::serial();
        let Ok(boxes) = boxes(&cpu, self);
        self.boxes = boxes;
        let Ok((pairs, _)) = pairs(&cpu, self, 100_000);
        self.pairs = pairs;
        let Ok((contacts, _)) = contacts(&cpu, self, 100_000);
        self.contacts = contacts;
        let Ok(colored) = colored(&cpu, self, 12);
        [self.drawn, self.entries, self.colors] = colored;
        let lambda = |k: usize| Vec4::new(0.01, -0.02, 0.005, (k % 3) as f32 * 0.01);
        self.lambdas = (0..self.contacts.len()).map(lambda).collect();
        let part = |k: usize| if k.is_multiple_of(3) { u32::MAX } else { (0.25 * (k % 4) as f32).to_bits() };
        self.parts = (0..self.from.len()).map(part).chain([0]).collect();
    }

    fn levels(&self) -> ([[u32; LEVELS]; 2], Vec<BoundUniform>, u32) {
        let (mut bounds, mut end) = (Vec::new(), self.n_triangles + self.n_edges + self.n_vertices);
        let levels = [(0, self.n_triangles), (self.n_triangles, self.n_edges)].map(|(mut first, mut n)| {
            let mut levels = [first; LEVELS];
            for level in &mut levels[1..] {
                if n > 1 {
                    bounds.push(BoundUniform { first: end, first_child: first, n_children: n });
                    (first, n) = (end, n.div_ceil(CHILDREN));
                    end += n;
                }
                *level = first;
            }
            levels
        });
        (levels, bounds, end)
    }

    fn n_leaves(&self) -> u32 {
        self.n_triangles + self.n_edges + self.n_vertices
    }
}

fn guarded<B: Backend, T: Pod + Send + Sync>(backend: &B, values: &[T]) -> B::Buffer<T> {
    backend.upload(&[values, &[sentinel(); N_SENTINELS]].concat())
}

fn sentinel<T: Pod>() -> T {
    let mut value = T::zeroed();
    bytemuck::bytes_of_mut(&mut value).fill(SENTINEL.to_le_bytes()[0]);
    value
}

fn drift<B: Backend>(backend: &B, data: &Data) -> B::Buffer<Vec4> {
    let (primitives, from, to) =
        (backend.upload(&data.primitives), backend.upload(&data.from), backend.upload(&data.to));
    let mut drift = guarded(backend, &[Vec4::ZERO]);
    let uniform = DriftUniform { first: data.n_triangles + data.n_edges, n: data.n_vertices };
    let inputs = (backend.view(&primitives), backend.view(&from), backend.view(&to));
    backend.map::<Drift>(&backend.range(0..1), &uniform, inputs, &mut drift);
    drift
}

fn boxes<B: Backend>(backend: &B, data: &Data) -> Result<Vec<[Vec4; 2]>, B::Error> {
    let (primitives, from, to) =
        (backend.upload(&data.primitives), backend.upload(&data.from), backend.upload(&data.to));
    let (_, bounds, n_boxes) = data.levels();
    let drift = drift(backend, data);
    let mut boxes = guarded(backend, &vec![[Vec4::ZERO; 2]; n_boxes as usize]);
    let inputs = (backend.view(&primitives), backend.view(&from), backend.view(&to), backend.view(&drift));
    let uniform = SweptBoxUniform { margin: 0.02 };
    backend.map::<SweptBox>(&backend.range(0..data.n_leaves()), &uniform, inputs, &mut boxes);
    for bound in &bounds {
        let level = backend.range(bound.first..bound.first + bound.n_children.div_ceil(CHILDREN));
        backend.update::<Bound>(&level, bound, (), &mut boxes);
    }
    backend.read(boxes)
}

type Found<T> = (Vec<T>, [u32; 2]);

/// What was found, up to `room`, and how many have room and have none.
fn pairs<B: Backend>(backend: &B, data: &Data, room: usize) -> Result<Found<[u32; 4]>, B::Error> {
    let (primitives, boxes) = (backend.upload(&data.primitives), backend.upload(&data.boxes));
    let (levels, ..) = data.levels();
    let uniform =
        MeetUniform { n_triangles: data.n_triangles, n_edges: data.n_edges, padding: [0; 2], levels };
    let mut pairs = guarded(backend, &vec![sentinel(); room - N_SENTINELS]);
    let mut counts = guarded(backend, &[3, 1]);
    let queries = backend.range(data.n_triangles..data.n_leaves());
    let inputs = (backend.view(&primitives), backend.view(&boxes));
    let list = backend.expand::<Meet>(&queries, &uniform, inputs, &mut pairs, &mut counts);
    let (mut all, counts) = (backend.read(pairs)?, backend.read(counts)?);
    let found = backend.indices(&list)?;
    assert_eq!(found, (0..counts[0] - 3).collect::<Vec<_>>(), "the list of what was found");
    assert!(all[found.len()..].iter().all(|pair| *pair == sentinel::<[u32; 4]>()), "written past the end");
    all.truncate(found.len());
    Ok((all, [counts[0], counts[1]]))
}

fn contacts<B: Backend>(backend: &B, data: &Data, room: usize) -> Result<Found<Contact>, B::Error> {
    let (pairs, rest) = (backend.upload(&data.pairs), backend.upload(&data.rest));
    let (from, to) = (backend.upload(&data.from), backend.upload(&data.to));
    let list = sample_of(backend, data.pairs.len(), KEY);
    let uniform = TouchUniform { thickness: 0.02, margin: 0.02, friction: 0.4, every_pair: 0 };
    let mut contacts = backend.upload(&vec![Contact::zeroed(); room]);
    let mut counts = backend.filled(2, 0);
    let inputs = (backend.view(&pairs), backend.view(&rest), backend.view(&from), backend.view(&to));
    backend.expand::<Touch>(&list, &uniform, inputs, &mut contacts, &mut counts);
    let (mut all, counts) = (backend.read(contacts)?, backend.read(counts)?);
    all.truncate(counts[0] as usize);
    Ok((all, [counts[0], counts[1]]))
}

/// Colors drawn in the last of some rounds, entries, colors.
fn colored<B: Backend>(backend: &B, data: &Data, n_rounds: u32) -> Result<[Vec<u32>; 3], B::Error> {
    let n = data.contacts.len();
    let contacts = backend.upload(&data.contacts);
    let n_entries = (8 * n.max(1)).next_power_of_two();
    let mask = u32::try_from(n_entries).expect("few") - 1;
    let mut entries = guarded(backend, &vec![u32::MAX; n_entries]);
    let mut drawn = guarded(backend, &vec![NO_COLOR; n]);
    let mut colors = guarded(backend, &vec![NO_COLOR; n]);
    let mut left = sample_of(backend, n, KEY);
    for key in 0..n_rounds {
        let uniform = ClaimUniform { key, mask };
        let inputs = (backend.view(&contacts), backend.view(&entries));
        backend.map::<DrawColor>(&left, &uniform, inputs, &mut drawn);
        let claim = ClaimColorUniform { key, mask, is_settled: 0 };
        let inputs = (backend.view(&contacts), backend.view(&drawn));
        backend.lower::<ClaimColor, 4>(&left, &claim, inputs, &mut entries);
        let inputs = (backend.view(&contacts), backend.view(&drawn), backend.view(&entries));
        let settled = backend.select::<SettleColor>(&mut left, &uniform, inputs, &mut colors);
        let inputs = (backend.view(&contacts), backend.view(&drawn));
        let claim = ClaimColorUniform { is_settled: 1, ..claim };
        backend.lower::<ClaimColor, 4>(&settled, &claim, inputs, &mut entries);
        backend.map::<ReleaseColor>(&backend.range(0..mask + 1), &(), (), &mut entries);
    }
    Ok([backend.read(drawn)?, backend.read(entries)?, backend.read(colors)?])
}

/// Contacts by color.
fn classes<B: Backend>(backend: &B, data: &Data) -> Vec<B::List> {
    backend.group_by(&backend.upload(&data.colors), N_COLORS)
}

/// What every kernel leaves.
fn all<B: Backend>(backend: &B, data: &Data) -> Result<Vec<Left>, B::Error> {
    let mut left = vec![
        Left::words("drift", &backend.read(drift(backend, data))?),
        Left::words("swept_box", &boxes(backend, data)?),
        Left::words("bound", &boxes(backend, data)?),
    ];
    // Room for all, for some, for none.
    for room in [data.pairs.len() + 200, data.pairs.len() / 2 + N_SENTINELS, N_SENTINELS] {
        let (found, counts) = pairs(backend, data, room)?;
        left.extend([Left::words("meet", &found), Left::words("meet", &counts)]);
    }
    for room in [data.contacts.len() + 9, data.contacts.len() / 2] {
        let (found, counts) = contacts(backend, data, room)?;
        left.extend([Left::contacts("touch", &found, 2e-4), Left::words("touch", &counts)]);
    }
    for n_rounds in [1, 3, 12] {
        let [drawn, entries, colors] = colored(backend, data, n_rounds)?;
        left.extend([
            Left::words("draw_color", &drawn),
            Left::words("claim_color", &entries),
            Left::words("release_color", &entries),
            Left::words("settle_color", &colors),
        ]);
    }
    for list in &classes(backend, data) {
        left.push(Left::words("group_by", &backend.indices(list)?));
    }
    left.extend(thin(backend, data)?);

    let contacts = backend.upload(&data.contacts);
    let list = sample_of(backend, data.contacts.len(), KEY);
    let mobility = backend.upload(&data.mobility);
    let (mut q, mut forces) = (guarded(backend, &data.to), guarded(backend, &data.from));
    let mut lambdas = guarded(backend, &data.lambdas);
    for class in classes(backend, data) {
        let uniform = HoldUniform { compliance: 0.1 };
        let inputs = (backend.view(&contacts), backend.view(&mobility));
        backend.scatter::<Hold, 4>(&class, &uniform, inputs, &mut q, &mut lambdas);
        let inputs = (backend.view(&contacts),);
        backend.scatter::<Push, 4>(&class, &PushUniform { scale: 0.5 }, inputs, &mut forces, &mut lambdas);
    }
    let mut numbers = guarded(backend, &vec![0.0_f32; data.contacts.len()]);
    let inputs = (backend.view(&contacts), backend.view(&mobility), backend.view(&q));
    let uniform = ContactEnergyUniform { stiffness: 3.0 };
    backend.map::<ContactEnergy>(&list, &uniform, inputs, &mut numbers);
    left.extend([
        Left::numbers("hold", &backend.read(lambdas)?, 1e-4),
        Left::numbers("push", &backend.read(forces)?, 1e-4),
        Left::numbers("contact_energy", &backend.read(numbers)?, 1e-5),
    ]);
    let mut depths = guarded(backend, &vec![0.0_f32; data.contacts.len()]);
    let at = backend.upload(&data.to);
    backend.map::<ContactDepth>(&list, &(), (backend.view(&contacts), backend.view(&at)), &mut depths);
    let mut deepest = guarded(backend, &[u32::MAX]);
    backend.lower::<Deepest, 1>(&list, &(), (backend.view(&depths),), &mut deepest);
    let turned = backend.read(deepest)?;
    left.extend([
        Left::numbers("hold", &backend.read(q)?, 1e-4),
        Left::numbers("contact_depth", &backend.read(depths)?, 1e-6),
        Left::numbers("deepest", &[f32::from_bits(!turned[0])], 1e-6),
        Left::words("deepest", &turned[1..]),
    ]);
    left.extend(guard(backend, data)?);
    left.extend(solids(backend, data)?);
    Ok(left)
}

/// Which contacts are kept, and how points are held. Distances are rounded: what ties on one backend ties on the other where both begin alike.
fn thin<B: Backend>(backend: &B, data: &Data) -> Result<Vec<Left>, B::Error> {
    let (contacts, to) = (backend.upload(&data.contacts), backend.upload(&data.to));
    let n = data.contacts.len();
    let counts = backend.upload(&[u32::try_from(n).expect("few"), 0]);
    let mut held = guarded(backend, &vec![Vec4::ZERO; data.to.len()]);
    let mut is_kept = guarded(backend, &vec![sentinel::<u32>(); n]);
    let inputs = (backend.view(&contacts), backend.view(&to), backend.view(&counts));
    let mut list = backend.all(n);
    backend.scatter::<Thin, 1>(&list, &(), inputs, &mut held, &mut is_kept);
    let inputs = (backend.view(&contacts), backend.view(&held));
    let kept = backend.select::<KeepThin>(&mut list, &(), inputs, &mut is_kept);
    Ok(vec![
        Left::words("thin", &backend.read(is_kept)?),
        Left::words("thin", &backend.read(held)?),
        Left::words("keep_thin", &backend.indices(&kept)?),
    ])
}

fn guard<B: Backend>(backend: &B, data: &Data) -> Result<Vec<Left>, B::Error> {
    let mut left = Vec::new();
    let n = data.n_vertices;
    let (from, to, pairs) =
        (backend.upload(&data.from), backend.upload(&data.to), backend.upload(&data.pairs));
    for stays in [0, 1] {
        let list = sample_of(backend, data.pairs.len(), KEY);
        let mut parts = guarded(backend, &vec![u32::MAX; 2 * n as usize + 1]);
        let uniform = HitUniform { gap: 0.004, gap_of_start: 0.5, floor: 1e-3, stays, n };
        let inputs = (backend.view(&pairs), backend.view(&from), backend.view(&to));
        backend.lower::<Hit, 9>(&list, &uniform, inputs, &mut parts);
        let parts = backend.read(parts)?;
        let number = |&bits: &u32| if bits == u32::MAX { 2.0 } else { f32::from_bits(bits) };
        let numbers: Vec<f32> = parts[..n as usize].iter().map(number).collect();
        left.extend([Left::numbers("hit", &numbers, 1e-4), Left::words("hit", &parts[n as usize..])]);
    }
    let parts = backend.upload(&data.parts);
    for gives_up in [0, 1] {
        let mut q = guarded(backend, &data.to);
        let mut list = sample_of(backend, n as usize, KEY);
        let inputs = (backend.view(&parts), backend.view(&from));
        let shortened = backend.select::<Shorten>(&mut list, &ShortenUniform { gives_up, n }, inputs, &mut q);
        left.extend([
            Left::numbers("shorten", &backend.read(q)?, 1e-6),
            Left::words("shorten", &backend.indices(&shortened)?),
        ]);
    }
    let mut found = guarded(backend, &[sentinel::<u32>(); 3]);
    let mut counts = backend.filled(2, 0);
    let list = sample_of(backend, data.parts.len(), KEY);
    let uniform = FindValueUniform { value: u32::MAX };
    backend.expand::<FindValue>(&list, &uniform, (backend.view(&parts),), &mut found, &mut counts);
    left.extend([
        Left::words("find_value", &backend.read(found)?),
        Left::words("find_value", &backend.read(counts)?),
    ]);
    Ok(left)
}

fn solids<B: Backend>(backend: &B, data: &Data) -> Result<Vec<Left>, B::Error> {
    let mut left = Vec::new();
    let (from, to, values) =
        (backend.upload(&data.from), backend.upload(&data.to), backend.upload(&data.values));
    for solid in &data.solids {
        let mut list = sample_of(backend, data.n_vertices as usize, KEY);
        let none = vec![Contact::zeroed(); data.n_vertices as usize];
        let mut contacts = backend.upload(&none);
        let inputs = (backend.view(&from), backend.view(&to), backend.view(&values));
        let found = backend.select::<MeetSolid>(&mut list, solid, inputs, &mut contacts);
        left.extend([Left::words("meet_solid", &backend.indices(&found)?)]);
        left.push(Left::contacts("meet_solid", &backend.read(contacts)?, 1e-4));
        for slides in [0, 1] {
            let mut q = guarded(backend, &data.to);
            let inputs = (backend.view(&from), backend.view(&values));
            backend.map::<KeepOut>(&list, &Solid { slides, ..*solid }, inputs, &mut q);
            left.push(Left::numbers("keep_out", &backend.read(q)?, 1e-4));
        }
    }
    Ok(left)
}

/// Sizes around those of groups and levels; many particles and none that meet.
const SIZES: [[u32; 2]; 5] = [[2, 1], [2, 2], [5, 2], [9, 3], [17, 3]];

#[test]
fn every_kernel_does_the_same() {
    for grids in [Grids::Indirect, Grids::Bounds] {
        let gpu = gpu().with_grids(grids);
        for [n, n_sheets] in SIZES {
            let data = Data::new(n, n_sheets);
            let Ok(on_cpu) = all(&Cpu::new(), &data);
            let on_gpu = all(&gpu, &data).unwrap_or_else(|error| panic!("{error}"));
            for (ours, theirs) in on_gpu.iter().zip(&on_cpu) {
                assert_eq!(ours.difference(theirs), None, "{n_sheets} sheets of {n}, {grids:?}");
            }
            for shader in SHADERS {
                assert!(on_cpu.iter().any(|left| left.kernel == shader.name), "no case for {}", shader.name);
            }
            if n > 4 {
                assert!(
                    data.contacts.len() > 20,
                    "{} contacts of {} pairs",
                    data.contacts.len(),
                    data.pairs.len()
                );
            }
        }
    }
}

/// A second backend, which goes through its lists the other way round and refuses what is no gather.
#[test]
fn order_does_not_show() {
    for [n, n_sheets] in SIZES {
        let data = Data::new(n, n_sheets);
        let (Ok(naive), Ok(serial), Ok(parallel)) =
            (all(&Naive::default(), &data), all(&Cpu::serial(), &data), all(&Cpu::new(), &data));
        assert!(naive == serial && serial == parallel, "{n_sheets} sheets of {n}");
    }
}

/// All pairs, by looking at all pairs; and colors that no two contacts of a particle share.
#[test]
fn nothing_is_missed() {
    let data = Data::new(9, 3);
    let meet = |a: usize, b: usize| {
        let ([la, ga], [lb, gb]) = (data.boxes[a], data.boxes[b]);
        (0..3).all(|k| la[k] <= gb[k] && lb[k] <= ga[k])
            && !data.primitives[a].iter().any(|v| data.primitives[b].contains(v))
    };
    let [n_triangles, n_edges] = [data.n_triangles as usize, data.n_edges as usize];
    let mut n = 0;
    for a in n_triangles..n_triangles + n_edges {
        n += (a + 1..n_triangles + n_edges).filter(|&b| meet(a, b)).count();
    }
    for v in n_triangles + n_edges..data.n_leaves() as usize {
        n += (0..n_triangles).filter(|&t| meet(v, t)).count();
    }
    assert_eq!(data.pairs.len(), n);
    let mut seen = std::collections::HashSet::new();
    let colored = data.contacts.iter().zip(&data.colors).filter(|(_, color)| **color != NO_COLOR);
    for (contact, color) in colored {
        for slot in (0..4).filter(|slot| contact.free & (1 << slot) != 0) {
            assert!(seen.insert((contact.particles[slot], *color)), "{contact:?}, {color}");
        }
    }
    let sampled = 3 * data.contacts.len() / 5;
    assert!(seen.len() > 2 * sampled, "{} of {}", seen.len(), data.contacts.len());
}
