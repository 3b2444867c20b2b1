// What follows from a kind's constants N and R, its rest data `Rest` and its functions weight, column and project. See mod.rs.

struct Deviation {
    c: f32,
    gradient: array<vec3<f32>, N>,
}

fn residual(rest: Rest, q: array<vec3<f32>, N>) -> array<vec3<f32>, R> {
    var r = apply(rest, q);
    var p = project(rest, r);
    for (var row = 0u; row < R; row++) {
        r[row] -= p[row];
    }
    return r;
}

fn squared_norm(r: array<vec3<f32>, R>) -> f32 {
    var rows = r;
    var sum = 0.0;
    for (var row = 0u; row < R; row++) {
        sum += dot3(rows[row], rows[row]);
    }
    return sum;
}

// W(q) [J].
fn energy(rest: Rest, q: array<vec3<f32>, N>) -> f32 {
    return 0.5 * weight(rest) * squared_norm(residual(rest, q));
}

// Aᵀ x for particle `slot`.
fn transposed(rest: Rest, slot: u32, x: array<vec3<f32>, R>) -> vec3<f32> {
    var a = column(rest, slot);
    var rows = x;
    var sum = vec3(0.0);
    for (var row = 0u; row < R; row++) {
        sum += a[row] * rows[row];
    }
    return sum;
}

// w Aᵀ x for particle `slot`.
fn pull(rest: Rest, slot: u32, x: array<vec3<f32>, R>) -> vec3<f32> {
    return weight(rest) * transposed(rest, slot, x);
}

// Entry (slot, slot) of w AᵀA.
fn diagonal_entry(rest: Rest, slot: u32) -> f32 {
    var a = column(rest, slot);
    var sum = 0.0;
    for (var row = 0u; row < R; row++) {
        sum += a[row] * a[row];
    }
    return weight(rest) * sum;
}

fn scalar_block(x: f32) -> mat3x3<f32> {
    return mat3x3(vec3(x, 0.0, 0.0), vec3(0.0, x, 0.0), vec3(0.0, 0.0, x));
}

struct Xpbd {
    squared_h: f32,
    omega: f32,
}

struct Correction {
    lambda: vec4<f32>,
    moves: array<vec3<f32>, N>,
}

fn unweighted(q: array<vec4<f32>, N>) -> array<vec3<f32>, N> {
    var weighted = q;
    var at: array<vec3<f32>, N>;
    for (var slot = 0u; slot < N; slot++) {
        at[slot] = weighted[slot].xyz;
    }
    return at;
}
