// w C² / 2 of each constraint. See xpbd_energy.rs.

@group(1) @binding(0) var<storage, read> particles: array<array<u32, N>>;
@group(1) @binding(1) var<storage, read> rest: array<Rest>;
@group(1) @binding(2) var<storage, read> q: array<vec4<f32>>;
@group(1) @binding(3) var<storage, read_write> energies: array<f32>;

fn map(k: u32) {
    let c = deviation(rest[k], corners(k)).c;
    energies[k] = 0.5 * weight(rest[k]) * c * c;
}
