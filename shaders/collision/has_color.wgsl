// One color of many. See has_color.rs.

struct Params {
    color: u32,
}

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read_write> colors: array<u32>;

fn select_element(i: u32) -> bool {
    return colors[i] == params.color;
}
