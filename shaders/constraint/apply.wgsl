// A q, from differences to the first particle.
fn apply(rest: Rest, q: array<vec3<f32>, N>) -> array<vec3<f32>, R> {
    var at = q;
    var aq: array<vec3<f32>, R>;
    for (var slot = 1u; slot < N; slot++) {
        var a = column(rest, slot);
        let d = at[slot] - at[0];
        for (var row = 0u; row < R; row++) {
            aq[row] += a[row] * d;
        }
    }
    return aq;
}
