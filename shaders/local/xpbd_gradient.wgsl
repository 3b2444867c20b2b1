// w C ∇C of the constraints of a particle. See xpbd_gradient.rs.

@group(1) @binding(0) var<storage, read> offsets: array<u32>;
@group(1) @binding(1) var<storage, read> slots: array<u32>;
@group(1) @binding(2) var<storage, read> particles: array<array<u32, N>>;
@group(1) @binding(3) var<storage, read> rest: array<Rest>;
@group(1) @binding(4) var<storage, read> q: array<vec4<f32>>;
@group(1) @binding(5) var<storage, read_write> gradients: array<vec4<f32>>;

fn map(i: u32) {
    var sum = gradients[i].xyz;
    for (var e = offsets[i]; e < offsets[i + 1u]; e++) {
        let k = slots[e] / N;
        var found = deviation(rest[k], corners(k));
        sum += found.gradient[slots[e] % N] * (weight(rest[k]) * found.c);
    }
    gradients[i] = vec4(sum, 0.0);
}
