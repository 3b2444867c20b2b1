// What contacts do to a vertex, as sweeps see it. See shift_anchor.rs.

@group(1) @binding(0) var<storage, read> q: array<vec4<f32>>;
@group(1) @binding(1) var<storage, read> from_where: array<vec4<f32>>;
@group(1) @binding(2) var<storage, read> mobility: array<f32>;
@group(1) @binding(3) var<storage, read_write> anchors: array<vec4<f32>>;

fn update(i: u32) {
    let moved = q[i].xyz - from_where[i].xyz;
    if any(moved != vec3(0.0)) {
        let weight = abs(anchors[i].w);
        anchors[i] = vec4(anchors[i].xyz + moved / (mobility[i] * weight), -weight);
    }
}
