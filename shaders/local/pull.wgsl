// What the projections of a particle's constraints ask of it. See pull.rs.

@group(1) @binding(0) var<storage, read> offsets: array<u32>;
@group(1) @binding(1) var<storage, read> slots: array<u32>;
@group(1) @binding(2) var<storage, read> rest: array<Rest>;
@group(1) @binding(3) var<storage, read> projected: array<array<vec4<f32>, R>>;
@group(1) @binding(4) var<storage, read_write> pulls: array<vec4<f32>>;

fn map(i: u32) {
    var sum = pulls[i].xyz;
    for (var e = offsets[i]; e < offsets[i + 1u]; e++) {
        let k = slots[e] / N;
        var p: array<vec3<f32>, R>;
        for (var row = 0u; row < R; row++) {
            p[row] = projected[k][row].xyz;
        }
        sum += pull(rest[k], slots[e] % N, p);
    }
    pulls[i] = vec4(sum, 0.0);
}
