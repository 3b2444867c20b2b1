// Boxes around boxes: a level of a tree from the one below. See bound.rs.

struct Params {
    first: u32,
    first_child: u32,
    n_children: u32,
}

const CHILDREN = 8u;

@group(0) @binding(3) var<uniform> params: Params;
@group(1) @binding(0) var<storage, read_write> boxes: array<Aabb>;

fn update(i: u32) {
    let begin = CHILDREN * (i - params.first);
    let end = min(params.n_children, begin + CHILDREN);
    var around = boxes[params.first_child + begin];
    for (var k = begin + 1u; k < end; k++) {
        let child = boxes[params.first_child + k];
        around.least = min(around.least, child.least);
        around.greatest = max(around.greatest, child.greatest);
    }
    boxes[i] = around;
}
