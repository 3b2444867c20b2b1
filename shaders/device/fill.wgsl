// An array of `run.value` words: a value of `run.list` words, over and over.

@group(0) @binding(0) var<storage, read_write> words: array<u32>;
@group(0) @binding(1) var<uniform> run: Run;
@group(0) @binding(2) var<uniform> value: array<vec4<u32>, 4>;

@compute @workgroup_size(GROUP)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let i = group_index(group) * GROUP + lane;
    if i < run.value {
        let word = i % run.list;
        words[i] = value[word / 4u][word % 4u];
    }
}
