//! A coloring that follows a changing graph and does not wander off.

use std::collections::BTreeSet;

use vivace_graph::Adjacency;

use crate::certificate::index;
use crate::coloring::class_sizes;
use crate::serial::Palette;
use crate::{Certificate, Coloring, Violation};

/// A coloring under insertion and removal of edges that stays as near as it can to the one it began with, *home*.
///
/// [`recolor`](crate::recolor) mends what a change made improper, and never gives a color back. This does: a vertex is away from home only
/// while it has a neighbor of the same home color that is not, and away it has no color while a smaller one is free. So there are
/// never more colors than home has, or than the largest degree of a vertex that is away, plus one; and once the graph is what it was at
/// the beginning, so is the coloring; however many changes came before.
///
/// The answer depends on the edges that come and go, not on their order within the graph's rows, nor on threads.
#[derive(Debug, Clone)]
pub struct Follower {
    home: Vec<u32>,
    colors: Vec<u32>,
    /// Vertices of each color.
    sizes: Vec<u32>,
    away: BTreeSet<u32>,
    palette: Palette,
}

/// What a change took.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct FollowWork {
    /// How often a vertex got another color.
    pub recolored: usize,
    /// Vertices whose neighbors were looked at, and how many neighbors those were.
    pub visited: [usize; 2],
}

impl Follower {
    /// Begins at `home`.
    #[must_use]
    pub fn new(home: &Coloring) -> Self {
        let colors = home.colors().to_vec();
        let sizes = class_sizes(&colors, home.n_colors());
        let (away, palette) = (BTreeSet::new(), Palette::new());
        Self { home: colors.clone(), colors, sizes, away, palette }
    }

    /// Color of each vertex.
    #[must_use]
    pub fn colors(&self) -> &[u32] {
        &self.colors
    }

    /// One more than the largest color in use.
    #[must_use]
    pub fn n_colors(&self) -> u32 {
        index(self.sizes.iter().rposition(|&size| size > 0).map_or(0, |last| last + 1))
    }

    /// The vertices that do not have the color they began with, ascending.
    pub fn away(&self) -> impl Iterator<Item = u32> {
        self.away.iter().copied()
    }

    /// Takes the colors of these vertices instead of those at home: what [`Follower::away`] and [`Follower::colors`] once said.
    ///
    /// # Errors
    /// They are no coloring of `graph`; nothing has changed.
    ///
    /// # Panics
    /// When a vertex is not there.
    pub fn set_away(&mut self, graph: &impl Adjacency, colors: &[(u32, u32)]) -> Result<(), Violation> {
        let mut taken = self.home.clone();
        colors.iter().for_each(|&(v, color)| taken[v as usize] = color);
        Certificate::check(graph, &taken)?;
        let n_colors = taken.iter().copied().max().map_or(0, |most| most + 1);
        self.sizes = class_sizes(&taken, n_colors);
        self.away =
            (0..).zip(taken.iter().zip(&self.home)).filter(|(_, (a, b))| a != b).map(|(v, _)| v).collect();
        self.colors = taken;
        Ok(())
    }

    /// Follows `graph`, which has just lost the edges `removed` and got `inserted`. Work in proportion to them and to the degrees
    /// of their ends.
    ///
    /// # Panics
    /// When an edge names a vertex that is not there.
    pub fn update(
        &mut self,
        graph: &impl Adjacency,
        removed: &[[u32; 2]],
        inserted: &[[u32; 2]],
    ) -> FollowWork {
        let mut work = FollowWork::default();
        let mut restless: BTreeSet<u32> =
            removed.iter().flatten().copied().filter(|v| self.away.contains(v)).collect();
        // Who may go home does so before it is in the way of what is new.
        self.settle_all(graph, &mut restless, &mut work);
        for &[u, v] in inserted {
            if self.colors[u as usize] == self.colors[v as usize] {
                // Who is away already; else who has fewer neighbors; of equals the higher.
                let rank = |w: u32| (!self.away.contains(&w), graph.degree(w), std::cmp::Reverse(w));
                let w = std::cmp::min_by_key(u, v, |&w| rank(w));
                self.settle(graph, w, &mut restless, &mut work);
            }
        }
        self.settle_all(graph, &mut restless, &mut work);
        work
    }

    /// Colors all of `graph` anew: first fit over those who clash at home. What [`Follower::update`] saves.
    pub fn anew(&mut self, graph: &impl Adjacency) -> FollowWork {
        let before = std::mem::replace(&mut self.colors, self.home.clone());
        let mut work = FollowWork::default();
        self.away.clear();
        for v in 0..index(self.home.len()) {
            let neighbors = graph.neighbors(v);
            work.visited[0] += 1;
            work.visited[1] += neighbors.len();
            if neighbors.iter().any(|&u| u < v && self.colors[u as usize] == self.colors[v as usize]) {
                self.colors[v as usize] = self.palette.first_free(neighbors, &self.colors);
                self.away.insert(v);
            }
        }
        work.recolored = before.iter().zip(&self.colors).filter(|(a, b)| a != b).count();
        let n_colors = self.colors.iter().copied().max().map_or(0, |most| most + 1);
        self.sizes = class_sizes(&self.colors, n_colors);
        work
    }

    fn settle_all(&mut self, graph: &impl Adjacency, restless: &mut BTreeSet<u32>, work: &mut FollowWork) {
        while let Some(v) = restless.pop_first() {
            self.settle(graph, v, restless, work);
        }
    }

    /// Gives `v` its home color, which only those who are at home themselves may keep from it; else the smallest that is free.
    /// Remembers whom that drives out, and whom it may let go home, or to a smaller color. Each time somebody goes home there is one
    /// less who may be driven out, so that this ends.
    fn settle(
        &mut self,
        graph: &impl Adjacency,
        v: u32,
        restless: &mut BTreeSet<u32>,
        work: &mut FollowWork,
    ) {
        let (old, home) = (self.colors[v as usize], self.home[v as usize]);
        let neighbors = graph.neighbors(v);
        work.visited[0] += 1;
        work.visited[1] += neighbors.len();
        let is_settled = |u: u32| self.home[u as usize] == home && self.colors[u as usize] == home;
        let is_home_free = !neighbors.iter().any(|&u| is_settled(u));
        let new = if is_home_free { home } else { self.palette.first_free(neighbors, &self.colors) };
        if new == old {
            return;
        }
        work.recolored += 1;
        self.colors[v as usize] = new;
        self.sizes.resize(self.sizes.len().max(new as usize + 1), 0);
        self.sizes[old as usize] -= 1;
        self.sizes[new as usize] += 1;
        if new == home {
            self.away.remove(&v)
        } else {
            self.away.insert(v)
        };
        let is_concerned = |&u: &u32| {
            let color = self.colors[u as usize];
            old < color || old == self.home[u as usize] || new == color
        };
        restless.extend(neighbors.iter().copied().filter(|u| self.away.contains(u)).filter(is_concerned));
    }
}
