// What the safeguard knows between two looks. See decide.rs.

struct Watch {
    lowest: f32,
    kept: f32,
    level: u32,
    quiet_steps: u32,
    began_at: u32,
    n_backoffs: u32,
    has_backed_off: u32,
    is_back: u32,
}
