// The rows of Y. See mod.rs.

// Rows that lie side by side, entry by entry.
const SLICE = 32u;

struct Row {
    first: u32,
    n_springs: u32,
    n: u32,
    inverse_diagonal: f32,
}

struct Tap {
    column: u32,
    weight: f32,
}

struct Spring {
    pull: f32,
    stiffness: f32,
    compliance: f32,
    linear: f32,
}

// Coincident particles have no direction, but they have a length.
fn guarded(squared: f32) -> f32 {
    return max(squared, 1e-36);
}

// No over-relaxation of what contacts have moved.
fn eased(omega: f32, anchor: vec4<f32>) -> f32 {
    return select(omega, min(omega, 1.0), anchor.w < 0.0);
}
