// Boxes and contacts. See mod.rs.

struct Aabb {
    least: vec4<f32>,
    greatest: vec4<f32>,
}

struct Contact {
    particles: vec4<u32>,
    weights: vec4<f32>,
    normal: vec3<f32>,
    distance: f32,
    start: vec3<f32>,
    friction: f32,
    origin: vec3<f32>,
    free: u32,
}

const BETWEEN_EDGES = 16u;

// The sum of weights and positions, relative to the first where nothing would cancel.
fn weighed(weights: vec4<f32>, a: vec3<f32>, b: vec3<f32>, c: vec3<f32>, d: vec3<f32>) -> vec3<f32> {
    if weights.y == 0.0 && weights.z == 0.0 && weights.w == 0.0 {
        return weights.x * a;
    }
    return weights.y * (b - a) + weights.z * (c - a) + weights.w * (d - a);
}

fn slip(contact: Contact, aq: vec3<f32>) -> vec3<f32> {
    let moved = aq - contact.start;
    return moved - contact.normal * dot(contact.normal, moved);
}

fn depth(contact: Contact, aq: vec3<f32>) -> f32 {
    return contact.distance - dot(contact.normal, aq - contact.origin);
}
