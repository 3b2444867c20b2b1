//! A coloring that follows a graph for ever.

use proptest::prelude::*;
use vivace_coloring::{Coloring, FollowWork, Follower, color};
use vivace_graph::{ConstraintGraph, DynamicGraph};
use vivace_tests::oracle;
use vivace_tests::random::Random;
use vivace_tests::workloads::shared;

use crate::arbitrary::any_graph;

/// All that is promised after any change.
fn check(graph: &DynamicGraph, home: &Coloring, follower: &Follower) {
    let colors = follower.colors();
    assert!(oracle::is_coloring(graph, colors));
    let most = colors.iter().copied().max().map_or(0, |most| most + 1);
    assert_eq!(follower.n_colors(), most);
    let away: Vec<u32> =
        (0..).zip(colors.iter().zip(home.colors())).filter(|(_, (a, b))| a != b).map(|(v, _)| v).collect();
    assert_eq!(follower.away().collect::<Vec<_>>(), away);
    for v in away {
        let around = |color: u32| graph.neighbors(v).iter().any(|&u| colors[u as usize] == color);
        let color = home.colors()[v as usize];
        let keeps_out = |&u: &u32| colors[u as usize] == color && home.colors()[u as usize] == color;
        assert!(graph.neighbors(v).iter().any(keeps_out), "{v} could go home");
        assert!((0..colors[v as usize]).all(around), "{v} has a color that is too large");
    }
}

fn apply(
    graph: &mut DynamicGraph,
    follower: &mut Follower,
    go: &[[u32; 2]],
    come: &[[u32; 2]],
) -> FollowWork {
    assert_eq!(graph.apply(go, come), Ok(go.len()));
    follower.update(graph, go, come)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    #[test]
    fn any_sequence_of_changes(graph in any_graph(), seed in any::<u64>(), n_steps in 1..12) {
        prop_assume!(graph.n_vertices() > 1);
        let n = u32::try_from(graph.n_vertices()).unwrap();
        let home = color(&graph);
        let (mut dynamic, mut follower) = (DynamicGraph::from(&graph), Follower::new(&home));
        let mut random = Random::new(seed);
        let mut there: Vec<[u32; 2]> = Vec::new();
        for _ in 0..n_steps {
            let come: Vec<[u32; 2]> =
                (0..random.below(2 * n)).map(|_| [random.below(n), random.below(n)]).filter(|[u, v]| u != v).collect();
            let (go, stay): (Vec<_>, Vec<_>) = there.iter().copied().partition(|_| random.below(2) == 0);
            apply(&mut dynamic, &mut follower, &go, &come);
            check(&dynamic, &home, &follower);
            there = [stay, come].concat();
        }
        // What is written down is taken up again, whatever is in between; what is no coloring is refused.
        let kept: Vec<(u32, u32)> = follower.away().map(|v| (v, follower.colors()[v as usize])).collect();
        let mut other = Follower::new(&home);
        other.set_away(&dynamic, &kept).unwrap();
        check(&dynamic, &home, &other);
        prop_assert_eq!(other.colors(), follower.colors());
        if let Some(&[u, v]) = there.first() {
            let wrong = [(u, 7), (v, 7)];
            prop_assert!(other.set_away(&dynamic, &wrong).is_err());
            prop_assert_eq!(other.colors(), follower.colors());
        }
        // With the last change gone all are at home.
        apply(&mut dynamic, &mut follower, &there, &[]);
        prop_assert_eq!(follower.colors(), home.colors());
        prop_assert_eq!(dynamic.to_graph(), graph);
    }

    #[test]
    fn anew_is_a_coloring(graph in any_graph(), seed in any::<u64>()) {
        prop_assume!(graph.n_vertices() > 1);
        let n = u32::try_from(graph.n_vertices()).unwrap();
        let home = color(&graph);
        let (mut dynamic, mut follower) = (DynamicGraph::from(&graph), Follower::new(&home));
        let mut random = Random::new(seed);
        let come: Vec<[u32; 2]> = (0..n).map(|_| [random.below(n), random.below(n)]).filter(|[u, v]| u != v).collect();
        dynamic.apply(&[], &come).unwrap();
        let work = follower.anew(&dynamic);
        prop_assert!(oracle::is_coloring(&dynamic, follower.colors()));
        prop_assert_eq!(work.visited, [graph.n_vertices(), 2 * dynamic.n_edges()]);
        prop_assert_eq!(work.recolored, follower.away().count());
    }
}

