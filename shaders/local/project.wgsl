// The local step: p(A q) of each constraint. See project.rs.

@group(1) @binding(0) var<storage, read> particles: array<array<u32, N>>;
@group(1) @binding(1) var<storage, read> rest: array<Rest>;
@group(1) @binding(2) var<storage, read> q: array<vec4<f32>>;
@group(1) @binding(3) var<storage, read_write> projected: array<array<vec4<f32>, R>>;

fn map(k: u32) {
    let c = rest[k];
    var p = project(c, apply(c, corners(k)));
    for (var row = 0u; row < R; row++) {
        projected[k][row] = vec4(p[row], 0.0);
    }
}
