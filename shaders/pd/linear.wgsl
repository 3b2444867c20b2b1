// `(b − Y q)` of row i, all projections in `pulls`.
fn linear(i: u32) -> vec3<f32> {
    let row = rows[i];
    let at = q[i].xyz;
    var sum = (anchors[i].xyz - at) * abs(anchors[i].w) + pulls[i].xyz;
    var e = row.first;
    for (var k = 0u; k < row.n; k++) {
        sum += (q[taps[e].column].xyz - at) * taps[e].weight;
        e += SLICE;
    }
    return sum;
}
