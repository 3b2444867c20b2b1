// Products of vectors, added up in a fixed order: those built in may take another, or fuse.

const MAX = 0x1.fffffep+127f;

fn dot3(a: vec3<f32>, b: vec3<f32>) -> f32 {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

fn cross3(a: vec3<f32>, b: vec3<f32>) -> vec3<f32> {
    return vec3(a.y * b.z - b.y * a.z, a.z * b.x - b.z * a.x, a.x * b.y - b.x * a.y);
}

fn length3(a: vec3<f32>) -> f32 {
    return sqrt(dot3(a, a));
}

// The direction of `d`; 0 where it has none.
fn direction(d: vec3<f32>) -> vec3<f32> {
    let length = length3(d);
    if length > 0.0 && length <= MAX {
        return d * (1.0 / length);
    }
    return vec3(0.0);
}
