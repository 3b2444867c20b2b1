//! Collisions on a device: what `vivace-collision` and both frameworks' contacts do on the host, as runs of kernels.
//!
//! A surface never changes its triangles, so its two trees of boxes keep their shape: primitives are sorted once, body by body and along a
//! curve at rest, and each frame fits the boxes anew. Pairs, contacts and colors are born and stay on the device; the host reads how many
//! there were when a step is reported.
//!
//! Contacts come after all other constraints in an iteration, color by color, those with obstacles first, which share no particle: as
//! constraints of XPBD, in both frameworks. In Projective Dynamics a sweep over the vertices knows nothing of them, and they put right what
//! it did. So contacts change neither graph nor classes of the vertices; what is colored in each frame is their own graph.

mod guard;
mod standing;
mod trees;

use glam::Vec4;
use vivace_collision::{Detector, Obstacle, Options};
use vivace_kernels::collision::{
    Bound, CHILDREN, ClaimColor, ClaimColorUniform, ClaimUniform, ContactDepth, ContactEnergy,
    ContactEnergyUniform, Deepest, DrawColor, Drift, DriftUniform, FindValue, FindValueUniform, HoldUniform,
    KeepThin, Meet, MeetSolid, N_COLORS, NO_COLOR, Push, PushUniform, ReleaseColor, SettleColor, Solid,
    SweptBox, SweptBoxUniform, Thin, Touch, TouchUniform,
};
use vivace_kernels::coloring::{SetValue, SetValueUniform};
use vivace_kernels::step::{ExtrapolateUniform, SetVector, SetVectorUniform, Watch};
use vivace_kernels::{Backend, Params, pcg};

use super::failure;
use super::sums::Sums;
use crate::error::narrow;
use crate::pbd;
use crate::{ContactReport, SolverError};
use standing::{Set, Standing};
use trees::{Trees, bodies, sorted};

/// Pairs for which there is room at first, of a vertex or an edge, and in all at most: what every device binds.
const PAIRS: usize = 32;
const FEWEST_PAIRS: usize = 1 << 12;
const MOST_PAIRS: usize = 1 << 23;
/// Contacts for which there is room, in the same way.
const CONTACTS: usize = 4;
const FEWEST_CONTACTS: usize = 1 << 11;
const MOST_CONTACTS: usize = 1 << 20;
/// What there is more of where something found no room.
const GROWTH: usize = 2;
/// Entries of particles' colors for a contact: four in use by each that is kept, and most are not.
const ENTRIES: usize = 8;
/// Rounds of the coloring with a palette of colors, and palettes at most.
const COLOR_ROUNDS: u32 = 16;
const MOST_PALETTES: u32 = 4;
/// A surface, and what collides with it.
pub(super) struct Collider<B: Backend> {
    options: Options,
    n: u32,
    trees: Trees,
    primitives: B::Buffer<[u32; 4]>,
    boxes: B::Buffer<[Vec4; 2]>,
    rest: B::Buffer<Vec4>,
    drift: B::Buffer<Vec4>,
    no_drift: B::Buffer<Vec4>,
    all: B::List,
    /// In which direction a contact holds each particle, if one does.
    held: B::Buffer<Vec4>,
    /// The particles of the surface, and 0 for each of them.
    particles: B::List,
    is_on_surface: B::Buffer<u32>,
    pairs: B::Buffer<[u32; 4]>,
    n_pairs: usize,
    touching: Set<B>,
    /// Colors drawn, colors, and what particles know of them.
    drawn: B::Buffer<u32>,
    colors: B::Buffer<u32>,
    entries: B::Buffer<u32>,
    n_entries: u32,
    /// How many times [`N_COLORS`] colors there are, and the contacts of each.
    n_palettes: u32,
    classes: Vec<B::List>,
    solids: Vec<Standing<B>>,
    /// By how much multipliers move the particles, by [`Resists`]: inverse masses \[1/kg\], or one over what a vertex resists with \[m/N\].
    mobility: [B::Buffer<f32>; 2],
    parts: B::Buffer<u32>,
    no_items: B::Buffer<u32>,
    counts: Counts<B>,
    /// Pairs and contacts that found no room, and contacts that got no color, as last reported.
    lacking: [usize; 3],
}

/// What a particle resists a contact with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Resists {
    /// Its inertia.
    Inertia,
    /// All that holds it while its neighbors stand still.
    Vertex,
}

