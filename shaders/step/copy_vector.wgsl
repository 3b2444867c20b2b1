// A copy. See copy_vector.rs.

@group(1) @binding(0) var<storage, read> source: array<vec4<f32>>;
@group(1) @binding(1) var<storage, read_write> own: array<vec4<f32>>;

fn map(i: u32) {
    own[i] = source[i];
}
