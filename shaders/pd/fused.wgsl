// `(b − Y q)` of row i without its passes, springs projected from q.
fn fused(i: u32) -> vec3<f32> {
    let row = rows[i];
    let at = q[i].xyz;
    var sum = (anchors[i].xyz - at) * abs(anchors[i].w);
    var e = row.first;
    for (var k = 0u; k < row.n_springs; k++) {
        let d = q[taps[e].column].xyz - at;
        sum += d * (taps[e].weight - spring_pulls[e] / sqrt(guarded(dot3(d, d))));
        e += SLICE;
    }
    for (var k = row.n_springs; k < row.n; k++) {
        sum += (q[taps[e].column].xyz - at) * taps[e].weight;
        e += SLICE;
    }
    return sum;
}
