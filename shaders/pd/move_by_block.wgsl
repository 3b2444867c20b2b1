// A particle moves by its residual and its own block of the Hessian. See move_by_block.rs.

struct Block {
    diagonal: vec4<f32>,
    off: vec4<f32>,
}

struct Params {
    omega: f32,
}

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read> rows: array<Row>;
@group(1) @binding(1) var<storage, read> residuals: array<vec4<f32>>;
@group(1) @binding(2) var<storage, read> anchors: array<vec4<f32>>;
@group(1) @binding(3) var<storage, read> blocks: array<Block>;
@group(1) @binding(4) var<storage, read_write> q: array<vec4<f32>>;

fn map(i: u32) {
    let residual = residuals[i].xyz;
    let fallback = residual * rows[i].inverse_diagonal;
    let step = solved(blocks[i].diagonal.xyz, blocks[i].off.xyz, residual, fallback);
    q[i] = vec4(q[i].xyz + step * eased(params.omega, anchors[i]), q[i].w);
}
