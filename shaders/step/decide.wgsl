// The safeguard's decision. See decide.rs.

struct Params {
    n_sums: u32,
    k: u32,
    is_last: u32,
    tolerated_rise: f32,
    most: u32,
    recovery: u32,
    rounding: f32,
}

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read> sums: array<f32>;
@group(1) @binding(1) var<storage, read_write> watches: array<Watch>;

fn map(i: u32) {
    var watch = watches[i];
    var objective = 0.0;
    for (var k = 0u; k < params.n_sums; k++) {
        objective += sums[k];
    }
    watch.is_back = 0u;
    if params.k == 0u {
        watch.lowest = objective;
        watch.kept = objective;
        watch.began_at = 0u;
        watch.has_backed_off = 0u;
        watches[i] = watch;
        return;
    }
    let bound = watch.lowest + params.tolerated_rise * abs(watch.lowest) + params.rounding;
    // By its bits: what is not a number need not compare as one.
    let is_finite = (bitcast<u32>(objective) & 0x7f800000u) != 0x7f800000u;
    if is_finite && !(objective > bound) {
        watch.lowest = min(objective, watch.lowest);
        watch.kept = objective;
    } else {
        watch.is_back = 1u;
        watch.has_backed_off = 1u;
        watch.began_at = params.k;
        watch.n_backoffs += 1u;
        watch.level = min(watch.level + 1u, params.most);
        watch.quiet_steps = 0u;
    }
    if params.is_last == 1u && watch.has_backed_off == 0u {
        watch.quiet_steps += 1u;
        if watch.quiet_steps >= params.recovery {
            watch.level -= min(watch.level, 1u);
            watch.quiet_steps = 0u;
        }
    }
    watches[i] = watch;
}
