//! Families of graphs: meshes as simulations have them, and the extremes of graph theory.

use simple_delaunay_lib::delaunay_3d::delaunay_struct_3d::DelaunayStructure3D;
use simple_delaunay_lib::delaunay_3d::simplicial_struct_3d::Node;
use vivace_graph::{ConstraintGraph, GraphBuilder};
use vivace_mesh::{TriMesh, cloth};

use crate::random::Random;

/// Springs of a regular cloth of `width` × `height` vertices, row by row, each square cut along a to a + w + 1.
#[must_use]
pub fn regular_cloth(width: usize, height: usize) -> ConstraintGraph {
    springs(&regular(width, height))
}

/// Springs and hinges of a regular cloth: each hinge joins four vertices with one another.
#[must_use]
pub fn regular_hinge_cloth(width: usize, height: usize) -> ConstraintGraph {
    springs_and_hinges(&regular(width, height))
}

/// Springs of an irregular cloth: the Delaunay triangulation of a grid, jittered as far as goes, numbered row by row.
#[must_use]
pub fn irregular_cloth(width: usize, height: usize, seed: u64) -> ConstraintGraph {
    springs(&irregular(width, height, seed))
}

/// Springs and hinges of an irregular cloth.
#[must_use]
pub fn irregular_hinge_cloth(width: usize, height: usize, seed: u64) -> ConstraintGraph {
    springs_and_hinges(&irregular(width, height, seed))
}

fn regular(width: usize, height: usize) -> TriMesh {
    cloth::regular(width, height, 1.0).expect("two vertices a side")
}

fn irregular(width: usize, height: usize, seed: u64) -> TriMesh {
    cloth::irregular(width, height, 1.0, cloth::MAX_JITTER, seed).expect("two vertices a side")
}

fn springs(mesh: &TriMesh) -> ConstraintGraph {
    let graph = GraphBuilder::new(mesh.positions().len()).constraints(mesh.triangles()).build();
    graph.expect("a mesh's own vertices")
}

fn springs_and_hinges(mesh: &TriMesh) -> ConstraintGraph {
    let hinges = mesh.hinges();
    let builder = GraphBuilder::new(mesh.positions().len());
    builder.constraints(mesh.triangles()).constraints(&hinges).build().expect("a mesh's own vertices")
}

/// Tetrahedra: the Delaunay triangulation of `n` uniform random points in a ball, numbered in Morton order. As irregular as
/// a volume gets: mean degree 15.4, up to 36.
///
/// # Panics
/// When `n` is below 5: no tetrahedra.
#[must_use]
pub fn tets(n: usize, seed: u64) -> ConstraintGraph {
    assert!(n >= 5, "{n} points make no ball of tetrahedra");
    let mut random = Random::new(seed);
    let mut points = Vec::with_capacity(n);
    while points.len() < n {
        let point = [(); 3].map(|()| 2.0 * random.unit() - 1.0);
        if point.iter().map(|x| x * x).sum::<f64>() <= 1.0 {
            points.push(point);
        }
    }
    points.sort_by_key(morton);
    let mut delaunay = DelaunayStructure3D::new();
    delaunay.insert_vertices(&points, true).expect("points in general position");
    let simplices = delaunay.get_simplicial();
    let corners = |i: usize| {
        let nodes = simplices.get_tetrahedron(i).expect("counted").nodes();
        let mut tet = [0; 4];
        for (corner, node) in tet.iter_mut().zip(nodes) {
            match node {
                Node::Value(v) => *corner = u32::try_from(v).expect("n fits"),
                Node::Infinity => return None, // outside the hull
            }
        }
        Some(tet)
    };
    let tets: Vec<[u32; 4]> = (0..simplices.get_nb_tetrahedra()).filter_map(corners).collect();
    ConstraintGraph::from_constraints(n, &tets).expect("numbered by the points")
}

/// Position along a curve that fills [-1, 1]^3: the bits of the coordinates, interleaved.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 1024")]
fn morton(point: &[f64; 3]) -> u32 {
    let cell = point.map(|x| (((x + 1.0) * 512.0) as u32).min(1023));
    (0..30).fold(0, |key, bit| key | ((cell[bit % 3] >> (bit / 3)) & 1) << bit)
}

