// After a select: how many were selected in the groups before each (an exclusive prefix sum), and the lengths of both new lists.
// One group does it all: each invocation adds up a stretch of the groups, and the stretches are added up in shared memory.

@group(0) @binding(0) var<storage, read_write> headers: array<Header>;
@group(0) @binding(1) var<storage, read_write> decisions: array<Decisions>;
@group(0) @binding(2) var<uniform> run: Run;

fn n_selected(g: u32) -> u32 {
    var n = 0u;
    for (var w = 0u; w < 8u; w++) {
        n += countOneBits(decisions[g].bits[w]);
    }
    return n;
}

@compute @workgroup_size(GROUP)
fn main(@builtin(local_invocation_index) lane: u32) {
    let len = headers[run.list].len;
    let n_groups = (len + GROUP - 1u) / GROUP;
    let stretch = (n_groups + GROUP - 1u) / GROUP;
    let first = min(lane * stretch, n_groups);
    let end = min(first + stretch, n_groups);
    var sum = 0u;
    for (var g = first; g < end; g++) {
        let n = n_selected(g);
        decisions[g].before = sum;
        sum += n;
    }
    let before = sum_before(lane, sum);
    for (var g = first; g < end; g++) {
        decisions[g].before += before;
    }
    if lane == GROUP - 1u {
        headers[run.selected] = header(sums[lane]);
        headers[run.kept] = header(len - sums[lane]);
    }
}
