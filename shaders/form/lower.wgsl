// Calls `lower` for each element of the list. The minimum commutes: order does not show.

fn lower_to(i: u32, value: u32) {
    atomicMin(&lowest[i], value);
}

@compute @workgroup_size(GROUP)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let k = group_index(group) * GROUP + lane;
    if k < n_elements() {
        lower(element(k));
    }
}