/// How many there were, and how many found no room; and turned bits of the largest depth.
struct Counts<B: Backend> {
    pairs: B::Buffer<u32>,
    /// Before others were left out, and after.
    contacts: B::Buffer<u32>,
    kept: B::Buffer<u32>,
    outside: B::Buffer<u32>,
    uncolored: B::Buffer<u32>,
    held: B::Buffer<u32>,
    deepest: B::Buffer<u32>,
}

impl<B: Backend> Collider<B> {
    /// For a system whose particles stand at `place`, where they have these inverse masses \[1/kg\].
    pub(super) fn new(
        backend: &B,
        detector: &Detector,
        place: &[u32],
        inverse_masses: &[f32],
    ) -> Result<Self, SolverError> {
        let (options, rest) = (*detector.options(), detector.rest());
        // A bit of a particle's number tells pairs of edges.
        let n = narrow("particles", 2 * place.len())? / 2;
        let bodies = bodies(detector.triangles(), n);
        let (mut triangles, mut edges) = (Vec::new(), Vec::new());
        if options.self_collision {
            triangles = sorted(detector.triangles(), rest, &bodies);
            edges = sorted(detector.edges(), rest, &bodies);
        }
        let vertices = detector.vertices();
        narrow("primitives of the surface", 2 * (triangles.len() + edges.len() + vertices.len()))?;
        let four = |ids: &[u32]| [0, 1, 2, 3].map(|k: usize| place[ids[k.min(ids.len() - 1)] as usize]);
        let primitives: Vec<[u32; 4]> = triangles
            .iter()
            .map(|ids| four(ids))
            .chain(edges.iter().map(|ids| four(ids)))
            .chain(vertices.iter().map(|&v| four(&[v])))
            .collect();
        #[expect(clippy::cast_possible_truncation, reason = "seen to be narrow")]
        let [n_triangles, n_edges, n_vertices] =
            [triangles.len(), edges.len(), vertices.len()].map(|n| n as u32);
        let trees = Trees::new(n_triangles, n_edges, n_vertices);
        let mut rest_here = vec![Vec4::ZERO; place.len()];
        let mut is_on_surface = vec![1; place.len()];
        place.iter().zip(rest).for_each(|(&at, v)| rest_here[at as usize] = v.extend(0.0));
        vertices.iter().for_each(|&v| is_on_surface[place[v as usize] as usize] = 0);

        let n_queries = if options.self_collision { edges.len() + vertices.len() } else { 0 };
        let room = |each: usize, [fewest, most]: [usize; 2]| {
            if n_queries == 0 { 0 } else { (each * n_queries).clamp(fewest, most) }
        };
        let n_pairs = room(PAIRS, [FEWEST_PAIRS, MOST_PAIRS]);
        let n_contacts = room(CONTACTS, [FEWEST_CONTACTS, MOST_CONTACTS]).min(options.max_contacts);
        let n_contacts = narrow("contacts", n_contacts)?;
        let flags = backend.upload(&is_on_surface);
        let [particles] = backend.group_by(&flags, 1).try_into().unwrap_or_else(|_| unreachable!("one key"));
        let counts = || backend.filled(2, 0);
        let mut collider = Self {
            options,
            n,
            primitives: backend.upload(&primitives),
            boxes: backend.filled(trees.n_boxes as usize, [Vec4::ZERO; 2]),
            rest: backend.upload(&rest_here),
            drift: backend.filled(1, Vec4::ZERO),
            no_drift: backend.filled(1, Vec4::ZERO),
            all: backend.all(place.len()),
            held: backend.filled(place.len(), Vec4::ZERO),
            particles,
            is_on_surface: flags,
            pairs: backend.filled(0, [0; 4]),
            n_pairs: 0,
            touching: Set::new(backend, 0),
            drawn: backend.filled(0, NO_COLOR),
            colors: backend.filled(0, NO_COLOR),
            entries: backend.filled(0, u32::MAX),
            n_entries: 0,
            n_palettes: 1,
            classes: Vec::new(),
            solids: Vec::new(),
            mobility: [(); 2].map(|()| backend.upload(inverse_masses)),
            parts: backend.filled(2 * place.len() + 1, u32::MAX),
            no_items: backend.filled(0, 0),
            counts: Counts {
                pairs: counts(),
                contacts: counts(),
                kept: counts(),
                outside: counts(),
                uncolored: counts(),
                held: counts(),
                deepest: counts(),
            },
            lacking: [0; 3],
            trees,
        };
        backend.fetch(&collider.boxes, &mut []).map_err(failure)?;
        collider.make_room(backend, n_pairs, n_contacts)?;
        Ok(collider)
    }