/// The graph and random pairs, `fraction` as many as it has edges: contacts between whatever comes near.
#[must_use]
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a part of the number of edges")]
pub fn with_contacts(graph: &ConstraintGraph, fraction: f64, seed: u64) -> ConstraintGraph {
    let n = to_u32(graph.n_vertices());
    let mut random = Random::new(seed);
    let count = (graph.n_edges() as f64 * fraction).round() as usize;
    let pairs: Vec<[u32; 2]> = (0..count).map(|_| [random.below(n), random.below(n)]).collect();
    graph.with_edges(&pairs).expect("below n")
}

/// The graph and more vertices, hub k joined to `degrees[k]` random vertices and to the hub before: bodies pinned to many.
#[must_use]
pub fn with_hubs(graph: &ConstraintGraph, degrees: &[u32], seed: u64) -> ConstraintGraph {
    let n = to_u32(graph.n_vertices());
    let mut random = Random::new(seed);
    let mut edges: Vec<[u32; 2]> = graph.edges().collect();
    for (hub, &degree) in (n..).zip(degrees) {
        edges.extend(random.sample(n, degree).into_iter().map(|v| [hub, v]));
        if hub > n {
            edges.push([hub - 1, hub]);
        }
    }
    ConstraintGraph::from_edges(n as usize + degrees.len(), &edges).expect("below n")
}

/// The graph with its vertices numbered at random.
#[must_use]
pub fn shuffled(graph: &ConstraintGraph, seed: u64) -> ConstraintGraph {
    let numbering = Random::new(seed).permutation(to_u32(graph.n_vertices()));
    graph.permuted(&numbering).expect("a permutation")
}

/// `n_pairs` random pairs over `n` vertices; pairs that repeat or join a vertex to itself count for nothing.
#[must_use]
pub fn random(n: u32, n_pairs: usize, seed: u64) -> ConstraintGraph {
    let mut random = Random::new(seed);
    let pairs: Vec<[u32; 2]> =
        (0..if n == 0 { 0 } else { n_pairs }).map(|_| [random.below(n), random.below(n)]).collect();
    from_pairs(n, &pairs)
}

/// No vertex.
#[must_use]
pub fn empty() -> ConstraintGraph {
    ConstraintGraph::default()
}

/// `n` vertices, no edge.
#[must_use]
pub fn isolated(n: u32) -> ConstraintGraph {
    from_pairs(n, &[])
}

/// `n` vertices in a row.
#[must_use]
pub fn path(n: u32) -> ConstraintGraph {
    let pairs: Vec<[u32; 2]> = (1..n).map(|v| [v - 1, v]).collect();
    from_pairs(n, &pairs)
}

/// Vertex 0 joined to `n_leaves` others.
#[must_use]
pub fn star(n_leaves: u32) -> ConstraintGraph {
    let pairs: Vec<[u32; 2]> = (1..=n_leaves).map(|v| [0, v]).collect();
    from_pairs(n_leaves + 1, &pairs)
}

/// Vertex 0 joined to each vertex of a ring of `n_rim`.
#[must_use]
pub fn wheel(n_rim: u32) -> ConstraintGraph {
    let spokes = (1..=n_rim).map(|v| [0, v]);
    let pairs: Vec<[u32; 2]> = spokes.chain((1..=n_rim).map(|v| [v, v % n_rim + 1])).collect();
    from_pairs(n_rim + 1, &pairs)
}

/// `n` vertices, each joined to each.
#[must_use]
pub fn clique(n: u32) -> ConstraintGraph {
    let pairs: Vec<[u32; 2]> = (0..n).flat_map(|v| (0..v).map(move |u| [u, v])).collect();
    from_pairs(n, &pairs)
}

/// Each of the first `a` vertices joined to each of the `b` others.
#[must_use]
pub fn complete_bipartite(a: u32, b: u32) -> ConstraintGraph {
    let pairs: Vec<[u32; 2]> = (0..a).flat_map(|u| (a..a + b).map(move |v| [u, v])).collect();
    from_pairs(a + b, &pairs)
}

fn from_pairs(n: u32, pairs: &[[u32; 2]]) -> ConstraintGraph {
    ConstraintGraph::from_edges(n as usize, pairs).expect("below n")
}

/// An index or a count; graphs are checked to fit 32 bits when they are made.
///
/// # Panics
/// Where it does not.
#[must_use]
pub fn to_u32(i: usize) -> u32 {
    u32::try_from(i).expect("a graph numbers its vertices in 32 bits")
}
