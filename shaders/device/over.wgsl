// What a kernel runs over: a list, or a range.

@group(0) @binding(0) var<storage, read> headers: array<Header>;
@group(0) @binding(1) var<storage, read> list: array<u32>;
@group(0) @binding(2) var<uniform> run: Run;

fn n_elements() -> u32 {
    if run.list == RANGE {
        return run.len;
    }
    return headers[run.list].len;
}

fn element(k: u32) -> u32 {
    if run.list == RANGE {
        return run.first + k;
    }
    return list[headers[run.list].first + k];
}
