// After a select and its scan: each element of the list goes to its place in one of the new lists; both keep their order.

@group(0) @binding(0) var<storage, read> headers: array<Header>;
@group(0) @binding(1) var<storage, read> list: array<u32>;
@group(0) @binding(2) var<uniform> run: Run;
@group(1) @binding(0) var<storage, read> decisions: array<Decisions>;
@group(1) @binding(1) var<storage, read_write> kept: array<u32>;
@group(1) @binding(2) var<storage, read_write> selected: array<u32>;

@compute @workgroup_size(GROUP)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let g = group_index(group);
    let k = g * GROUP + lane;
    if k >= headers[run.list].len {
        return;
    }
    let i = list[headers[run.list].first + k];
    let word = decisions[g].bits[lane / 32u];
    let bit = 1u << (lane & 31u);
    var before = decisions[g].before + countOneBits(word & (bit - 1u));
    for (var w = 0u; w < lane / 32u; w++) {
        before += countOneBits(decisions[g].bits[w]);
    }
    if (word & bit) != 0u {
        selected[before] = i;
    } else {
        kept[k - before] = i;
    }
}
