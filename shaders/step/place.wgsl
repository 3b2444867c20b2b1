// Pinned particles that are led. See place.rs.

@group(1) @binding(0) var<storage, read> places: array<vec4<f32>>;
@group(1) @binding(1) var<storage, read_write> q: array<vec4<f32>>;

fn update(i: u32) {
    if places[i].w != 0.0 {
        q[i] = vec4(places[i].xyz, q[i].w);
    }
}
