// The block of Y, an upper bound of that of the Hessian.
fn block(rest: Rest, q: array<vec3<f32>, N>, slot: u32) -> mat3x3<f32> {
    return scalar_block(diagonal_entry(rest, slot));
}
