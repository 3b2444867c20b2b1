// One vector and a part of another. See add_scaled.rs.

struct Params {
    factor: f32,
    by_alpha: u32,
}

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read> scalars: array<Scalars>;
@group(1) @binding(1) var<storage, read> a: array<vec4<f32>>;
@group(1) @binding(2) var<storage, read_write> own: array<vec4<f32>>;

fn map(i: u32) {
    var scale = vec3(1.0);
    if params.by_alpha == 1u {
        scale = scalars[0].alpha.xyz;
    }
    own[i] = vec4(own[i].xyz + a[i].xyz * (scale * params.factor), own[i].w);
}
