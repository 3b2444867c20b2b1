// A particle's own block of the Hessian, springs exactly. See spring_block.rs.

struct Block {
    diagonal: vec4<f32>,
    off: vec4<f32>,
}

@group(1) @binding(0) var<storage, read> rows: array<Row>;
@group(1) @binding(1) var<storage, read> taps: array<Tap>;
@group(1) @binding(2) var<storage, read> springs: array<Spring>;
@group(1) @binding(3) var<storage, read> q: array<vec4<f32>>;
@group(1) @binding(4) var<storage, read_write> blocks: array<Block>;

fn map(i: u32) {
    let row = rows[i];
    let at = q[i].xyz;
    var isotropic = 1.0 / row.inverse_diagonal;
    var diagonal = vec3(0.0);
    var off = vec3(0.0);
    var e = row.first;
    for (var k = 0u; k < row.n_springs; k++) {
        let d = q[taps[e].column].xyz - at;
        let spring = springs[e];
        let squared = guarded(dot3(d, d));
        let across = max(spring.stiffness - spring.pull / sqrt(squared), 0.0);
        isotropic += across - spring.stiffness;
        let scaled = d * ((spring.stiffness - across) / squared);
        diagonal += scaled * d;
        off += vec3(scaled.y * d.z, scaled.z * d.x, scaled.x * d.y);
        e += SLICE;
    }
    blocks[i] = Block(vec4(diagonal + vec3(isotropic), 0.0), vec4(off, 0.0));
}
