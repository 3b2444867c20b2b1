// What every run knows: lists and their lengths, in the device's memory, and which of them it is about.

// Invocations in a group, and groups in a row of the grid: 65,535 would be allowed, a power of two divides more cheaply.
const GROUP = 256u;
const ROW = 32768u;

// Most keys of a sort.
const MOST_KEYS = 64u;

// A list of indices: the grid of a run over it, as an indirect dispatch reads it, its length, and where it begins.
struct Header {
    grid: array<u32, 3>,
    len: u32,
    first: u32,
}

// The lists of this run, as places in `headers`.
struct Run {
    list: u32,
    kept: u32,
    selected: u32,
    value: u32,
    // A range: `RANGE` in place of a list, and which.
    first: u32,
    len: u32,
}

const RANGE = 0xffffffffu;

fn header(len: u32) -> Header {
    let n_groups = (len + GROUP - 1u) / GROUP;
    return Header(array<u32, 3>(min(n_groups, ROW), (n_groups + ROW - 1u) / ROW, min(n_groups, 1u)), len, 0u);
}

// Which group of the run this is.
fn group_index(group: vec3<u32>) -> u32 {
    return group.y * ROW + group.x;
}
