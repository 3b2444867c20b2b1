// Counter-based randomness: a hash of (seed, round, vertex). See pcg.rs; the key of a round comes from the host.

fn pcg(input: u32) -> u32 {
    let state = input * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

fn hash(v: u32, key: u32) -> u32 {
    return pcg(v ^ key);
}
