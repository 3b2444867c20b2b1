// The guard: velocities of what it has held. See held_velocity.rs.

struct Params {
    scale: f32,
}

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read> q: array<vec4<f32>>;
@group(1) @binding(1) var<storage, read> found: array<vec4<f32>>;
@group(1) @binding(2) var<storage, read> start: array<vec4<f32>>;
@group(1) @binding(3) var<storage, read_write> v: array<vec4<f32>>;

fn map(i: u32) {
    if any(q[i].xyz != found[i].xyz) {
        v[i] = vec4((q[i].xyz - start[i].xyz) * params.scale, 0.0);
    }
}
