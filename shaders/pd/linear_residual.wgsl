// `b − Y q` with all projections apart. See linear_residual.rs.

@group(1) @binding(0) var<storage, read> rows: array<Row>;
@group(1) @binding(1) var<storage, read> taps: array<Tap>;
@group(1) @binding(2) var<storage, read> anchors: array<vec4<f32>>;
@group(1) @binding(3) var<storage, read> pulls: array<vec4<f32>>;
@group(1) @binding(4) var<storage, read> q: array<vec4<f32>>;
@group(1) @binding(5) var<storage, read_write> residuals: array<vec4<f32>>;

fn map(i: u32) {
    residuals[i] = vec4(linear(i), 0.0);
}
