//! Edges come and go: only what the change made improper is colored again.

use rayon::prelude::*;
use vivace_graph::Adjacency;

use crate::Coloring;
use crate::serial::Palette;

/// What [`recolor`] did.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Recolored {
    /// The vertices that got another color, in the order of the edges that asked for it.
    pub vertices: Vec<u32>,
}

/// Mends a coloring after `graph` has got the edges `inserted` and lost any others. A removed edge makes nothing improper.
///
/// Where the ends of an inserted edge are alike, the one with fewer neighbors gets the smallest color free there (of equals, the
/// higher). Work in proportion to `inserted` and to the degrees of who is colored again; the answer depends on the order of
/// `inserted`, not on threads. A class may be left empty; [`crate::reduce`] or a new coloring brings the number down after many changes.
///
/// # Panics
/// When an edge names a vertex that `coloring` does not have.
pub fn recolor(graph: &impl Adjacency, coloring: &mut Coloring, inserted: &[[u32; 2]]) -> Recolored {
    // Most edges join different colors: looking for those that do not is most of the work, and needs no order.
    const MANY: usize = 4096;
    let colors = coloring.colors();
    let clashes = |[u, v]: &[u32; 2]| colors[*u as usize] == colors[*v as usize];
    let clashing: Vec<[u32; 2]> = if inserted.len() < MANY {
        inserted.iter().copied().filter(clashes).collect()
    } else {
        inserted.par_iter().with_min_len(MANY / 4).copied().filter(clashes).collect()
    };
    let mut palette = Palette::new();
    let mut vertices = Vec::with_capacity(clashing.len());
    // Changes lie anywhere: asking for a row well before it is read hides most of the wait for memory.
    const AHEAD: usize = 8;
    let mut asked = 0;
    for (k, &[u, v]) in clashing.iter().enumerate() {
        for &next in clashing.get(k + AHEAD).into_iter().flatten() {
            asked ^= graph.neighbors(next).first().copied().unwrap_or(0);
        }
        if coloring.colors()[u as usize] == coloring.colors()[v as usize] {
            let w = std::cmp::min_by_key(u.max(v), u.min(v), |&w| graph.degree(w));
            coloring.set(w, palette.first_free(graph.neighbors(w), coloring.colors()));
            vertices.push(w);
        }
    }
    std::hint::black_box(asked);
    Recolored { vertices }
}
