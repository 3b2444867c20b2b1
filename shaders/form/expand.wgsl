// Calls `expand` for each element of the list, twice: to count what it finds (`run.value` is 0), and, after `place`, to write it.

@group(0) @binding(4) var<storage, read_write> places: array<Places>;

var<private> n_found: u32;
var<private> first: u32;

// Where the next item goes: past the end of all arrays while it is only counted.
fn next_place() -> u32 {
    n_found += 1u;
    if run.value == 0u {
        return NOWHERE;
    }
    return first + n_found - 1u;
}

@compute @workgroup_size(GROUP)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let g = group_index(group);
    let k = g * GROUP + lane;
    let n = n_elements();
    if k < n {
        first = saturating(places[g].before, places[g].within[lane]);
        expand(element(k));
    }
    if run.value != 0u {
        return;
    }
    let before = sum_before(lane, n_found);
    // The grid is whole rows of groups, the last of them beyond the list.
    if g * GROUP < n {
        places[g].within[lane] = before;
        if lane == GROUP - 1u {
            places[g].sum = sums[lane];
        }
    }
}
