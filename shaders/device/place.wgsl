// After an expansion has counted: how many items come before those of each group (an exclusive prefix sum), the list of those for which
// there is room (`run.value`), and how many have room and have none. One group does it all, as in `scan`.

@group(0) @binding(0) var<storage, read_write> headers: array<Header>;
@group(0) @binding(1) var<storage, read_write> places: array<Places>;
@group(0) @binding(2) var<uniform> run: Run;
@group(0) @binding(3) var<storage, read_write> counts: array<u32>;

@compute @workgroup_size(GROUP)
fn main(@builtin(local_invocation_index) lane: u32) {
    var len = run.len;
    if run.list != RANGE {
        len = headers[run.list].len;
    }
    let n_groups = (len + GROUP - 1u) / GROUP;
    let stretch = (n_groups + GROUP - 1u) / GROUP;
    let first = min(lane * stretch, n_groups);
    let end = min(first + stretch, n_groups);
    var sum = 0u;
    for (var g = first; g < end; g++) {
        sum = saturating(sum, places[g].sum);
    }
    var before = sum_before(lane, sum);
    for (var g = first; g < end; g++) {
        places[g].before = before;
        before = saturating(before, places[g].sum);
    }
    if lane == GROUP - 1u {
        let n = min(sums[lane], run.value);
        headers[run.selected] = header(n);
        counts[0] = saturating(counts[0], n);
        counts[1] = saturating(counts[1], sums[lane] - n);
    }
}
