// Where the particles of constraint `k` are, for kernels that bind `particles` and `q`.

fn corners(k: u32) -> array<vec3<f32>, N> {
    var at: array<vec3<f32>, N>;
    for (var slot = 0u; slot < N; slot++) {
        at[slot] = q[particles[k][slot]].xyz;
    }
    return at;
}
