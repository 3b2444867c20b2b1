//! Times construction and the smallest-last order on regular cloths with hinges.
//!
//! `cargo run --release -p vivace-graph --example timing [WIDTH]`

#![expect(clippy::unwrap_used, clippy::cast_possible_truncation, reason = "a small program on small numbers")]

use std::hint::black_box;
use std::time::Instant;

use vivace_graph::{Adjacency, ConstraintGraph, DynamicGraph, GraphBuilder, matrix_market, smallest_last};

fn main() {
    let width: u32 = std::env::args().nth(1).and_then(|arg| arg.parse().ok()).unwrap_or(1000);
    let n = (width * width) as usize;
    let (edges, hinges) = cloth(width);
    println!("{n} vertices, {} edges, {} hinges, {} threads", edges.len(), hinges.len(), rayon_threads());

    let cloth = time("from_edges", || ConstraintGraph::from_edges(n, &edges).unwrap());
    let hinged = time("edges + hinges", || {
        GraphBuilder::new(n).constraints(&edges).constraints(&hinges).build().unwrap()
    });
    let (offsets, items) = hinged.clone().into_csr().into_parts();
    time("arrays cloned", || (offsets.clone(), items.clone()));
    time("from_csr, clean, with the clone", || {
        ConstraintGraph::from_csr(offsets.clone(), items.clone()).unwrap()
    });
    let mut backwards = items.clone();
    backwards.reverse();
    let mut turned: Vec<u32> = offsets.iter().rev().map(|end| items.len() as u32 - end).collect();
    turned[0] = 0;
    time("from_csr, to clean", || ConstraintGraph::from_csr(turned.clone(), backwards.clone()).unwrap());
    time("Incidence", || GraphBuilder::new(n).constraints(&edges).constraints(&hinges).incidence().unwrap());
    time("components", || hinged.components());

    // A tenth as many contacts as edges, at random pairs, and away again.
    let numbers = shuffled(n);
    let contacts: Vec<[u32; 2]> =
        numbers.chunks_exact(2).take(n / 10).map(|pair| [pair[0], pair[1]]).collect();
    let mut dynamic = time("DynamicGraph::from", || DynamicGraph::from(&hinged));
    time(&format!("{} contacts come and go", contacts.len()), || {
        dynamic.apply(&[], &contacts).unwrap();
        dynamic.apply(&contacts, &[]).unwrap()
    });
    let mut text = Vec::new();
    time("matrix_market::write", || {
        text.clear();
        matrix_market::write(&hinged, &mut text).unwrap();
    });
    time(&format!("matrix_market::parse, {} bytes", text.len()), || matrix_market::parse(&text).unwrap());

    for (name, graph) in [("cloth", &cloth), ("hinged cloth", &hinged)] {
        let renumbered = time(&format!("{name} permuted"), || graph.permuted(&numbers).unwrap());
        for (name, graph) in [(name.to_string(), graph), (format!("{name}, renumbered"), &renumbered)] {
            let found = time(&format!("smallest_last, {name}"), || smallest_last(graph));
            println!("    degeneracy {}, {} colors", found.degeneracy, n_colors(graph, &found.order));
        }
    }
}

fn rayon_threads() -> usize {
    rayon::current_num_threads()
}

/// Best of five, printed.
fn time<T>(what: &str, mut run: impl FnMut() -> T) -> T {
    let mut best = f64::INFINITY;
    let mut result = None;
    for _ in 0..5 {
        drop(result.take());
        let start = Instant::now();
        let made = black_box(run());
        best = best.min(start.elapsed().as_secs_f64());
        result = Some(made);
    }
    println!("{:9.3} ms  {what}", best * 1e3);
    result.unwrap()
}

/// Edges right, down and along one diagonal; hinges over each interior edge.
fn cloth(width: u32) -> (Vec<[u32; 2]>, Vec<[u32; 4]>) {
    let (mut edges, mut hinges) = (Vec::new(), Vec::new());
    let at = |x: u32, y: u32| y * width + x;
    for y in 0..width {
        for x in 0..width {
            let (right, down) = (x + 1 < width, y + 1 < width);
            if right {
                edges.push([at(x, y), at(x + 1, y)]);
                if down && y > 0 {
                    hinges.push([at(x, y), at(x + 1, y), at(x, y - 1), at(x + 1, y + 1)]);
                }
            }
            if down {
                edges.push([at(x, y), at(x, y + 1)]);
                if right && x > 0 {
                    hinges.push([at(x, y), at(x, y + 1), at(x - 1, y), at(x + 1, y + 1)]);
                }
            }
            if right && down {
                edges.push([at(x, y), at(x + 1, y + 1)]);
                hinges.push([at(x, y), at(x + 1, y + 1), at(x + 1, y), at(x, y + 1)]);
            }
        }
    }
    (edges, hinges)
}

/// A numbering drawn by a fixed multiplicative generator.
fn shuffled(n: usize) -> Vec<u32> {
    let mut numbers: Vec<u32> = (0..n as u32).collect();
    let mut state: u64 = 51;
    for i in (1..n).rev() {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        numbers.swap(i, ((state >> 33) % (i as u64 + 1)) as usize);
    }
    numbers
}

/// Colors that first fit uses in this order.
fn n_colors(graph: &impl Adjacency, order: &[u32]) -> u32 {
    let mut colors = vec![u32::MAX; graph.n_vertices()];
    for &v in order {
        let taken = graph.neighbors(v).iter().map(|&u| colors[u as usize]).filter(|&c| c < 64);
        colors[v as usize] = (!taken.fold(0u64, |set, c| set | 1 << c)).trailing_zeros();
    }
    colors.iter().max().map_or(0, |&c| c + 1)
}
