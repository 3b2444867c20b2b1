// How far vectors are apart. See squared_distance.rs.

@group(1) @binding(0) var<storage, read> a: array<vec4<f32>>;
@group(1) @binding(1) var<storage, read> b: array<vec4<f32>>;
@group(1) @binding(2) var<storage, read_write> squared: array<f32>;

fn map(i: u32) {
    let d = a[i].xyz - b[i].xyz;
    squared[i] = dot3(d, d);
}
