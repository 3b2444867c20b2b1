// The energy of a row. See row_energy.rs.

@group(1) @binding(0) var<storage, read> rows: array<Row>;
@group(1) @binding(1) var<storage, read> taps: array<Tap>;
@group(1) @binding(2) var<storage, read> springs: array<Spring>;
@group(1) @binding(3) var<storage, read> anchors: array<vec4<f32>>;
@group(1) @binding(4) var<storage, read> q: array<vec4<f32>>;
@group(1) @binding(5) var<storage, read_write> energies: array<f32>;

fn map(i: u32) {
    let row = rows[i];
    let at = q[i].xyz;
    let from_anchor = at - anchors[i].xyz;
    var sum = dot3(from_anchor, from_anchor) * anchors[i].w;
    var e = row.first;
    for (var k = 0u; k < row.n; k++) {
        let d = q[taps[e].column].xyz - at;
        let spring = springs[e];
        let squared = dot3(d, d);
        let force = spring.stiffness * sqrt(squared) - spring.pull;
        sum += force * force * spring.compliance + spring.linear * squared;
        e += SLICE;
    }
    energies[i] = 0.5 * sum;
}
