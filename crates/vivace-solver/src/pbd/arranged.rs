//! The constraints of one kind in the order of their colors.

use std::ops::Range;

use vivace_graph::Csr;
use vivace_model::Store;

/// Particles and rest data, color by color.
#[derive(Debug)]
pub(crate) struct Arranged<C, const N: usize> {
    /// Members of each color.
    pub(crate) colors: Vec<Range<usize>>,
    pub(crate) particles: Vec<[u32; N]>,
    pub(crate) rest: Vec<C>,
    /// Where the model's constraints stand here.
    pub(crate) place: Vec<u32>,
}

impl<C: Copy, const N: usize> Arranged<C, N> {
    /// The constraints of `store`, whose colors are `of_kind`.
    pub(crate) fn new(store: &Store<C, N>, of_kind: &[u32], n_colors: u32) -> Self {
        let members = Csr::group_by(n_colors as usize, of_kind);
        let order = members.items();
        let mut place = vec![0; order.len()];
        for (k, &constraint) in (0..).zip(order) {
            place[constraint as usize] = k;
        }
        Self {
            colors: members.offsets().windows(2).map(|ends| ends[0] as usize..ends[1] as usize).collect(),
            particles: order.iter().map(|&k| store.particles[k as usize]).collect(),
            rest: order.iter().map(|&k| store.rest[k as usize]).collect(),
            place,
        }
    }
}