    /// Takes memory for so many pairs and contacts; what was found is gone.
    fn make_room(&mut self, backend: &B, n_pairs: usize, n_contacts: u32) -> Result<(), SolverError> {
        if self.n_pairs != n_pairs {
            self.n_pairs = n_pairs;
            self.pairs = backend.filled(n_pairs, [0; 4]);
        }
        if self.touching.n != n_contacts {
            let n = n_contacts as usize;
            let n_entries = (ENTRIES * n).next_power_of_two();
            self.n_entries = narrow("entries", n_entries)?;
            self.classes.clear();
            self.touching = Set::new(backend, n_contacts);
            self.drawn = backend.filled(n, NO_COLOR);
            self.colors = backend.filled(n, NO_COLOR);
            self.entries = backend.filled(n_entries, u32::MAX);
        }
        let check = || -> Result<(), B::Error> {
            backend.fetch(&self.pairs, &mut [])?;
            backend.fetch(&self.touching.contacts, &mut [])?;
            backend.fetch(&self.touching.lambdas, &mut [])?;
            backend.fetch(&self.entries, &mut [])
        };
        check().map_err(failure)
    }

    /// Makes room for what found none, as far as there may be any; whether there is more than before.
    pub(super) fn grow(&mut self, backend: &B) -> Result<bool, SolverError> {
        let [pairs, contacts, uncolored] = self.lacking;
        let more = |now: usize, lacking: usize, most: usize| {
            if lacking == 0 { now } else { (GROWTH * (now + lacking)).min(most).max(now) }
        };
        let n_pairs = more(self.n_pairs, pairs, MOST_PAIRS);
        let most = MOST_CONTACTS.min(self.options.max_contacts);
        let n_contacts = narrow("contacts", more(self.touching.n as usize, contacts, most))?;
        let has_room = n_pairs > self.n_pairs || n_contacts > self.touching.n;
        if has_room {
            self.make_room(backend, n_pairs, n_contacts)?;
        }
        let has_colors = uncolored > 0 && self.n_palettes < MOST_PALETTES;
        self.n_palettes += u32::from(has_colors);
        Ok(has_room || has_colors)
    }

    /// Takes one over what the particles that are free resist with, which come first \[m/N\]: multipliers are forces then.
    pub(super) fn set_mobility(&mut self, backend: &B, resists: Resists, mut mobility: Vec<f32>) {
        mobility.resize(self.n as usize, 0.0);
        backend.write(&mut self.mobility[resists as usize], &mobility);
    }

    /// By how much multipliers move the particles.
    pub(super) fn mobility(&self, resists: Resists) -> &B::Buffer<f32> {
        &self.mobility[resists as usize]
    }

    /// How many contacts there may be, of each kind: for sums over them.
    pub(super) fn groups(&self) -> impl Iterator<Item = u32> {
        self.sets().map(|set| set.n)
    }

    fn sets(&self) -> impl Iterator<Item = &Set<B>> {
        self.solids.iter().map(|standing| &standing.touching).chain([&self.touching])
    }

    fn sets_mut(&mut self) -> impl Iterator<Item = &mut Set<B>> {
        self.solids.iter_mut().map(|standing| &mut standing.touching).chain([&mut self.touching])
    }

    /// A frame begins: what finds no room in it, and what is held back, is counted anew.
    pub(super) fn clear_counts(&mut self, backend: &B) {
        let Counts { pairs, contacts, uncolored, held, .. } = &mut self.counts;
        for counts in [pairs, contacts, uncolored, held] {
            set(backend, 0..2, 0, counts);
        }
    }

