// Whether a coloring is one. See lacks_color.rs.

struct Params {
    n_colors: u32,
}

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read> color: array<u32>;
@group(1) @binding(1) var<storage, read_write> counters: array<atomic<u32>>;

fn count_down(v: u32) {
    if color[v] >= params.n_colors {
        take_one(0u);
    }
}
