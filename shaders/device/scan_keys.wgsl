// After a count: where the elements of each group with each key begin (an exclusive prefix sum, key by key), and the lists of the keys.
// One group does it all, as in scan.wgsl.

@group(0) @binding(0) var<storage, read_write> headers: array<Header>;
@group(0) @binding(1) var<storage, read_write> counts: array<u32>;
@group(0) @binding(2) var<uniform> run: Run;
// The place of each key's header.
@group(0) @binding(3) var<uniform> places: array<vec4<u32>, MOST_KEYS / 4u>;

@compute @workgroup_size(GROUP)
fn main(@builtin(local_invocation_index) lane: u32) {
    let n_groups = (run.value + GROUP - 1u) / GROUP;
    let n = run.len * n_groups;
    let stretch = (n + GROUP - 1u) / GROUP;
    let first = min(lane * stretch, n);
    let end = min(first + stretch, n);
    var sum = 0u;
    for (var k = first; k < end; k++) {
        let count = counts[k];
        counts[k] = sum;
        sum += count;
    }
    let before = sum_before(lane, sum);
    for (var k = first; k < end; k++) {
        counts[k] += before;
    }
    storageBarrier();
    workgroupBarrier();
    if lane < run.len {
        // Where there is no group there is no count.
        var begin = 0u;
        if n_groups > 0u {
            begin = counts[lane * n_groups];
        }
        var next = sums[GROUP - 1u];
        if n_groups > 0u && lane + 1u < run.len {
            next = counts[(lane + 1u) * n_groups];
        }
        var listed = header(next - begin);
        listed.first = begin;
        headers[places[lane / 4u][lane % 4u]] = listed;
    }
}
