//! Small classes dissolved into the others: a sweep pays for each class, however few vertices it holds.

use vivace_graph::Adjacency;

use crate::Coloring;
use crate::certificate::index;
use crate::coloring::class_sizes;

/// Moves the vertices of every class of at most `at_most` members into larger classes, or lower small ones, where that is possible:
/// directly, or by moving the one neighbor that is in the way. Never makes a coloring invalid, never adds a color. O(n), and the work of each
/// member grows with the square of its degree at most.
pub fn dissolve_small_classes(graph: &impl Adjacency, coloring: Coloring, at_most: u32) -> Coloring {
    let mut colors = coloring.into_colors();
    dissolve(graph, &mut colors, at_most);
    Coloring::compacted(colors)
}

/// Dissolves classes of a thousandth of the vertices or less.
pub(crate) fn dissolve_crumbs(graph: &impl Adjacency, colors: &mut [u32]) {
    dissolve(graph, colors, index(colors.len() / 1000 + 16));
}

fn dissolve(graph: &impl Adjacency, colors: &mut [u32], at_most: u32) {
    let n_ids = colors.iter().copied().max().map_or(0, |c| c + 1);
    let sizes = class_sizes(colors, n_ids);
    let is_small: Vec<bool> = sizes.iter().map(|&size| size <= at_most).collect();
    if !is_small.contains(&true) || !is_small.contains(&false) {
        return;
    }
    let members: Vec<u32> =
        (0..).zip(&*colors).filter(|&(_, &c)| is_small[c as usize]).map(|(v, _)| v).collect();
    let mut seen = Seen { by: vec![[0, 0]; n_ids as usize] };
    for v in members {
        let own = colors[v as usize];
        if is_small[own as usize] {
            // Into a large class, or a smaller number.
            seen.move_into(graph, colors, &|c| c < own || !is_small[c as usize], v);
        }
    }
}

/// For each color, how many neighbors of a vertex have it, and the last of them.
struct Seen {
    by: Vec<[u32; 2]>,
}

impl Seen {
    fn look(&mut self, graph: &impl Adjacency, colors: &[u32], v: u32) {
        self.by.fill([0, 0]);
        for &u in graph.neighbors(v) {
            let [count, last] = &mut self.by[colors[u as usize] as usize];
            // A multigraph may name a neighbor twice; that is still one neighbor.
            *count += u32::from(*count == 0 || *last != u);
            *last = u;
        }
    }

    /// An allowed class, not above `degree`, that no neighbor is in.
    fn free(&self, allowed: impl Fn(u32) -> bool, degree: u32) -> Option<u32> {
        let mut free = (0..=degree).zip(&self.by).filter(|&(c, &[count, _])| count == 0 && allowed(c));
        free.next().map(|(c, _)| c)
    }

    fn move_into(
        &mut self,
        graph: &impl Adjacency,
        colors: &mut [u32],
        allowed: &impl Fn(u32) -> bool,
        v: u32,
    ) {
        self.look(graph, colors, v);
        if let Some(c) = self.free(allowed, graph.degree(v)) {
            colors[v as usize] = c;
            return;
        }
        // The classes that only one neighbor is in: can it go elsewhere?
        let in_the_way: Vec<(u32, u32)> = (0..=graph.degree(v))
            .zip(&self.by)
            .filter(|&(c, &[count, _])| count == 1 && allowed(c))
            .map(|(c, &[_, last])| (c, last))
            .collect();
        for (c, u) in in_the_way {
            self.look(graph, colors, u);
            if let Some(elsewhere) = self.free(|other| other != c && allowed(other), graph.degree(u)) {
                colors[u as usize] = elsewhere;
                colors[v as usize] = c;
                return;
            }
        }
    }
}
