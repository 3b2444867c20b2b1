//! Which colors of one block to exchange for one another so that few of its vertices clash with others: blocks out of step.

/// Colors from here on stay as they are.
const N: usize = 16;

/// An exchange of the colors below [`N`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Exchange([u8; N]);

impl Exchange {
    /// Every color stays.
    pub(super) const fn none() -> Self {
        let mut identity = [0; N];
        let mut c = 0;
        while c < N {
            #[expect(clippy::cast_possible_truncation, reason = "below N")]
            {
                identity[c] = c as u8;
            }
            c += 1;
        }
        Self(identity)
    }

    pub(super) fn is_none(&self) -> bool {
        *self == Self::none()
    }

    #[inline]
    pub(super) fn apply(&self, color: u32) -> u32 {
        self.0.get(color as usize).map_or(color, |&c| u32::from(c))
    }
}

/// An exchange of the colors below `n_colors` under which few of the pairs `[other's color, own color]` become alike: from no exchange on, the best swap of two
/// colors again and again, as long as there is one that helps. None, unless it ends most clashes: where first fit lays no pattern,
/// its preference for low colors is worth more.
pub(super) fn best_exchange(pairs: impl Iterator<Item = [u32; 2]>, n_colors: u32) -> Exchange {
    let mut clashes = [[0_i64; N]; N]; // [own][other]
    for [other, own] in pairs {
        if let Some(count) = clashes.get_mut(own as usize).and_then(|row| row.get_mut(other as usize)) {
            *count += 1;
        }
    }
    let n_clashes: i64 = (0..N).map(|c| clashes[c][c]).sum();
    if 4 * n_clashes <= clashes.as_flattened().iter().sum() {
        return Exchange::none();
    }
    let n_colors = N.min(n_colors as usize);
    let mut exchange = Exchange::none();
    loop {
        let cost = |own: usize, to: u8| clashes[own][to as usize];
        let mut best = (0, 0, 0);
        for a in 0..n_colors {
            for b in a + 1..n_colors {
                let (to_a, to_b) = (exchange.0[a], exchange.0[b]);
                let gain = cost(a, to_a) + cost(b, to_b) - cost(a, to_b) - cost(b, to_a);
                if gain > best.0 {
                    best = (gain, a, b);
                }
            }
        }
        if best.0 == 0 {
            return exchange;
        }
        exchange.0.swap(best.1, best.2);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_out_of_step_are_brought_into_step() {
        // Rows alternate between colors {0, 1} and {2, 3}; the border puts {0, 1} below {0, 1}.
        let border = [[0, 0], [1, 0], [1, 1], [0, 1]].into_iter().cycle().take(400);
        let exchange = best_exchange(border.clone(), 4);
        assert!(border.into_iter().all(|[other, own]| exchange.apply(own) != other));
        assert_eq!(exchange.apply(99), 99);
    }

    #[test]
    fn nothing_is_exchanged_without_need() {
        assert!(best_exchange([[0, 1], [1, 2], [2, 0]].into_iter(), 3).is_none());
        assert!(best_exchange(std::iter::empty(), 0).is_none());
    }
}
