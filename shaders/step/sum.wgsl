// Sums of many numbers, in a fixed order. See sum.rs.

struct Params {
    first: u32,
    n_sums: u32,
    n_numbers: u32,
}

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read> numbers: array<f32>;
@group(1) @binding(1) var<storage, read_write> sums: array<f32>;

fn map(i: u32) {
    var sum = 0.0;
    for (var k = i - params.first; k < params.n_numbers; k += params.n_sums) {
        sum += numbers[k];
    }
    sums[i] = sum;
}
