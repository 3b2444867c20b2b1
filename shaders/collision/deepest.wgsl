// The deepest contact. See deepest.rs.

@group(1) @binding(0) var<storage, read> depths: array<f32>;
@group(1) @binding(1) var<storage, read_write> lowest: array<atomic<u32>>;

fn lower(i: u32) {
    lower_to(0u, ~bitcast<u32>(depths[i]));
}
