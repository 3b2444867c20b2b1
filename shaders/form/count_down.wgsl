// Calls `count_down` for each element of the list. Subtraction commutes, and a counter stops at 0: order does not show.

fn take_one(counter: u32) {
    var value = atomicLoad(&counters[counter]);
    loop {
        if value == 0u {
            return;
        }
        let result = atomicCompareExchangeWeak(&counters[counter], value, value - 1u);
        if result.exchanged {
            return;
        }
        value = result.old_value;
    }
}

@compute @workgroup_size(GROUP)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let k = group_index(group) * GROUP + lane;
    if k < n_elements() {
        count_down(element(k));
    }
}
