// Where inertia and attachments pull a particle together. See anchor.rs.

@group(1) @binding(0) var<storage, read> predicted: array<vec4<f32>>;
@group(1) @binding(1) var<storage, read> holds: array<vec4<f32>>;
@group(1) @binding(2) var<storage, read_write> anchors: array<vec4<f32>>;

fn map(i: u32) {
    anchors[i] = vec4(predicted[i].xyz * holds[i].w + holds[i].xyz, anchors[i].w);
}
