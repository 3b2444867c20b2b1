// The multiplier that goes with the moves of each constraint. See multiply.rs.

@group(0) @binding(3) var<uniform> params: Xpbd;
@group(1) @binding(0) var<storage, read> particles: array<array<u32, N>>;
@group(1) @binding(1) var<storage, read> rest: array<Rest>;
@group(1) @binding(2) var<storage, read> q: array<vec4<f32>>;
@group(1) @binding(3) var<storage, read> busiest: array<f32>;
@group(1) @binding(4) var<storage, read_write> lambdas: array<vec4<f32>>;

fn map(k: u32) {
    let averaged = Xpbd(params.squared_h, params.omega / busiest[k]);
    lambdas[k] = correct(rest[k], averaged, weighted_corners(k), lambdas[k]).lambda;
}
