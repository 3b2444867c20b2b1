//! What a coloring is.

use rayon::prelude::*;
use vivace_graph::{Adjacency, Csr};

use crate::certificate::index;
use crate::{Certificate, Violation};

/// A color for every vertex, below `n_colors`; neighbors differ. Every color is used, until [`crate::recolor`] empties a class.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Coloring {
    colors: Vec<u32>,
    n_colors: u32,
}

impl Coloring {
    /// Checks foreign colors and makes them a coloring; colors are renumbered, in order, where some are unused. O(n + m).
    ///
    /// # Errors
    /// The first vertex without a color, or the first edge whose ends have one color.
    pub fn new(graph: &impl Adjacency, colors: Vec<u32>) -> Result<Self, Violation> {
        Certificate::check(graph, &colors)?;
        Ok(Self::compacted(colors))
    }

    /// From proper colors that leave no number out, as first fit makes them.
    pub(crate) fn dense(colors: Vec<u32>) -> Self {
        let n_colors = colors.iter().copied().max().map_or(0, |c| c + 1);
        debug_assert!(class_sizes(&colors, n_colors).iter().all(|&size| size > 0), "a color is unused");
        Self { colors, n_colors }
    }

    /// From colors that are proper by the way they were made. O(n).
    pub(crate) fn compacted(colors: Vec<u32>) -> Self {
        let n_ids = colors.iter().copied().max().map_or(0, |c| c + 1);
        let sizes = class_sizes(&colors, n_ids);
        Self::numbered(colors, sizes)
    }

    /// From proper colors and their class sizes: numbers that are not in use are closed up.
    pub(crate) fn numbered(mut colors: Vec<u32>, sizes: Vec<u32>) -> Self {
        let n_ids = index(sizes.len());
        let mut new_id = sizes;
        let mut n_colors = 0;
        for id in &mut new_id {
            let is_used = *id > 0;
            *id = n_colors;
            n_colors += u32::from(is_used);
        }
        if n_colors < n_ids {
            for c in &mut colors {
                *c = new_id[*c as usize];
            }
        }
        Self { colors, n_colors }
    }

    /// Gives `v` a color that none of its neighbors has.
    pub(crate) fn set(&mut self, v: u32, color: u32) {
        self.colors[v as usize] = color;
        self.n_colors = self.n_colors.max(color + 1);
    }

    /// Color of each vertex.
    pub fn colors(&self) -> &[u32] {
        &self.colors
    }

    /// Number of colors.
    pub fn n_colors(&self) -> u32 {
        self.n_colors
    }

    /// Vertices of each color. O(n).
    pub fn class_sizes(&self) -> Vec<u32> {
        class_sizes(&self.colors, self.n_colors)
    }

    /// Size of the largest class over the mean size: 1 where all are equal, which is what a parallel sweep wants.
    pub fn balance(&self) -> f64 {
        let largest = self.class_sizes().into_iter().max().unwrap_or(0);
        if largest == 0 {
            1.0
        } else {
            f64::from(largest) * f64::from(self.n_colors) / self.colors.len() as f64
        }
    }

    /// The vertices, class by class. O(n).
    pub fn partitions(&self) -> Partitions {
        Partitions { classes: Csr::group_by(self.n_colors as usize, &self.colors) }
    }

    /// Gives the colors away.
    pub fn into_colors(self) -> Vec<u32> {
        self.colors
    }
}

/// The classes C_1, …, C_p of a coloring (Algorithm 1, line 2): every vertex once, each class ascending.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Partitions {
    classes: Csr,
}

impl Partitions {
    /// Number of classes.
    pub fn n_colors(&self) -> usize {
        self.classes.n_rows()
    }

    /// The vertices of one color.
    ///
    /// # Panics
    /// When `color` is not below `n_colors()`.
    pub fn class(&self, color: u32) -> &[u32] {
        self.classes.row(color)
    }

    /// The classes as compressed rows.
    pub fn csr(&self) -> &Csr {
        &self.classes
    }
}

/// How many of `colors` are 0, 1, …, `n_colors` - 1.
pub(crate) fn class_sizes(colors: &[u32], n_colors: u32) -> Vec<u32> {
    const PIECE: usize = 1 << 16;
    let count = |colors: &[u32]| {
        // Four counts at a time: neighbors in the numbering often have the same color, and one count would wait for the other.
        let mut sizes = vec![[0_u32; 4]; n_colors as usize];
        for four in colors.chunks(4) {
            for (k, &c) in four.iter().enumerate() {
                sizes[c as usize][k] += 1;
            }
        }
        sizes.into_iter().map(|four| four.iter().sum()).collect()
    };
    let add = |a: Vec<u32>, b: Vec<u32>| a.into_iter().zip(b).map(|(a, b)| a + b).collect();
    if colors.len() < 2 * PIECE {
        count(colors)
    } else {
        colors.par_chunks(PIECE).map(count).reduce_with(add).unwrap_or_default()
    }
}
