// Y times a vector. See multiply.rs.

@group(1) @binding(0) var<storage, read> rows: array<Row>;
@group(1) @binding(1) var<storage, read> taps: array<Tap>;
@group(1) @binding(2) var<storage, read> anchors: array<vec4<f32>>;
@group(1) @binding(3) var<storage, read> d: array<vec4<f32>>;
@group(1) @binding(4) var<storage, read_write> own: array<vec4<f32>>;

fn map(i: u32) {
    let row = rows[i];
    let at = d[i].xyz;
    var sum = at * abs(anchors[i].w);
    var e = row.first;
    for (var k = 0u; k < row.n; k++) {
        sum += (at - d[taps[e].column].xyz) * taps[e].weight;
        e += SLICE;
    }
    own[i] = vec4(sum, 0.0);
}
