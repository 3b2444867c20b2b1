// The list of the `run.value` indices from `run.first` on.

@group(0) @binding(0) var<storage, read_write> headers: array<Header>;
@group(0) @binding(1) var<storage, read_write> list: array<u32>;
@group(0) @binding(2) var<uniform> run: Run;

@compute @workgroup_size(GROUP)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let i = group_index(group) * GROUP + lane;
    if i == 0u {
        headers[run.list] = header(run.value);
    }
    if i < run.value {
        list[i] = run.first + i;
    }
}
