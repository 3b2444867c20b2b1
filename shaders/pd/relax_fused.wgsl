// Lines 5 to 7 for a particle whose constraints are springs and flat hinges. See relax_fused.rs.

struct Params {
    omega: f32,
}

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read> rows: array<Row>;
@group(1) @binding(1) var<storage, read> taps: array<Tap>;
@group(1) @binding(2) var<storage, read> spring_pulls: array<f32>;
@group(1) @binding(3) var<storage, read> anchors: array<vec4<f32>>;
@group(1) @binding(4) var<storage, read_write> q: array<vec4<f32>>;

fn update(i: u32) {
    q[i] = vec4(q[i].xyz + fused(i) * rows[i].inverse_diagonal * eased(params.omega, anchors[i]), q[i].w);
}
