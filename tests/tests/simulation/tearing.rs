//! Cloth that tears: what is left is a mesh, weighs what it weighed, and is colored as it was.

use std::collections::{BTreeMap, BTreeSet};

use glam::Vec3;
use proptest::prelude::*;
use rayon::ThreadPoolBuilder;
use vivace_coloring::{Certificate, color};
use vivace_cpu::Cpu;
use vivace_kernels::constraint::Constraint;
use vivace_mesh::cloth;
use vivace_model::{Model, ModelBuilder, ModelError, State, Tear, TearLimit};
use vivace_solver::{Budget, Framework, PinMove, Relaxation, Solver, System};
use vivace_tests::random::Random;
use vivace_tests::scenes::{STEP, gauss_seidel, plain, solvers};

use crate::NO_FORCE;

/// A cloth with springs, hinges and strain limits on all there is, in the xz plane, 0.1 m from particle to particle.
fn sheet(width: usize, height: usize, jitter: f32, limit: TearLimit) -> ModelBuilder {
    let mesh = if jitter > 0.0 {
        cloth::irregular(width, height, 0.1, jitter, 5).unwrap()
    } else {
        cloth::alternating(width, height, 0.1).unwrap()
    };
    let mut builder = ModelBuilder::new();
    builder.cloth(&mesh, 0.2).unwrap();
    builder.springs(0, &mesh.edges(), 100.0).unwrap();
    builder.hinges(0, &mesh.hinges(), 1e-4, false).unwrap();
    builder.triangle_strain(0, mesh.triangles(), 50.0, 0.3).unwrap();
    builder.let_tear(0..builder.n_springs(), &limit).unwrap();
    builder
}

/// The triangles of each edge.
fn edges(surface: &[[u32; 3]]) -> BTreeMap<[u32; 2], Vec<usize>> {
    let mut edges: BTreeMap<[u32; 2], Vec<usize>> = BTreeMap::new();
    for (triangle, &[a, b, c]) in surface.iter().enumerate() {
        for [u, v] in [[a, b], [b, c], [c, a]] {
            edges.entry([u.min(v), u.max(v)]).or_default().push(triangle);
        }
    }
    edges
}