    /// Finds the contacts of particles that go from `from` to `to` \[m\]; whether there are other obstacles than before.
    pub(super) fn detect(
        &mut self,
        backend: &B,
        from: &B::Buffer<Vec4>,
        to: &B::Buffer<Vec4>,
        obstacles: &[Obstacle],
    ) -> Result<bool, SolverError> {
        obstacles.iter().enumerate().try_for_each(|(k, obstacle)| obstacle.check(k))?;
        // Contacts are counted anew in each small step; what found no room is not.
        let Counts { pairs, contacts, kept, outside, .. } = &mut self.counts;
        [pairs, contacts].into_iter().for_each(|counts| set(backend, 0..1, 0, counts));
        [kept, outside].into_iter().for_each(|counts| set(backend, 0..2, 0, counts));
        let is_new = self.solids.len() != obstacles.len();
        self.solids.truncate(obstacles.len());
        while self.solids.len() < obstacles.len() {
            self.solids.push(Standing::new(backend, self.n));
        }
        let Options { thickness, margin, .. } = self.options;
        for (standing, obstacle) in self.solids.iter_mut().zip(obstacles) {
            standing.stand(backend, obstacle);
            let Standing { solid, values, touching, .. } = standing;
            let near = Solid { distance: thickness, margin, ..*solid };
            let inputs = (backend.view(from), backend.view(to), backend.view(values));
            let mut others = self.particles.clone();
            touching.list = backend.select::<MeetSolid>(&mut others, &near, inputs, &mut touching.contacts);
            let (counts, no_items) = (&mut self.counts.outside, &mut self.no_items);
            count(backend, &touching.list, 0, &self.is_on_surface, no_items, counts);
        }
        if self.trees.meet.n_triangles > 0 {
            let uniform = DriftUniform { first: self.trees.first_vertex(), n: self.trees.n_vertices };
            let inputs = (backend.view(&self.primitives), backend.view(from), backend.view(to));
            backend.map::<Drift>(&backend.range(0..1), &uniform, inputs, &mut self.drift);
            let pairs = self.meet(backend, from, to, true, thickness + margin);
            self.touch(backend, &pairs, from, to);
            if !self.options.every_pair {
                self.thin(backend, to);
            }
            self.color(backend);
        }
        Ok(is_new)
    }

    /// Pairs whose boxes come within `reach` \[m\].
    fn meet(
        &mut self,
        backend: &B,
        from: &B::Buffer<Vec4>,
        to: &B::Buffer<Vec4>,
        drifts: bool,
        reach: f32,
    ) -> B::List {
        let Trees { meet, bounds, n_vertices, .. } = &self.trees;
        let n_leaves = self.trees.first_vertex() + n_vertices;
        let drift = if drifts { &self.drift } else { &self.no_drift };
        let primitives = backend.view(&self.primitives);
        let inputs = (primitives, backend.view(from), backend.view(to), backend.view(drift));
        let uniform = SweptBoxUniform { margin: 0.5 * reach };
        backend.map::<SweptBox>(&backend.range(0..n_leaves), &uniform, inputs, &mut self.boxes);
        for bound in bounds {
            let n = bound.n_children.div_ceil(CHILDREN);
            let level = backend.range(bound.first..bound.first + n);
            backend.update::<Bound>(&level, bound, (), &mut self.boxes);
        }
        let queries = backend.range(meet.n_triangles..n_leaves);
        let inputs = (primitives, backend.view(&self.boxes));
        backend.expand::<Meet>(&queries, meet, inputs, &mut self.pairs, &mut self.counts.pairs)
    }

    /// Contacts of pairs.
    fn touch(&mut self, backend: &B, pairs: &B::List, from: &B::Buffer<Vec4>, to: &B::Buffer<Vec4>) {
        let Options { thickness, margin, friction, every_pair, .. } = self.options;
        let uniform = TouchUniform { thickness, margin, friction, every_pair: every_pair.into() };
        let (rest, touching) = (backend.view(&self.rest), &mut self.touching);
        let inputs = (backend.view(&self.pairs), rest, backend.view(from), backend.view(to));
        let counts = &mut self.counts.contacts;
        touching.list = backend.expand::<Touch>(pairs, &uniform, inputs, &mut touching.contacts, counts);
    }

    /// Leaves out contacts that others imply where particles go `to` \[m\].
    fn thin(&mut self, backend: &B, to: &B::Buffer<Vec4>) {
        let Self { touching, held, colors, counts, all, .. } = self;
        backend.map::<SetVector>(all, &SetVectorUniform { value: Vec4::ZERO }, (), held);
        let contacts = backend.view(&touching.contacts);
        let inputs = (contacts, backend.view(to), backend.view(&counts.contacts));
        backend.scatter::<Thin, 1>(&touching.list, &(), inputs, held, colors);
        let inputs = (contacts, backend.view(held));
        touching.list = backend.select::<KeepThin>(&mut touching.list, &(), inputs, colors);
    }

