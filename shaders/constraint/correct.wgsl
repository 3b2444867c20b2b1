// One projection of XPBD with a multiplier for C. See multiplier.rs.

// The multiplier (x) after it, and by how much each particle moves [m].
fn correct(rest: Rest, xpbd: Xpbd, q: array<vec4<f32>, N>, lambda: vec4<f32>) -> Correction {
    var at = q;
    var found = deviation(rest, unweighted(q));
    let compliance = 1.0 / (weight(rest) * xpbd.squared_h);
    var denominator = compliance;
    for (var slot = 0u; slot < N; slot++) {
        denominator += at[slot].w * dot3(found.gradient[slot], found.gradient[slot]);
    }
    let step = xpbd.omega * (-found.c - compliance * lambda.x) / denominator;
    for (var slot = 0u; slot < N; slot++) {
        found.gradient[slot] *= at[slot].w * step;
    }
    return Correction(vec4(lambda.x + step, lambda.yzw), found.gradient);
}
