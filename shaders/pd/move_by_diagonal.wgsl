// A particle moves by its residual over the diagonal of Y. See move_by_diagonal.rs.

struct Params {
    omega: f32,
}

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read> rows: array<Row>;
@group(1) @binding(1) var<storage, read> residuals: array<vec4<f32>>;
@group(1) @binding(2) var<storage, read> anchors: array<vec4<f32>>;
@group(1) @binding(3) var<storage, read_write> q: array<vec4<f32>>;

fn map(i: u32) {
    q[i] = vec4(q[i].xyz + residuals[i].xyz * rows[i].inverse_diagonal * eased(params.omega, anchors[i]), q[i].w);
}
