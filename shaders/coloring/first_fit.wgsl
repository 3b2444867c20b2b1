// The smallest color that no neighbor owns. See first_fit.rs.

@group(1) @binding(0) var<storage, read> offsets: array<u32>;
@group(1) @binding(1) var<storage, read> neighbors: array<u32>;
@group(1) @binding(2) var<storage, read_write> color: array<u32>;

fn update(v: u32) {
    color[v] = first_free_color(v, 0u);
}
