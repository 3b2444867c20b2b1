// The local step of springs. See spring_pull.rs.

@group(1) @binding(0) var<storage, read> rows: array<Row>;
@group(1) @binding(1) var<storage, read> taps: array<Tap>;
@group(1) @binding(2) var<storage, read> spring_pulls: array<f32>;
@group(1) @binding(3) var<storage, read> q: array<vec4<f32>>;
@group(1) @binding(4) var<storage, read_write> pulls: array<vec4<f32>>;

fn map(i: u32) {
    let row = rows[i];
    let at = q[i].xyz;
    var sum = vec3(0.0);
    var e = row.first;
    for (var k = 0u; k < row.n_springs; k++) {
        let d = q[taps[e].column].xyz - at;
        sum -= d * (spring_pulls[e] / sqrt(guarded(dot3(d, d))));
        e += SLICE;
    }
    pulls[i] = vec4(sum, 0.0);
}
