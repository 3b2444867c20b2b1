// What the constraints of a particle move it by. See gather.rs.

@group(1) @binding(0) var<storage, read> offsets: array<u32>;
@group(1) @binding(1) var<storage, read> slots: array<u32>;
@group(1) @binding(2) var<storage, read> moves: array<array<vec4<f32>, N>>;
@group(1) @binding(3) var<storage, read_write> q: array<vec4<f32>>;

fn map(i: u32) {
    var sum = vec4(0.0);
    for (var e = offsets[i]; e < offsets[i + 1u]; e++) {
        sum += moves[slots[e] / N][slots[e] % N];
    }
    q[i] += sum;
}
