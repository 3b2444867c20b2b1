//! Disjoint sets (Galler and Fischer 1964).

/// Which of `0..n` are together.
#[derive(Debug, Clone, Default)]
pub struct DisjointSets {
    /// Towards the smallest of the set.
    parents: Vec<u32>,
}

impl DisjointSets {
    /// Each of `0..n` on its own.
    #[must_use]
    pub fn new(n: u32) -> Self {
        Self { parents: (0..n).collect() }
    }

    /// Makes each of `0..n` one on its own again; allocates only where there are more than ever before.
    pub fn reset(&mut self, n: u32) {
        self.parents.clear();
        self.parents.extend(0..n);
    }

    /// The smallest of the set of `v`.
    ///
    /// # Panics
    /// If there is no `v`.
    pub fn first(&mut self, mut v: u32) -> u32 {
        while self.parents[v as usize] != v {
            let next = self.parents[self.parents[v as usize] as usize];
            self.parents[v as usize] = next;
            v = next;
        }
        v
    }

    /// Makes one of the sets of `u` and `v`.
    ///
    /// # Panics
    /// If there is no `u` or `v`.
    pub fn unite(&mut self, u: u32, v: u32) {
        let (a, b) = (self.first(u), self.first(v));
        self.parents[a.max(b) as usize] = a.min(b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_united_has_one_first() {
        let mut sets = DisjointSets::new(7);
        for [u, v] in [[5, 6], [2, 4], [4, 6], [0, 1]] {
            sets.unite(u, v);
        }
        assert_eq!([0, 1, 2, 3, 4, 5, 6].map(|v| sets.first(v)), [0, 0, 2, 3, 2, 2, 2]);
        sets.reset(2);
        assert_eq!([0, 1].map(|v| sets.first(v)), [0, 1]);
    }
}
