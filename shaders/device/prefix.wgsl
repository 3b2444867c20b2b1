// Prefix sums over the invocations of a group.

var<workgroup> sums: array<u32, GROUP>;

// The sum over the invocations before this one, all of which call it; `sums` holds what is summed up to each, itself included.
fn sum_before(lane: u32, own: u32) -> u32 {
    sums[lane] = own;
    workgroupBarrier();
    for (var step = 1u; step < GROUP; step *= 2u) {
        var left = 0u;
        if lane >= step {
            left = sums[lane - step];
        }
        workgroupBarrier();
        sums[lane] += left;
        workgroupBarrier();
    }
    return sums[lane] - own;
}