    /// Colors contacts.
    fn color(&mut self, backend: &B) {
        let mask = self.n_entries - 1;
        set(backend, 0..self.n_entries, u32::MAX, &mut self.entries);
        let nothing = SetValueUniform { value: NO_COLOR };
        backend.map::<SetValue>(&self.touching.all, &nothing, (), &mut self.colors);
        let (counts, no_items) = (&mut self.counts.kept, &mut self.no_items);
        count(backend, &self.touching.list, NO_COLOR, &self.colors, no_items, counts);
        let mut left = self.touching.list.clone();
        // What the last lists hold goes to those that come.
        self.classes.clear();
        for palette in 0..self.n_palettes {
            if palette > 0 {
                set(backend, 0..self.n_entries, u32::MAX, &mut self.entries);
                backend.map::<SetValue>(&self.touching.all, &nothing, (), &mut self.colors);
            }
            self.color_some(backend, &mut left, mask);
            self.classes.extend(backend.group_by(&self.colors, N_COLORS));
        }
        let (counts, no_items) = (&mut self.counts.uncolored, &mut self.no_items);
        count(backend, &left, NO_COLOR, &self.colors, no_items, counts);
    }

    /// Takes those that get a color of a palette out of `left`.
    fn color_some(&mut self, backend: &B, left: &mut B::List, mask: u32) {
        let all_entries = backend.range(0..self.n_entries);
        let Self { touching, drawn, entries, colors, .. } = self;
        let contacts = &touching.contacts;
        for round in 0..COLOR_ROUNDS {
            let key = pcg::key(0, round);
            let uniform = ClaimUniform { key, mask };
            let inputs = (backend.view(contacts), backend.view(entries));
            backend.map::<DrawColor>(left, &uniform, inputs, drawn);
            let claim = ClaimColorUniform { key, mask, is_settled: 0 };
            let inputs = (backend.view(contacts), backend.view(drawn));
            backend.lower::<ClaimColor, 4>(left, &claim, inputs, entries);
            let inputs = (backend.view(contacts), backend.view(drawn), backend.view(entries));
            let settled = backend.select::<SettleColor>(left, &uniform, inputs, colors);
            let claim = ClaimColorUniform { is_settled: 1, ..claim };
            let inputs = (backend.view(contacts), backend.view(drawn));
            backend.lower::<ClaimColor, 4>(&settled, &claim, inputs, entries);
            backend.map::<ReleaseColor>(&all_entries, &(), (), entries);
        }
    }

    /// Forgets what was found.
    pub(super) fn drop_contacts(&mut self, backend: &B) {
        self.classes.clear();
        self.sets_mut().for_each(|set| set.list = backend.range(0..0));
    }

    /// Forgets the multipliers.
    pub(super) fn begin(&mut self, backend: &B) {
        self.sets_mut().for_each(|set| set.begin(backend));
    }

    /// Projects all contacts.
    pub(super) fn relax(&mut self, backend: &B, resists: Resists, q: &mut B::Buffer<Vec4>) {
        let uniform = HoldUniform { compliance: pbd::CONTACT_STIFFNESS.recip() };
        let Self { solids, touching, classes, mobility, .. } = self;
        let mobility = &mobility[resists as usize];
        for Standing { touching, .. } in solids {
            let list = touching.list.clone();
            touching.relax(backend, &list, &uniform, mobility, q);
        }
        for class in classes {
            touching.relax(backend, class, &uniform, mobility, q);
        }
    }

    pub(super) fn remember(&mut self, backend: &B) {
        self.sets_mut().for_each(|set| set.history.remember(backend, &set.lambdas));
    }

    pub(super) fn extrapolate(&mut self, backend: &B, weight: Params<'_, B, ExtrapolateUniform>) {
        self.sets_mut().for_each(|set| set.history.extrapolate(backend, &mut set.lambdas, weight));
    }

    pub(super) fn save(&mut self, backend: &B) {
        self.sets_mut().for_each(|set| set.history.save(backend, &set.lambdas));
    }

    pub(super) fn restore(&mut self, backend: &B) {
        self.sets_mut().for_each(|set| set.history.restore(backend, &mut set.lambdas));
    }

    pub(super) fn follow(&mut self, backend: &B, watch: &B::Buffer<Watch>) {
        self.sets_mut().for_each(|set| set.history.follow(backend, watch, &mut set.lambdas));
    }

