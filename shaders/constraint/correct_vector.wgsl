// One projection of XPBD with a multiplier for A q − p, of kinds of one row. See multiplier.rs.

// The multiplier (xyz) after it, and by how much each particle moves [m].
fn correct(rest: Rest, xpbd: Xpbd, q: array<vec4<f32>, N>, lambda: vec4<f32>) -> Correction {
    var at = q;
    var r = residual(rest, unweighted(q));
    let compliance = 1.0 / (weight(rest) * xpbd.squared_h);
    var denominator = compliance;
    for (var slot = 0u; slot < N; slot++) {
        var row = column(rest, slot);
        denominator += at[slot].w * (row[0] * row[0]);
    }
    let step = (-r[0] - lambda.xyz * compliance) * (xpbd.omega / denominator);
    var moves: array<vec3<f32>, N>;
    for (var slot = 0u; slot < N; slot++) {
        var row = column(rest, slot);
        moves[slot] = step * (at[slot].w * row[0]);
    }
    return Correction(lambda + vec4(step, 0.0), moves);
}
