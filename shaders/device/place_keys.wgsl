// After a scan: each element goes to its place among those of its key, in ascending order.

@group(0) @binding(0) var<storage, read> keys: array<u32>;
@group(0) @binding(1) var<storage, read> counts: array<u32>;
@group(0) @binding(2) var<storage, read_write> list: array<u32>;
@group(0) @binding(3) var<uniform> run: Run;

// A bit for each element of the group, key by key.
var<workgroup> bits: array<atomic<u32>, 8u * MOST_KEYS>;

@compute @workgroup_size(GROUP)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let g = group_index(group);
    let i = g * GROUP + lane;
    var key = run.len;
    if i < run.value {
        key = keys[i];
    }
    let bit = 1u << (lane & 31u);
    if key < run.len {
        atomicOr(&bits[8u * key + lane / 32u], bit);
    }
    workgroupBarrier();
    if key < run.len {
        var before = countOneBits(atomicLoad(&bits[8u * key + lane / 32u]) & (bit - 1u));
        for (var w = 0u; w < lane / 32u; w++) {
            before += countOneBits(atomicLoad(&bits[8u * key + w]));
        }
        list[counts[key * ((run.value + GROUP - 1u) / GROUP) + g] + before] = i;
    }
}
