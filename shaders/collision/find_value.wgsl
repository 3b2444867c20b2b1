// Who has a value. See find_value.rs.

struct Params {
    value: u32,
}

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read> values: array<u32>;
@group(1) @binding(1) var<storage, read_write> found: array<u32>;

fn expand(i: u32) {
    if values[i] == params.value {
        let place = next_place();
        if place < arrayLength(&found) {
            found[place] = i;
        }
    }
}
