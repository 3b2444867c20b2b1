// By how much every constraint would move its particles from the same positions. See moves.rs.

@group(0) @binding(3) var<uniform> params: Xpbd;
@group(1) @binding(0) var<storage, read> particles: array<array<u32, N>>;
@group(1) @binding(1) var<storage, read> rest: array<Rest>;
@group(1) @binding(2) var<storage, read> q: array<vec4<f32>>;
@group(1) @binding(3) var<storage, read> busiest: array<f32>;
@group(1) @binding(4) var<storage, read> lambdas: array<vec4<f32>>;
@group(1) @binding(5) var<storage, read_write> moves: array<array<vec4<f32>, N>>;

fn map(k: u32) {
    let averaged = Xpbd(params.squared_h, params.omega / busiest[k]);
    var found = correct(rest[k], averaged, weighted_corners(k), lambdas[k]);
    for (var slot = 0u; slot < N; slot++) {
        moves[k][slot] = vec4(found.moves[slot], 0.0);
    }
}
