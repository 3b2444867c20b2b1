// The same from the latest positions. See pull_fused.rs.

@group(1) @binding(0) var<storage, read> offsets: array<u32>;
@group(1) @binding(1) var<storage, read> slots: array<u32>;
@group(1) @binding(2) var<storage, read> particles: array<array<u32, N>>;
@group(1) @binding(3) var<storage, read> rest: array<Rest>;
@group(1) @binding(4) var<storage, read> q: array<vec4<f32>>;
@group(1) @binding(5) var<storage, read_write> pulls: array<vec4<f32>>;

fn map(i: u32) {
    var sum = pulls[i].xyz;
    for (var e = offsets[i]; e < offsets[i + 1u]; e++) {
        let k = slots[e] / N;
        let c = rest[k];
        sum += pull(c, slots[e] % N, project(c, apply(c, corners(k))));
    }
    pulls[i] = vec4(sum, 0.0);
}
