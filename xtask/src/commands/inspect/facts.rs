//! What there is to say about a file, in the names and order of the JSON.

use std::path::Path;

use serde::Serialize;
use vivace_graph::{ConstraintGraph, GraphBuilder, smallest_last};
use vivace_mesh::sdf::{Blend, SignedDistance};
use vivace_mesh::stuffing::Stuffing;
use vivace_mesh::{DegreeSummary, MeshError, TetMesh, TriMesh};

use crate::commands::input::{Input, Refusal, in_graph_file, in_mesh_file};

/// Cells along the longest side of a shape when it is filled to see what it is.
const CELLS: f64 = 24.0;

/// What a file holds, by its kind.
#[derive(Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub(super) enum Facts {
    TriangleMesh(TriangleFacts),
    TetrahedralMesh(TetFacts),
    Graph { graph: GraphFacts },
    SignedDistance(ShapeFacts),
}

/// A graph of constraints.
#[derive(Serialize)]
pub(super) struct GraphFacts {
    pub(super) vertices: usize,
    pub(super) edges: usize,
    pub(super) min_degree: u32,
    pub(super) mean_degree: f64,
    pub(super) max_degree: u32,
    pub(super) degree_deviation: f64,
    /// First fit in smallest-last order needs at most one color more.
    pub(super) degeneracy: u32,
    /// Connected parts, isolated vertices not counted.
    pub(super) components: usize,
    pub(super) isolated_vertices: usize,
}

#[derive(Serialize)]
pub(super) struct TriangleFacts {
    pub(super) vertices: usize,
    pub(super) triangles: usize,
    pub(super) edges: usize,
    pub(super) hinges: usize,
    /// Lowest and highest corner of the bounding box \[m\].
    pub(super) bounds: [[f64; 3]; 2],
    pub(super) components: usize,
    pub(super) isolated_vertices: usize,
    pub(super) euler_characteristic: i64,
    pub(super) closed: bool,
    pub(super) boundary_edges: usize,
    pub(super) manifold: bool,
    pub(super) nonmanifold_edges: usize,
    pub(super) nonmanifold_vertices: usize,
    pub(super) folded_edges: usize,
    pub(super) oriented: bool,
    pub(super) misoriented_edges: usize,
    pub(super) repeated_triangles: usize,
    pub(super) flat_triangles: usize,
    /// \[deg\]
    pub(super) smallest_angle: Option<f64>,
    /// \[m^2\]
    pub(super) area: f64,
    /// Enclosed \[m^3\], none if open.
    pub(super) volume: Option<f64>,
    /// Why the surface bounds no volume; none if it does.
    pub(super) no_volume_boundary: Option<String>,
    /// A constraint on each edge.
    pub(super) edge_graph: GraphFacts,
    /// A constraint on each edge and on each hinge.
    pub(super) hinge_graph: GraphFacts,
}

#[derive(Serialize)]
pub(super) struct TetFacts {
    pub(super) vertices: usize,
    pub(super) tetrahedra: usize,
    pub(super) edges: usize,
    /// Lowest and highest corner of the bounding box \[m\].
    pub(super) bounds: [[f64; 3]; 2],
    pub(super) components: usize,
    pub(super) isolated_vertices: usize,
    pub(super) boundary_triangles: usize,
    pub(super) boundary_manifold: bool,
    pub(super) boundary_closed: bool,
    pub(super) open_boundary_edges: usize,
    pub(super) nonmanifold_boundary_edges: usize,
    pub(super) nonmanifold_boundary_vertices: usize,
    pub(super) nonmanifold_faces: usize,
    /// Smallest and largest \[deg\].
    pub(super) dihedral_angles: Option<[f64; 2]>,
    /// Smallest and mean, 1 for the regular tetrahedron.
    pub(super) quality: Option<[f64; 2]>,
    /// Of the mesh \[m^3\].
    pub(super) volume: f64,
    /// Of the smallest and the largest tetrahedron \[m^3\].
    pub(super) volumes: Option<[f64; 2]>,
    /// A constraint on each tetrahedron.
    pub(super) graph: GraphFacts,
}

/// A shape, seen through a coarse filling of it.
#[derive(Serialize)]
pub(super) struct ShapeFacts {
    /// Lowest and highest corner of a box around it, not the tightest \[m\].
    pub(super) bounds: [[f64; 3]; 2],
    /// Edge of the cells of the filling \[m\].
    pub(super) cell_size: f64,
    /// Pieces that the filling falls into; finer cells may join them.
    pub(super) pieces: usize,
    /// The filling of the largest piece; none where the shape is too thin for the cells.
    pub(super) filling: Option<TetFacts>,
}

