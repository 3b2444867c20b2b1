// A level of substitution with the partitioned inverse of a Cholesky factor. See substitute.rs.

struct Params {
    first: u32,
}

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read> rows: array<Row>;
@group(1) @binding(1) var<storage, read> taps: array<Tap>;
@group(1) @binding(2) var<storage, read_write> v: array<vec4<f32>>;

fn update(i: u32) {
    let row = rows[i - params.first];
    var sum = vec3(0.0);
    var e = row.first;
    for (var k = 0u; k < row.n; k++) {
        sum += v[taps[e].column].xyz * taps[e].weight;
        e += SLICE;
    }
    v[i] = vec4(sum, 0.0);
}
