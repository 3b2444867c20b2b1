// How many elements of each group have each key. `run.value` elements, `run.len` keys.

@group(0) @binding(0) var<storage, read> keys: array<u32>;
@group(0) @binding(1) var<storage, read_write> counts: array<u32>;
@group(0) @binding(2) var<uniform> run: Run;

var<workgroup> found: array<atomic<u32>, MOST_KEYS>;

@compute @workgroup_size(GROUP)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let g = group_index(group);
    let i = g * GROUP + lane;
    if i < run.value && keys[i] < run.len {
        atomicAdd(&found[keys[i]], 1u);
    }
    workgroupBarrier();
    let n_groups = (run.value + GROUP - 1u) / GROUP;
    if lane < run.len && g < n_groups {
        counts[lane * n_groups + g] = atomicLoad(&found[lane]);
    }
}
