// Algorithm 2, lines 5-6 and 14-16: an uncolored vertex draws a color from its palette. See propose_color.rs.

struct Params {
    key: u32,
    shrink_q8: u32,
    palette_cap: u32,
}

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read> offsets: array<u32>;
@group(1) @binding(1) var<storage, read> neighbors: array<u32>;
@group(1) @binding(2) var<storage, read> color: array<u32>;
@group(1) @binding(3) var<storage, read_write> proposal: array<u32>;

fn palette_size(degree: u32) -> u32 {
    return min(min((min(degree, (1u << 24u) - 1u) << 8u) / params.shrink_q8 + 1u, degree + 1u), params.palette_cap);
}

fn window(v: u32, palette: u32, base: u32) -> u32 {
    var offered = 0xffffffffu;
    if palette - base < 32u {
        offered = (1u << (palette - base)) - 1u;
    }
    return offered & ~used_colors(v, base);
}

const UNCOLORED = 0xffffffffu;

fn map(v: u32) {
    if color[v] != UNCOLORED {
        return;
    }
    let degree = offsets[v + 1u] - offsets[v];
    let palette = palette_size(degree);
    var free = window(v, palette, 0u);
    var n_free = countOneBits(free);
    var base = 32u;
    while base < palette {
        n_free += countOneBits(window(v, palette, base));
        base += 32u;
    }
    if n_free == 0u {
        proposal[v] = first_free_color(v, palette);
        return;
    }
    var skip = hash(v, params.key) % n_free;
    base = 0u;
    while skip >= countOneBits(free) {
        skip -= countOneBits(free);
        base += 32u;
        free = window(v, palette, base);
    }
    while skip > 0u {
        free &= free - 1u;
        skip -= 1u;
    }
    proposal[v] = base + countTrailingZeros(free);
}
