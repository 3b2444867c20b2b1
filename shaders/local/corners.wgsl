// Where the particles of constraint `k` are, and with their inverse masses, for kernels that bind `particles` and `q`.

fn weighted_corners(k: u32) -> array<vec4<f32>, N> {
    var at: array<vec4<f32>, N>;
    for (var slot = 0u; slot < N; slot++) {
        at[slot] = q[particles[k][slot]];
    }
    return at;
}

fn corners(k: u32) -> array<vec3<f32>, N> {
    return unweighted(weighted_corners(k));
}
