// Two vectors.

struct Pair {
    first: vec4<f32>,
    second: vec4<f32>,
}
