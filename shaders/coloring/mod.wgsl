// Which colors the neighbors own, for kernels that bind `offsets`, `neighbors` and `color`. See mod.rs.

fn used_colors(v: u32, base: u32) -> u32 {
    var used = 0u;
    for (var e = offsets[v]; e < offsets[v + 1u]; e++) {
        let c = color[neighbors[e]] - base;
        used |= select(0u, 1u, c < 32u) << (c & 31u);
    }
    return used;
}

fn first_free_color(v: u32, initial: u32) -> u32 {
    var base = initial;
    var used = used_colors(v, base);
    while used == 0xffffffffu {
        base += 32u;
        used = used_colors(v, base);
    }
    return base + countTrailingZeros(~used);
}
