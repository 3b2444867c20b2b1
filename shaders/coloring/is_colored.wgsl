// Leaves the uncolored vertices in the list. See is_colored.rs.

const UNCOLORED = 0xffffffffu;

@group(1) @binding(0) var<storage, read_write> color: array<u32>;

fn select_element(v: u32) -> bool {
    return color[v] != UNCOLORED;
}
