// How far most particles go. See drift.rs.

struct Params {
    first: u32,
    n: u32,
}

const N_SAMPLES = 32u;

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read> primitives: array<vec4<u32>>;
@group(1) @binding(1) var<storage, read> q_from: array<vec4<f32>>;
@group(1) @binding(2) var<storage, read> q_to: array<vec4<f32>>;
@group(1) @binding(3) var<storage, read_write> drift: array<vec4<f32>>;

fn map(i: u32) {
    let stride = (params.n + N_SAMPLES - 1u) / N_SAMPLES;
    let n = (params.n + stride - 1u) / stride;
    var ways: array<vec4<f32>, N_SAMPLES>;
    for (var k = 0u; k < n; k++) {
        let v = primitives[params.first + k * stride].x;
        ways[k] = q_to[v] - q_from[v];
    }
    var median = vec4(0.0);
    for (var axis = 0u; axis < 3u; axis++) {
        for (var k = 0u; k < n; k++) {
            let way = ways[k][axis];
            var n_before = 0u;
            for (var j = 0u; j < n; j++) {
                if ways[j][axis] < way || (ways[j][axis] == way && j < k) {
                    n_before++;
                }
            }
            if n_before == n / 2u {
                median[axis] = way;
            }
        }
    }
    drift[i] = median;
}
