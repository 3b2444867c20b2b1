// Calls `select_element` for each element of the list and notes the decisions. `scan` and `split` carry them out.

@group(0) @binding(4) var<storage, read_write> decisions: array<Decisions>;

var<workgroup> bits: array<atomic<u32>, 8>;

@compute @workgroup_size(GROUP)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let g = group_index(group);
    let k = g * GROUP + lane;
    if k < headers[run.list].len && select_element(element(k)) {
        atomicOr(&bits[lane / 32u], 1u << (lane & 31u));
    }
    workgroupBarrier();
    // The grid is whole rows of groups, the last of them beyond the list.
    if lane < 8u && g * GROUP < headers[run.list].len {
        decisions[g].bits[lane] = atomicLoad(&bits[lane]);
    }
}
