// By how much the blocks of a particle's constraints differ from their part in Y. See block.rs.

struct Block {
    diagonal: vec4<f32>,
    off: vec4<f32>,
}

@group(1) @binding(0) var<storage, read> offsets: array<u32>;
@group(1) @binding(1) var<storage, read> slots: array<u32>;
@group(1) @binding(2) var<storage, read> particles: array<array<u32, N>>;
@group(1) @binding(3) var<storage, read> rest: array<Rest>;
@group(1) @binding(4) var<storage, read> q: array<vec4<f32>>;
@group(1) @binding(5) var<storage, read_write> blocks: array<Block>;

fn map(i: u32) {
    var diagonal = blocks[i].diagonal.xyz;
    var off = blocks[i].off.xyz;
    for (var e = offsets[i]; e < offsets[i + 1u]; e++) {
        let k = slots[e] / N;
        let slot = slots[e] % N;
        let m = block(rest[k], corners(k), slot);
        diagonal += vec3(m[0].x, m[1].y, m[2].z) - vec3(diagonal_entry(rest[k], slot));
        off += vec3(m[1].z, m[2].x, m[0].y);
    }
    blocks[i] = Block(vec4(diagonal, 0.0), vec4(off, 0.0));
}
