// Calls `scatter` for each element of the list, in any order: no invocation reads or writes what another writes.

@compute @workgroup_size(GROUP)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let k = group_index(group) * GROUP + lane;
    if k < n_elements() {
        scatter(element(k));
    }
}
