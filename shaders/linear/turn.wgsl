// The next direction. See turn.rs.

@group(1) @binding(0) var<storage, read> scalars: array<Scalars>;
@group(1) @binding(1) var<storage, read> z: array<vec4<f32>>;
@group(1) @binding(2) var<storage, read_write> own: array<vec4<f32>>;

fn map(i: u32) {
    own[i] = vec4(z[i].xyz + own[i].xyz * scalars[0].beta.xyz, 0.0);
}
