// Symmetric 3 × 3 matrices: their diagonal, and their entries yz, zx, xy.

fn multiplied(diagonal: vec3<f32>, off: vec3<f32>, x: vec3<f32>) -> vec3<f32> {
    return vec3(
        dot3(vec3(diagonal.x, off.z, off.y), x),
        dot3(vec3(off.z, diagonal.y, off.x), x),
        dot3(vec3(off.y, off.x, diagonal.z), x),
    );
}

fn solved(diagonal: vec3<f32>, off: vec3<f32>, b: vec3<f32>, fallback: vec3<f32>) -> vec3<f32> {
    let x = vec3(diagonal.x, off.z, off.y);
    let y = vec3(off.z, diagonal.y, off.x);
    let z = vec3(off.y, off.x, diagonal.z);
    let yz = cross3(y, z);
    let determinant = dot3(x, yz);
    let solution = vec3(dot3(yz, b), dot3(cross3(z, x), b), dot3(cross3(x, y), b)) * (1.0 / determinant);
    if determinant > 0.0 && abs(solution.x) + abs(solution.y) + abs(solution.z) <= MAX {
        return solution;
    }
    return fallback;
}
