// The guard: ways are shortened. See shorten.rs.

struct Params {
    gives_up: u32,
    n: u32,
}

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read> parts: array<u32>;
@group(1) @binding(1) var<storage, read> q_from: array<vec4<f32>>;
@group(1) @binding(2) var<storage, read_write> q: array<vec4<f32>>;

fn select_element(i: u32) -> bool {
    if params.gives_up != 0u {
        if parts[params.n] == 0u {
            q[i] = q_from[i];
        }
        return false;
    }
    if parts[i] == 0xffffffffu {
        return false;
    }
    let part = bitcast<f32>(parts[i]);
    let first = q_from[i];
    q[i] = select(first, first + part * (q[i] - first), part > 0.0);
    return true;
}
