// The scalars of conjugate gradients. See find_scalars.rs.

struct Params {
    stage: u32,
    n_sums: u32,
    squared_tolerance: f32,
}

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read> pairs: array<Pair>;
@group(1) @binding(1) var<storage, read_write> scalars: array<Scalars>;

fn ratio(a: vec4<f32>, b: vec4<f32>) -> vec4<f32> {
    return vec4(select(vec3(0.0), a.xyz / b.xyz, b.xyz > vec3(0.0)), 0.0);
}

fn map(i: u32) {
    var sum = Pair(vec4(0.0), vec4(0.0));
    for (var k = 0u; k < params.n_sums; k++) {
        sum.first += pairs[k].first;
        sum.second += pairs[k].second;
    }
    if params.stage == 0u {
        scalars[i].rho = sum.first;
        scalars[i].enough = sum.second * params.squared_tolerance;
    } else if params.stage == 1u {
        scalars[i].alpha = ratio(scalars[i].rho, sum.first);
    } else if all(sum.second.xyz <= scalars[i].enough.xyz) {
        scalars[i].beta = vec4(0.0);
        scalars[i].rho = vec4(0.0);
    } else {
        scalars[i].beta = ratio(sum.first, scalars[i].rho);
        scalars[i].rho = sum.first;
    }
}