fn root(parent: &mut [usize], mut i: usize) -> usize {
    while parent[i] != i {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    i
}

/// Pieces of triangles that hang together by edges, and their V − E + F.
fn pieces(surface: &[[u32; 3]]) -> BTreeMap<usize, i64> {
    let mut parent: Vec<usize> = (0..surface.len()).collect();
    let edges = edges(surface);
    for triangles in edges.values() {
        let first = root(&mut parent, triangles[0]);
        for &triangle in &triangles[1..] {
            let other = root(&mut parent, triangle);
            parent[other] = first;
        }
    }
    let mut euler: BTreeMap<usize, i64> = BTreeMap::new();
    for triangle in 0..surface.len() {
        *euler.entry(root(&mut parent, triangle)).or_default() += 1;
    }
    for triangles in edges.values() {
        *euler.get_mut(&root(&mut parent, triangles[0])).unwrap() -= 1;
    }
    let corners: BTreeSet<(usize, u32)> = (0..surface.len())
        .flat_map(|triangle| surface[triangle].map(|corner| (triangle, corner)))
        .map(|(triangle, corner)| (root(&mut parent, triangle), corner))
        .collect();
    corners.into_iter().for_each(|(piece, _)| *euler.get_mut(&piece).unwrap() += 1);
    euler
}

fn mass(model: &Model) -> f64 {
    model.masses().iter().filter(|mass| mass.is_finite()).map(|&mass| f64::from(mass)).sum()
}

/// Σ k/2 (|d| − l)² \[J\].
fn spring_energy(model: &Model, at: &[Vec3]) -> f64 {
    let springs = &model.constraints().springs;
    let of = |(&ends, spring): (&[u32; 2], &vivace_kernels::constraint::Spring)| {
        f64::from(spring.energy(&ends.map(|p| at[p as usize])))
    };
    springs.particles.iter().zip(&springs.rest).map(of).sum()
}

/// That the surface is manifold, and that constraints lie on it.
fn check_mesh(model: &Model) {
    let surface = model.surface();
    let edges = edges(surface);
    assert!(edges.values().all(|triangles| triangles.len() <= 2), "an edge of three triangles");
    for &[a, b, c] in surface {
        assert!(a != b && b != c && c != a, "a triangle has a corner twice");
    }
    // Around each particle the triangles hang together by edges.
    let mut around = vec![BTreeSet::new(); model.n_particles()];
    for (triangle, corners) in surface.iter().enumerate() {
        corners.iter().for_each(|&corner| {
            around[corner as usize].insert(triangle);
        });
    }
    for (particle, triangles) in (0..).zip(&around) {
        assert!(!triangles.is_empty(), "particle {particle} has no triangle");
        let (mut seen, mut next) = (BTreeSet::new(), vec![*triangles.first().unwrap()]);
        while let Some(triangle) = next.pop() {
            if seen.insert(triangle) {
                for corner in surface[triangle].into_iter().filter(|&corner| corner != particle) {
                    next.extend(&edges[&[corner.min(particle), corner.max(particle)]]);
                }
            }
        }
        assert_eq!(&seen, triangles, "particle {particle} joins pieces that share no edge");
    }
    let sorted = |[a, b]: [u32; 2]| [a.min(b), a.max(b)];
    let c = model.constraints();
    let springs: BTreeSet<[u32; 2]> = c.springs.particles.iter().map(|&ends| sorted(ends)).collect();
    assert_eq!(springs.len(), c.springs.len(), "two springs on an edge");
    assert!(springs.iter().eq(edges.keys()), "springs are not the edges");
    let hinges: BTreeSet<[u32; 2]> = c.bending.particles.iter().map(|h| sorted([h[0], h[1]])).collect();
    let inner = edges.iter().filter(|(_, triangles)| triangles.len() == 2).map(|(edge, _)| edge);
    assert!(hinges.iter().eq(inner), "hinges are not the inner edges");
    for &[e0, e1, o0, o1] in &c.bending.particles {
        for o in [o0, o1] {
            let is_there = edges[&sorted([e0, e1])].iter().any(|&t| surface[t].contains(&o));
            assert!(is_there, "a hinge's triangle is gone");
        }
    }
    for (corners, triangle) in c.triangle_strain.particles.iter().zip(surface) {
        assert_eq!(corners, triangle);
    }
}

/// Every spring that is stretched too far has an end that was let go of, or none that could be: it is pinned, or nothing is behind it.
fn check_relief(before: &Model, after: &Model, at: &[Vec3], tears: &[Tear]) {
    let touched: BTreeSet<u32> = tears
        .iter()
        .flat_map(|tear| match tear {
            Tear::Split { particle, copy, .. } => [*particle, *copy],
            Tear::Break { particles } => *particles,
        })
        .collect();
    let springs = &after.constraints().springs;
    for (&ends, spring) in springs.particles.iter().zip(&springs.rest) {
        let [a, b] = ends.map(|p| at[p as usize]);
        // Each spring has the same limit here.
        if a.distance(b) / spring.rest - 1.0 <= 0.3 || ends.iter().any(|p| touched.contains(p)) {
            continue;
        }
        for [v, w] in [ends, [ends[1], ends[0]]] {
            let (origin, pull) = (at[v as usize], at[w as usize] - at[v as usize]);
            let is_behind = |triangle: &&[u32; 3]| {
                let others = triangle.iter().filter(|&&corner| corner != v);
                triangle.contains(&v)
                    && !triangle.contains(&w)
                    && others.map(|&corner| at[corner as usize] - origin).sum::<Vec3>().dot(pull) <= 0.0
            };
            let could = !before.is_pinned(v) && after.surface().iter().any(|triangle| is_behind(&triangle));
            assert!(!could, "spring {ends:?} is stretched and {v} could be split");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Whatever is pulled, pinned and torn, again and again.
    #[test]
    fn torn_meshes_are_manifold(
        (width, height) in (2_usize..7, 2_usize..7),
        jitter in prop_oneof![Just(0.0_f32), Just(0.3)],
        pins in prop::collection::vec(0_u32..36, 0..4),
        spread in 0.02_f32..0.15,
        seed: u64,
    ) {
        let mut builder = sheet(width, height, jitter, TearLimit::new(0.3));
        let n = u32::try_from(width * height).unwrap();
        pins.iter().filter(|&&pin| pin < n).for_each(|&pin| builder.pin(pin).unwrap());
        let (mut model, mut state) = builder.build().unwrap();
        let home = color(&model.graph().unwrap());
        let whole = mass(&model);
        let mut random = Random::new(seed);
        #[expect(clippy::cast_possible_truncation, reason = "any number will do")]
        let mut unit = || random.unit() as f32 - 0.5;
        for _ in 0..6 {
            state.positions.iter_mut().for_each(|q| *q += spread * Vec3::new(unit(), unit(), unit()));
            let tears = model.find_tears(&state.positions);
            let energy = spring_energy(&model, &state.positions);
            let (before, n_triangles) = (model.clone(), model.surface().len());
            model.tear(&tears).unwrap();
            state.tear(&tears);
            prop_assert_eq!(state.check(&model), Ok(()));
            check_mesh(&model);
            check_relief(&before, &model, &state.positions, &tears);
            prop_assert_eq!(model.surface().len(), n_triangles);
            prop_assert!((mass(&model) - whole).abs() < 1e-5 * whole);
            prop_assert!(model.masses().iter().all(|&mass| mass > 0.0));
            let now = spring_energy(&model, &state.positions);
            prop_assert!((now - energy).abs() <= 1e-5 * energy, "{} J became {} J", energy, now);
            // The colors of the sheet that was built are proper for what is left of it.
            let n = u32::try_from(model.n_particles()).unwrap();
            let inherited: Vec<u32> = (0..n).map(|p| home.colors()[model.origin(p) as usize]).collect();
            prop_assert!(Certificate::check(&model.graph().unwrap(), &inherited).is_ok());
        }
    }
}

/// A strip of 13 × 4 particles, its ends pinned, whose springs in the middle are the weakest.
fn strip() -> (Model, State, Vec<u32>) {
    let mesh = cloth::alternating(13, 4, 0.1).unwrap();
    let mut builder = ModelBuilder::new();
    builder.cloth(&mesh, 0.2).unwrap();
    for [a, b] in mesh.edges() {
        builder.springs(0, &[[a, b]], 100.0).unwrap();
        let x = [a, b].map(|p| mesh.positions()[p as usize].x);
        let is_weak = x[0].min(x[1]) > 0.55 && x[0].max(x[1]) < 0.75 && x[0] != x[1];
        let limit = TearLimit::new(if is_weak { 0.2 } else { 0.6 });
        builder.let_tear(builder.n_springs() - 1..builder.n_springs(), &limit).unwrap();
    }
    builder.hinges(0, &mesh.hinges(), 1e-5, false).unwrap();
    let ends: Vec<u32> = (0..52).filter(|p| p % 13 == 0 || p % 13 == 12).collect();
    ends.iter().for_each(|&p| builder.pin(p).unwrap());
    let (model, state) = builder.build().unwrap();
    (model, state, ends)
}

fn on_host(solver: Solver) -> impl FnOnce(Model) -> System {
    move |model| System::new(model, solver).unwrap()
}

/// Pulls the strip apart, to four thirds of its length, and goes on for a while.
fn pulled(
    system: impl FnOnce(Model) -> System,
    iterations: u32,
    mut each: impl FnMut(&System, &State, &[Tear]),
) -> (Model, State) {
    let (model, mut state, ends) = strip();
    let mut system = system(model);
    for frame in 0..40 {
        let by = if frame < 30 { Vec3::X * 0.013 } else { Vec3::ZERO };
        let moves: Vec<PinMove> = ends
            .iter()
            .filter(|&p| p % 13 == 12)
            .map(|&particle| {
                let from = state.positions[particle as usize];
                PinMove { particle, from, to: from + by }
            })
            .collect();
        system.move_pins(&moves).unwrap();
        system.step(&mut state, &NO_FORCE, STEP, Budget::iterations(iterations)).unwrap();
        let tears = system.model().find_tears(&state.positions);
        if !tears.is_empty() {
            system.tear(&mut state, &tears).unwrap();
        }
        each(&system, &state, &tears);
    }
    (system.model().clone(), state)
}

#[test]
fn a_strip_that_is_pulled_apart_becomes_two() {
    for framework in [Framework::default(), Framework::FUSED, Framework::PositionBased] {
        let solver = Solver { framework, ..plain(gauss_seidel(1.0)) };
        let (whole, _, _) = strip();
        assert_eq!(
            pieces(whole.surface()),
            BTreeMap::from([(pieces(whole.surface()).into_keys().next().unwrap(), 1)])
        );
        let n_colors = System::new(whole.clone(), solver).unwrap().n_colors();
        let mut n_frames = 0;
        let (model, state) = pulled(on_host(solver), 60, |system, _, tears| {
            n_frames += usize::from(!tears.is_empty());
            if framework != Framework::PositionBased {
                assert!(system.n_colors() <= n_colors);
            }
        });
        assert!(n_frames > 0);
        // Each of them is a disk: V − E + F = 1.
        let found: Vec<i64> = pieces(model.surface()).into_values().collect();
        assert_eq!(found, [1, 1], "{framework:?}");
        assert!((mass(&model) - mass(&whole)).abs() < 1e-6 * mass(&whole));
        let springs = &model.constraints().springs;
        for (ends, spring) in springs.particles.iter().zip(&springs.rest) {
            let [a, b] = ends.map(|p| state.positions[p as usize]);
            assert!(a.distance(b) < 1.2 * spring.rest, "{framework:?}: {ends:?} is still stretched");
        }
    }
}

/// Every solver goes on with what is left.
#[test]
fn every_solver_tears() {
    for solver in solvers() {
        let (model, _) = pulled(on_host(solver), 20, |_, state, _| {
            assert!(state.positions.iter().all(|q| q.is_finite()));
        });
        assert!(!model.parents().is_empty(), "{solver:?}");
    }
}

/// Kernels see the torn model, too.
#[test]
fn a_device_tears() {
    for framework in [Framework::default(), Framework::PositionBased] {
        let solver = Solver { framework, ..plain(gauss_seidel(1.0)) };
        let on_device = |model| System::on(model, solver, Cpu::new()).unwrap();
        let (model, state) = pulled(on_device, 60, |_, _, _| {});
        assert_eq!(state.check(&model), Ok(()));
        assert_eq!(pieces(model.surface()).len(), 2, "{framework:?}");
    }
}

#[test]
fn tears_are_the_same_on_any_number_of_threads() {
    for framework in [Framework::default(), Framework::PositionBased] {
        for relaxation in [gauss_seidel(1.5), Relaxation::Jacobi { omega: 0.6 }] {
            let solver = Solver { framework, safeguard: true, ..plain(relaxation) };
            let on = |n: usize| {
                let pool = ThreadPoolBuilder::new().num_threads(n).build().unwrap();
                pool.install(|| pulled(on_host(solver), 12, |_, _, _| {}))
            };
            let one = on(1);
            assert!(!one.0.parents().is_empty());
            assert!([2, 7].into_iter().all(|n| on(n) == one), "{solver:?}");
        }
    }
}

/// What nobody pulls too far tears nothing, and springs without triangles just break.
#[test]
fn a_rope_breaks_where_it_is_weakest() {
    let positions: Vec<Vec3> = (0..6).map(|i| Vec3::X * 0.1 * i as f32).collect();
    let mut builder = ModelBuilder::new();
    builder.particles(&positions, &[0.1; 6]).unwrap();
    let links: Vec<[u32; 2]> = (1..6).map(|i| [i - 1, i]).collect();
    builder.springs(0, &links, 10.0).unwrap();
    builder.let_tear(0..5, &TearLimit::new(0.5)).unwrap();
    builder.let_tear(2..3, &TearLimit::new(0.2)).unwrap();
    let (mut model, state) = builder.build().unwrap();
    assert!(model.find_tears(&state.positions).is_empty());
    let pulled: Vec<Vec3> = positions.iter().map(|q| *q * 1.3).collect();
    let tears = model.find_tears(&pulled);
    assert_eq!(tears, [Tear::Break { particles: [2, 3] }]);
    model.tear(&tears).unwrap();
    let left = [links[0], links[1], links[3], links[4]];
    assert_eq!(model.constraints().springs.particles, left);
    assert!(model.find_tears(&pulled).is_empty());
    let further: Vec<Vec3> = positions.iter().map(|q| *q * 1.6).collect();
    assert_eq!(model.find_tears(&further).len(), 4);
}

#[test]
fn what_cannot_be_is_refused_and_changes_nothing() {
    let mut builder = sheet(3, 3, 0.0, TearLimit::new(0.5));
    let n = builder.n_springs();
    assert_eq!(
        builder.let_tear(3..n + 1, &TearLimit::new(0.5)),
        Err(ModelError::Springs { springs: 3..n + 1, n_springs: n })
    );
    for strain in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        assert!(matches!(builder.let_tear(0..1, &TearLimit::new(strain)), Err(ModelError::Value { .. })));
    }
    for variation in [-0.1, 1.0, f32::NAN] {
        let limit = TearLimit { variation, ..TearLimit::new(0.5) };
        assert!(matches!(builder.let_tear(0..1, &limit), Err(ModelError::Value { .. })));
    }
    let (mut model, _) = builder.build().unwrap();
    let before = model.clone();
    let split =
        |particle, copy, triangles: &[u32]| Tear::Split { particle, copy, triangles: triangles.to_vec() };
    let of_middle: Vec<u32> =
        (0..).zip(model.surface()).filter(|(_, t)| t.contains(&4)).map(|(k, _)| k).collect();
    let bad = [
        split(9, 9, &[0]),
        split(4, 10, &of_middle[..1]),
        split(4, 9, &[]),
        split(4, 9, &of_middle),
        split(4, 9, &[of_middle[1], of_middle[0]]),
        split(4, 9, &[of_middle[0], 1000]),
    ];
    for bad in bad {
        let good = split(4, 9, &of_middle[..1]);
        assert!(
            matches!(model.tear(std::slice::from_ref(&bad)), Err(ModelError::Tear { tear: 0, .. })),
            "{bad:?}"
        );
        assert_eq!(model, before);
        let after = match bad.clone() {
            Tear::Split { particle, copy, triangles } => split(particle, copy + 1, &triangles),
            other @ Tear::Break { .. } => other,
        };
        let refused = model.tear(&[good, after]);
        assert!(
            matches!(refused, Err(ModelError::Tear { tear: 1, .. })) || bad == split(9, 9, &[0]),
            "{bad:?}"
        );
        assert!(refused.is_ok() || model == before);
        model.clone_from(&before);
    }
    let mut plain = vivace_tests::scenes::cloth(3, 1.0, None).0;
    assert!(matches!(plain.tear(&[split(4, 9, &of_middle[..1])]), Err(ModelError::Tear { .. })));
    // Volumes do not tear.
    let mesh = vivace_mesh::beam::regular([1, 1, 1], 0.1).unwrap();
    let mut builder = ModelBuilder::new();
    builder.volume(&mesh, 100.0).unwrap();
    builder.springs(0, &mesh.edges(), 10.0).unwrap();
    builder.tet_strain(0, mesh.tets(), 10.0).unwrap();
    builder.let_tear(3..4, &TearLimit::new(0.5)).unwrap();
    assert_eq!(builder.build().unwrap_err(), ModelError::NoTear { spring: 3 });
}
