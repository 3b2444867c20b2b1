// How long vectors are. See squared_length.rs.

@group(1) @binding(0) var<storage, read> a: array<vec4<f32>>;
@group(1) @binding(1) var<storage, read_write> squared: array<f32>;

fn map(i: u32) {
    squared[i] = dot3(a[i].xyz, a[i].xyz);
}
