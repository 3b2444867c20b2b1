// Another coloring, where the first is none. See color_instead.rs.

@group(1) @binding(0) var<storage, read> counters: array<u32>;
@group(1) @binding(1) var<storage, read> instead: array<u32>;
@group(1) @binding(2) var<storage, read_write> color: array<u32>;

fn map(v: u32) {
    if counters[0] == 0u {
        color[v] = instead[v];
    }
}
