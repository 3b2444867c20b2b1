// One projection of XPBD for each constraint. See correct.rs.

@group(0) @binding(3) var<uniform> params: Xpbd;
@group(1) @binding(0) var<storage, read> particles: array<array<u32, N>>;
@group(1) @binding(1) var<storage, read> rest: array<Rest>;
@group(1) @binding(2) var<storage, read_write> q: array<vec4<f32>>;
@group(1) @binding(3) var<storage, read_write> lambdas: array<vec4<f32>>;

fn scatter(k: u32) {
    var found = correct(rest[k], params, weighted_corners(k), lambdas[k]);
    lambdas[k] = found.lambda;
    for (var slot = 0u; slot < N; slot++) {
        let particle = particles[k][slot];
        // What is pinned may be shared.
        if q[particle].w > 0.0 {
            q[particle] += vec4(found.moves[slot], 0.0);
        }
    }
}
