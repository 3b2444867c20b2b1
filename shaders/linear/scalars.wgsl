// What conjugate gradients know, for x, y and z. See find_scalars.rs.

struct Scalars {
    rho: vec4<f32>,
    enough: vec4<f32>,
    alpha: vec4<f32>,
    beta: vec4<f32>,
}
