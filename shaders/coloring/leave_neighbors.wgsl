// A vertex that was colored leaves the degrees of its neighbors. See leave_neighbors.rs.

@group(1) @binding(0) var<storage, read> offsets: array<u32>;
@group(1) @binding(1) var<storage, read> neighbors: array<u32>;
@group(1) @binding(2) var<storage, read_write> counters: array<atomic<u32>>;

fn count_down(v: u32) {
    for (var e = offsets[v]; e < offsets[v + 1u]; e++) {
        take_one(neighbors[e]);
    }
}
