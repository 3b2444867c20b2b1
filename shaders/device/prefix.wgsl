// Prefix sums over the invocations of a group. Sums stay below `NOWHERE`.

const NOWHERE = 0xffffffffu;

var<workgroup> sums: array<u32, GROUP>;

fn saturating(a: u32, b: u32) -> u32 {
    return a + min(b, NOWHERE - 1u - min(a, NOWHERE - 1u));
}

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
        sums[lane] = saturating(sums[lane], left);
        workgroupBarrier();
    }
    // Not what is left of its own: a sum may have stopped.
    if lane == 0u {
        return 0u;
    }
    return sums[lane - 1u];
}
