// The diagonal of Y as a preconditioner. See divide.rs.

@group(1) @binding(0) var<storage, read> rows: array<Row>;
@group(1) @binding(1) var<storage, read> r: array<vec4<f32>>;
@group(1) @binding(2) var<storage, read_write> z: array<vec4<f32>>;

fn map(i: u32) {
    z[i] = vec4(r[i].xyz * rows[i].inverse_diagonal, 0.0);
}