/// Contacts that slide over a cloth: pairs of a patch and another, which wanders.
fn contacts(frame: u32, per_frame: u32) -> Vec<[u32; 2]> {
    let at = |k: u32| 100 * (20 + k / 20) + 10 + k % 20;
    let wander = frame / 4;
    (0..per_frame)
        .map(|k| [at(k), at(k) + 2500 + (wander + 7 * k / per_frame) % 50 + 100 * (wander / 50 % 20)])
        .collect()
}

/// Under 1 % of the edges change: a tenth of the work of coloring anew, and at most one color more.
#[test]
fn a_small_change_is_a_tenth_of_the_work() {
    let mesh: &ConstraintGraph = shared("hinge-cloth-10k");
    let home = color(mesh);
    let (mut graph, mut follower) = (DynamicGraph::from(mesh), Follower::new(&home));
    let mut there: Vec<[u32; 2]> = Vec::new();
    let mut worst = 0.0_f64;
    for frame in 0..100 {
        let come = contacts(4 * frame, 250);
        let n_changes = there.len() + come.len();
        assert!(n_changes * 100 < graph.n_edges(), "{n_changes} of {}", graph.n_edges());
        let work = apply(&mut graph, &mut follower, &there, &come);
        check(&graph, &home, &follower);
        let mut other = follower.clone();
        let full = other.anew(&graph);
        worst = worst.max((work.visited[1] + n_changes) as f64 / full.visited[1] as f64);
        assert!(10 * work.visited[0] < full.visited[0], "{work:?} {full:?}");
        assert!(10 * (work.visited[1] + n_changes) < full.visited[1], "{work:?} {full:?}");
        assert!(follower.n_colors() <= other.n_colors() + 1, "{} {}", follower.n_colors(), other.n_colors());
        there = come;
    }
    println!("{worst} of the work");
}

/// Ten thousand frames of contacts that come and go: no more colors at the end than at the start.
#[test]
fn colors_do_not_drift() {
    let mesh: &ConstraintGraph = shared("hinge-cloth-10k");
    let home = color(mesh);
    let (mut graph, mut follower) = (DynamicGraph::from(mesh), Follower::new(&home));
    let mut random = Random::new(8);
    let mut there: Vec<[u32; 2]> = Vec::new();
    let mut most = [0; 2];
    for frame in 0..10_000 {
        let come: Vec<[u32; 2]> =
            (0..40).map(|_| [random.below(10_000), random.below(10_000)]).filter(|[u, v]| u != v).collect();
        let go: Vec<[u32; 2]> = if there.len() > 2000 { there.drain(..40).collect() } else { Vec::new() };
        apply(&mut graph, &mut follower, &go, &come);
        there.extend(come);
        if frame % 1000 == 999 {
            check(&graph, &home, &follower);
        }
        if frame % 100 == 99 {
            let mut other = follower.clone();
            other.anew(&graph);
            assert!(
                follower.n_colors() <= other.n_colors() + 1,
                "{} {}",
                follower.n_colors(),
                other.n_colors()
            );
        }
        let half = usize::from(frame >= 5000);
        most[half] = most[half].max(follower.n_colors());
    }
    assert!(most[1] <= most[0], "{} {most:?}", home.n_colors());
    apply(&mut graph, &mut follower, &there, &[]);
    assert_eq!(follower.colors(), home.colors());
}
