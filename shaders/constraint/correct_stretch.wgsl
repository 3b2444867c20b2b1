// One projection of XPBD with a multiplier for what a stretch is too much. See multiplier.rs.

// The multiplier (xx, yy, xy) after it, and by how much each particle moves [m].
fn correct(rest: Rest, xpbd: Xpbd, q: array<vec4<f32>, N>, lambda: vec4<f32>) -> Correction {
    var at = q;
    var found = stretch(rest, apply(rest, unweighted(q)));
    let compliance = 1.0 / (weight(rest) * xpbd.squared_h);
    var k = vec3(0.0);
    for (var slot = 0u; slot < N; slot++) {
        var row = column(rest, slot);
        k += at[slot].w * vec3(row[0] * row[0], row[1] * row[1], row[0] * row[1]);
    }
    let right = (-found.excess - lambda.xyz * compliance) * xpbd.omega;
    let xx = k.x + compliance;
    let yy = k.y + compliance;
    let half = 0.5 * k.z;
    let xy = (right.z - half * (right.x / xx + right.y / yy))
        / (0.5 * (xx + yy) - half * k.z * (1.0 / xx + 1.0 / yy));
    let step = vec3((right.x - k.z * xy) / xx, (right.y - k.z * xy) / yy, xy);
    var moves: array<vec3<f32>, N>;
    for (var slot = 0u; slot < N; slot++) {
        var row = column(rest, slot);
        let along = found.rotation[0] * (step.x * row[0] + step.z * row[1])
            + found.rotation[1] * (step.z * row[0] + step.y * row[1]);
        moves[slot] = along * at[slot].w;
    }
    return Correction(lambda + vec4(step, 0.0), moves);
}
