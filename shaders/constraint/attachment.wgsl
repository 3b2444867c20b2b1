// A particle held at a point. See attachment.rs. (`target` is taken in WGSL.)

const N = 1u;
const R = 1u;

struct Rest {
    held_at: vec3<f32>,
    stiffness: f32,
}

fn weight(rest: Rest) -> f32 {
    return rest.stiffness;
}

fn column(rest: Rest, slot: u32) -> array<f32, R> {
    return array(1.0);
}

fn project(rest: Rest, aq: array<vec3<f32>, R>) -> array<vec3<f32>, R> {
    return array(rest.held_at);
}

fn apply(rest: Rest, q: array<vec3<f32>, N>) -> array<vec3<f32>, R> {
    return q;
}
