//! The shapes of two trees of boxes, over triangles and over edges, whose leaves are sorted once.

use glam::Vec3;
use vivace_graph::DisjointSets;
use vivace_kernels::collision::{BoundUniform, CHILDREN, LEVELS, MeetUniform};

/// The shape of both trees.
pub(super) struct Trees {
    pub(super) meet: MeetUniform,
    pub(super) bounds: Vec<BoundUniform>,
    pub(super) n_vertices: u32,
    pub(super) n_boxes: u32,
}

impl Trees {
    pub(super) fn new(n_triangles: u32, n_edges: u32, n_vertices: u32) -> Self {
        let mut bounds = Vec::new();
        let mut n_boxes = n_triangles + n_edges + n_vertices;
        let mut levels = |leaves: u32, n_leaves: u32| {
            let (mut first, mut n) = (leaves, n_leaves);
            let mut levels = [leaves; LEVELS];
            for level in levels.iter_mut().skip(1) {
                if n > 1 {
                    bounds.push(BoundUniform { first: n_boxes, first_child: first, n_children: n });
                    (first, n) = (n_boxes, n.div_ceil(CHILDREN));
                    n_boxes += n;
                }
                *level = first;
            }
            levels
        };
        let levels = [levels(0, n_triangles), levels(n_triangles, n_edges)];
        let meet = MeetUniform { n_triangles, n_edges, padding: [0; 2], levels };
        Self { meet, bounds, n_vertices, n_boxes }
    }

    /// The first vertex among the primitives.
    pub(super) fn first_vertex(&self) -> u32 {
        self.meet.n_triangles + self.meet.n_edges
    }
}

/// The bodies' numbers, by particle: two particles of a triangle are of one body.
pub(super) fn bodies(triangles: &[[u32; 3]], n: u32) -> Vec<u32> {
    let mut sets = DisjointSets::new(n);
    for &[a, b, c] in triangles {
        sets.unite(a, b);
        sets.unite(a, c);
    }
    (0..n).map(|v| sets.first(v)).collect()
}

/// The order of leaves: body by body, each along a curve on which what is near stays near (Morton 1966).
pub(super) fn sorted<const N: usize>(
    primitives: &[[u32; N]],
    rest: &[Vec3],
    bodies: &[u32],
) -> Vec<[u32; N]> {
    let least = rest.iter().fold(Vec3::INFINITY, |least, &v| least.min(v));
    let greatest = rest.iter().fold(Vec3::NEG_INFINITY, |greatest, &v| greatest.max(v));
    let scale = 1023.0 / (greatest - least).max_element().max(f32::MIN_POSITIVE);
    let code = |corners: &[u32; N]| {
        let center = corners.iter().map(|&v| rest[v as usize] - least).sum::<Vec3>() / N as f32;
        let cell = (center * scale).as_uvec3();
        let spread = |x: u32| (0..10).fold(0, |code, bit| code | (x >> bit & 1) << (3 * bit));
        spread(cell.x) | spread(cell.y) << 1 | spread(cell.z) << 2
    };
    let mut sorted = primitives.to_vec();
    sorted.sort_by_cached_key(|corners| (bodies[corners[0] as usize], code(corners)));
    sorted
}
