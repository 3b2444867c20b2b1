//! A set of colors as bits.

/// The colors around one vertex. One word where there are at most 64, as on every mesh.
#[derive(Debug)]
pub(crate) struct ColorSet {
    words: Vec<u64>,
}

impl ColorSet {
    /// For colors below `n_colors`.
    pub(crate) fn new(n_colors: u32) -> Self {
        Self { words: vec![0; n_colors as usize / 64 + 1] }
    }

    /// Becomes the colors of `neighbors`, all below `n_colors`.
    #[inline]
    pub(crate) fn look(&mut self, neighbors: &[u32], colors: &[u32]) {
        if let [word] = &mut *self.words {
            *word = neighbors.iter().fold(0, |used, &u| used | 1_u64.wrapping_shl(colors[u as usize]));
            return;
        }
        self.words.fill(0);
        for &u in neighbors {
            let c = colors[u as usize];
            self.words[c as usize / 64] |= 1 << (c % 64);
        }
    }

    #[inline]
    pub(crate) fn contains(&self, c: u32) -> bool {
        self.words[c as usize / 64] >> (c % 64) & 1 == 1
    }
}