    /// Adds the energy of all contacts \[J\]: w d²/2, where w is so many times the stiffness of what they hold; with inverse masses in a (small)
    /// step of which `squared_h` is the square \[s²\].
    pub(super) fn add_energy(
        &self,
        backend: &B,
        resists: Resists,
        squared_h: f32,
        q: &B::Buffer<Vec4>,
        sums: &mut Sums<B>,
    ) {
        let mobility = self.mobility(resists);
        let uniform = ContactEnergyUniform { stiffness: pbd::CONTACT_STIFFNESS / squared_h };
        for set in self.sets() {
            sums.clear(backend);
            let inputs = (backend.view(&set.contacts), backend.view(mobility), backend.view(q));
            backend.map::<ContactEnergy>(&set.list, &uniform, inputs, &mut sums.numbers);
            sums.add(backend, set.n);
        }
    }

    /// Takes the forces of all contacts, multipliers times `scale`, from `gradients` \[N\].
    pub(super) fn add_gradient(&mut self, backend: &B, scale: f32, gradients: &mut B::Buffer<Vec4>) {
        let uniform = PushUniform { scale: -scale };
        let mut push = |set: &mut Set<B>, list: &B::List| {
            let inputs = (backend.view(&set.contacts),);
            backend.scatter::<Push, 4>(list, &uniform, inputs, gradients, &mut set.lambdas);
        };
        let Self { solids, touching, classes, .. } = self;
        for Standing { touching, .. } in solids {
            let list = touching.list.clone();
            push(touching, &list);
        }
        classes.iter().for_each(|class| push(touching, class));
    }

    /// Reads what was counted since the step began, and the depths at `q` \[m\].
    pub(super) fn report(
        &mut self,
        backend: &B,
        q: &B::Buffer<Vec4>,
        sums: &mut Sums<B>,
    ) -> Result<ContactReport, B::Error> {
        set(backend, 0..1, u32::MAX, &mut self.counts.deepest);
        for touching in self.solids.iter().map(|standing| &standing.touching).chain([&self.touching]) {
            sums.clear(backend);
            let inputs = (backend.view(&touching.contacts), backend.view(q));
            backend.map::<ContactDepth>(&touching.list, &(), inputs, &mut sums.numbers);
            sums.add(backend, touching.n);
            let depths = (backend.view(&sums.numbers),);
            backend.lower::<Deepest, 1>(&touching.list, &(), depths, &mut self.counts.deepest);
        }
        let read = |counts: &B::Buffer<u32>| -> Result<[usize; 2], B::Error> {
            let mut read = [0; 2];
            backend.fetch(counts, &mut read)?;
            Ok(read.map(|n| n as usize))
        };
        let Counts { pairs, contacts, kept, outside, uncolored, held, deepest } = &self.counts;
        let (no_room, kept) = (read(contacts)?[1], read(kept)?[1]);
        let (uncolored, outside) = (read(uncolored)?[1], read(outside)?[1]);
        let mut turned = [0];
        backend.fetch(deepest, &mut turned)?;
        let no_pairs = read(pairs)?[1];
        self.lacking = [no_pairs, no_room, uncolored];
        let n_contacts = kept - uncolored + outside;
        #[expect(clippy::cast_possible_truncation, reason = "depths are f32")]
        let mean_depth = (sums.total(backend)? / n_contacts.max(1) as f64) as f32;
        Ok(ContactReport {
            contacts: n_contacts,
            colors: self.classes.len() + self.solids.len(),
            left_out: no_pairs + no_room + uncolored,
            held_back: read(held)?[1],
            deepest: f32::from_bits(!turned[0]),
            mean_depth,
        })
    }
}

/// Sets some elements to a value.
fn set<B: Backend>(backend: &B, range: std::ops::Range<u32>, value: u32, array: &mut B::Buffer<u32>) {
    backend.map::<SetValue>(&backend.range(range), &SetValueUniform { value }, (), array);
}

/// Adds to the second of `counts` how many in `list` have a value.
fn count<B: Backend>(
    backend: &B,
    list: &B::List,
    value: u32,
    values: &B::Buffer<u32>,
    no_items: &mut B::Buffer<u32>,
    counts: &mut B::Buffer<u32>,
) {
    let inputs = (backend.view(values),);
    backend.expand::<FindValue>(list, &FindValueUniform { value }, inputs, no_items, counts);
}
