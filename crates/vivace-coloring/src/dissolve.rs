//! Small classes dissolved into the others: a sweep pays for each class, however few vertices it holds.

use vivace_graph::Adjacency;

use crate::Coloring;
use crate::certificate::index;
use crate::coloring::class_sizes;

/// Moves the vertices of every class of at most `at_most` members into larger classes, or lower small ones, where that is possible:
/// directly, or by moving the one neighbor that is in the way. Never makes a coloring invalid, never adds a color. O(n), and the
/// work of each member grows with the square of its degree at most.
pub fn dissolve_small_classes(graph: &impl Adjacency, coloring: Coloring, at_most: u32) -> Coloring {
    let mut classes = Classes::of(coloring.into_colors());
    let members = (0..).zip(&classes.colors).filter(|&(_, &c)| classes.sizes[c as usize] <= at_most);
    let members: Vec<u32> = members.map(|(v, _)| v).collect();
    classes.dissolve(graph, &members, at_most);
    Coloring::numbered(classes.colors, classes.sizes)
}

/// Makes proper colors a coloring; those of `candidates` that are in classes of a thousandth of the vertices or less join others
/// first, where they can.
pub(crate) fn without_crumbs(graph: &impl Adjacency, colors: Vec<u32>, candidates: &[u32]) -> Coloring {
    let at_most = index(colors.len() / 1000 + 16);
    let mut classes = Classes::of(colors);
    classes.dissolve(graph, candidates, at_most);
    Coloring::numbered(classes.colors, classes.sizes)
}

/// Colors, and how many vertices have each.
struct Classes {
    colors: Vec<u32>,
    sizes: Vec<u32>,
}

impl Classes {
    fn of(colors: Vec<u32>) -> Self {
        let n_ids = colors.iter().copied().max().map_or(0, |c| c + 1);
        Self { sizes: class_sizes(&colors, n_ids), colors }
    }

    fn set(&mut self, v: u32, color: u32) {
        let own = &mut self.colors[v as usize];
        self.sizes[*own as usize] -= 1;
        self.sizes[color as usize] += 1;
        *own = color;
    }

    fn dissolve(&mut self, graph: &impl Adjacency, candidates: &[u32], at_most: u32) {
        let is_small: Vec<bool> = self.sizes.iter().map(|&size| size <= at_most).collect();
        if !is_small.contains(&true) || !is_small.contains(&false) {
            return;
        }
        let mut seen = Seen { by: vec![[0, 0]; is_small.len()] };
        for &v in candidates {
            let own = self.colors[v as usize];
            if is_small[own as usize] {
                // Into a large class, or a smaller number.
                seen.move_into(graph, self, &|c| c < own || !is_small[c as usize], v);
            }
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
        classes: &mut Classes,
        allowed: &impl Fn(u32) -> bool,
        v: u32,
    ) {
        self.look(graph, &classes.colors, v);
        if let Some(c) = self.free(allowed, graph.degree(v)) {
            classes.set(v, c);
            return;
        }
        // The classes that only one neighbor is in: can it go elsewhere?
        let in_the_way: Vec<(u32, u32)> = (0..=graph.degree(v))
            .zip(&self.by)
            .filter(|&(c, &[count, _])| count == 1 && allowed(c))
            .map(|(c, &[_, last])| (c, last))
            .collect();
        for (c, u) in in_the_way {
            self.look(graph, &classes.colors, u);
            if let Some(elsewhere) = self.free(|other| other != c && allowed(other), graph.degree(u)) {
                classes.set(u, elsewhere);
                classes.set(v, c);
                return;
            }
        }
    }
}
