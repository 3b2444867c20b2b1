// C = |A q − p| and its gradient, which is 0 at rest.
fn deviation(rest: Rest, q: array<vec3<f32>, N>) -> Deviation {
    let r = residual(rest, q);
    var found: Deviation;
    found.c = sqrt(squared_norm(r));
    if found.c > 0.0 {
        let scale = 1.0 / found.c;
        for (var slot = 0u; slot < N; slot++) {
            found.gradient[slot] = transposed(rest, slot, r) * scale;
        }
    }
    return found;
}