impl Facts {
    /// Measures what a file holds.
    pub(super) fn of(path: &Path, input: &Input) -> Result<Self, Refusal> {
        Ok(match input {
            Input::Graph(graph) => Self::Graph { graph: GraphFacts::of(graph) },
            Input::Tri(mesh) => Self::TriangleMesh(TriangleFacts::of(path, mesh)?),
            Input::Tet(mesh) => Self::TetrahedralMesh(TetFacts::of(path, mesh)?),
            Input::Shape(shape) => Self::SignedDistance(ShapeFacts::of(path, shape)?),
        })
    }
}

impl GraphFacts {
    fn of(graph: &ConstraintGraph) -> Self {
        let degrees: Vec<u32> = graph.degrees().collect();
        let summary = DegreeSummary::of(&degrees);
        let isolated_vertices = degrees.iter().filter(|&&degree| degree == 0).count();
        Self {
            vertices: graph.n_vertices(),
            edges: graph.n_edges(),
            min_degree: summary.min,
            mean_degree: summary.mean,
            max_degree: summary.max,
            degree_deviation: summary.deviation,
            degeneracy: smallest_last(graph).degeneracy,
            components: graph.components().0 - isolated_vertices,
            isolated_vertices,
        }
    }
}

impl TriangleFacts {
    fn of(path: &Path, mesh: &TriMesh) -> Result<Self, Refusal> {
        let (edges, hinges) = (mesh.edges(), mesh.hinges());
        let edges = GraphBuilder::new(mesh.positions().len()).constraints(&edges);
        let graph_of = |constraints: &GraphBuilder<'_>| {
            let graph = constraints.build().map_err(|error| in_graph_file(path, error))?;
            Ok(GraphFacts::of(&graph))
        };
        let edge_graph = graph_of(&edges)?;
        let hinge_graph = graph_of(&edges.constraints(&hinges))?;
        let report = mesh.report();
        Ok(Self {
            vertices: report.n_vertices,
            triangles: report.n_triangles,
            edges: report.n_edges,
            hinges: report.n_hinges,
            bounds: report.bounds.map(|corner| corner.to_array()),
            components: report.n_components,
            isolated_vertices: report.n_isolated_vertices,
            euler_characteristic: report.euler_characteristic,
            closed: report.is_closed(),
            boundary_edges: report.n_boundary_edges,
            manifold: report.is_manifold(),
            nonmanifold_edges: report.n_nonmanifold_edges,
            nonmanifold_vertices: report.n_nonmanifold_vertices,
            folded_edges: report.n_folded_edges,
            oriented: report.is_oriented(),
            misoriented_edges: report.n_misoriented_edges,
            repeated_triangles: report.n_repeated_triangles,
            flat_triangles: report.n_flat_triangles,
            smallest_angle: report.min_angle,
            area: report.area,
            volume: report.volume,
            no_volume_boundary: volume_fault(mesh),
            edge_graph,
            hinge_graph,
        })
    }
}

fn volume_fault(mesh: &TriMesh) -> Option<String> {
    mesh.check_volume_boundary().err().map(|error| match error {
        MeshError::NotAVolumeBoundary { fault } => fault,
        other => other.to_string(),
    })
}

impl TetFacts {
    fn of(path: &Path, mesh: &TetMesh) -> Result<Self, Refusal> {
        let graph = ConstraintGraph::from_constraints(mesh.positions().len(), mesh.tets())
            .map_err(|error| in_graph_file(path, error))?;
        let report = mesh.report();
        Ok(Self {
            vertices: report.n_vertices,
            tetrahedra: report.n_tets,
            edges: report.n_edges,
            bounds: report.bounds.map(|corner| corner.to_array()),
            components: report.n_components,
            isolated_vertices: report.n_isolated_vertices,
            boundary_triangles: report.n_boundary_triangles,
            boundary_manifold: report.has_manifold_boundary(),
            boundary_closed: report.n_open_boundary_edges == 0,
            open_boundary_edges: report.n_open_boundary_edges,
            nonmanifold_boundary_edges: report.n_nonmanifold_boundary_edges,
            nonmanifold_boundary_vertices: report.n_nonmanifold_boundary_vertices,
            nonmanifold_faces: report.n_nonmanifold_faces,
            dihedral_angles: report.dihedral_angles,
            quality: report.quality,
            volume: report.volume,
            volumes: report.volumes,
            graph: GraphFacts::of(&graph),
        })
    }
}

impl ShapeFacts {
    fn of(path: &Path, shape: &Blend) -> Result<Self, Refusal> {
        let bounds = shape.bounds();
        let cell_size = bounds.size().max_element() / CELLS;
        let (pieces, filling) = match Stuffing::with_cell_size(cell_size).fill(shape) {
            Ok((mesh, report)) => (report.dropped.len() + 1, Some(TetFacts::of(path, &mesh)?)),
            // The cells are our choice: the file is not to blame.
            Err(MeshError::EmptyShape { .. }) => (0, None),
            Err(error) => return Err(in_mesh_file(path, error)),
        };
        let bounds = [bounds.min.to_array(), bounds.max.to_array()];
        Ok(Self { bounds, cell_size, pieces, filling })
    }
}
