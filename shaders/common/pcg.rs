//! Counter-based randomness: a hash of (seed, round, vertex).
//!
//! The 32-bit PCG permutation (O'Neill 2014, RXS-M-XS; as a hash: Jarzynski and Olano 2020). It is a bijection, so under one key
//! no two vertices have the same hash, and "the larger hash wins" never ties.

/// The same in WGSL.
pub const WGSL: &str = include_str!("pcg.wgsl");

/// The permutation.
#[inline]
#[must_use]
pub const fn pcg(input: u32) -> u32 {
    let state = input.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    (word >> 22) ^ word
}

/// The hash of vertex `v` under `key`: a bijection of the vertices for each key.
#[inline]
#[must_use]
pub const fn hash(v: u32, key: u32) -> u32 {
    pcg(v ^ key)
}

/// The key of one round of one seeded run. Computed on the host, once a round.
#[must_use]
pub const fn key(seed: u64, round: u32) -> u32 {
    let [a, b, c, d, e, f, g, h] = seed.to_le_bytes();
    let low = u32::from_le_bytes([a, b, c, d]);
    let high = u32::from_le_bytes([e, f, g, h]);
    pcg(pcg(pcg(low) ^ high).wrapping_add(round))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_values() {
        // Jarzynski and Olano's function, evaluated by hand in 32-bit arithmetic.
        assert_eq!(pcg(0), 129_708_002);
        assert_ne!(key(1, 0), key(0, 1));
        assert_ne!(key(1 << 32, 0), key(1, 0));
    }

    #[test]
    fn is_a_bijection_on_a_sample() {
        let mut seen: Vec<u32> = (0..100_000).map(|v| hash(v, key(7, 3))).collect();
        seen.sort_unstable();
        seen.dedup();
        assert_eq!(seen.len(), 100_000);
    }
}
