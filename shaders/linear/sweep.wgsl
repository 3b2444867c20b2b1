// A colored sweep forward or backward as a preconditioner. See sweep.rs.

struct Params {
    is_backward: u32,
}

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read> rows: array<Row>;
@group(1) @binding(1) var<storage, read> taps: array<Tap>;
@group(1) @binding(2) var<storage, read> r: array<vec4<f32>>;
@group(1) @binding(3) var<storage, read_write> z: array<vec4<f32>>;

fn update(i: u32) {
    let row = rows[i];
    let is_backward = params.is_backward == 1u;
    var sum = vec3(0.0);
    var e = row.first;
    for (var k = 0u; k < row.n; k++) {
        if (taps[e].column > i) == is_backward {
            sum += z[taps[e].column].xyz * taps[e].weight;
        }
        e += SLICE;
    }
    if is_backward {
        z[i] = vec4(z[i].xyz + sum * row.inverse_diagonal, 0.0);
    } else {
        z[i] = vec4((r[i].xyz + sum) * row.inverse_diagonal, 0.0);
    }
}
