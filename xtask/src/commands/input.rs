//! Files of a user: which reader a name asks for, and errors in parts.

use std::io::ErrorKind;
use std::path::Path;

use vivace_graph::{ConstraintGraph, GraphError, matrix_market};
use vivace_mesh::sdf::Blend;
use vivace_mesh::{Loaded, Mesh, MeshError, TetMesh, TriMesh};

/// What a file holds.
pub(crate) enum Input {
    /// A surface, from OBJ.
    Tri(TriMesh),
    /// A solid, from VTK.
    Tet(TetMesh),
    /// The pattern of a sparse matrix, from Matrix Market.
    Graph(ConstraintGraph),
    /// A signed distance function, from text.
    Shape(Blend),
}

/// Why a file was refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{path}: {}{reason}", line.map_or(String::new(), |line| format!("line {line}: ")))]
pub(crate) struct Refusal {
    /// The file, as the user named it.
    pub(crate) path: String,
    /// The line, from 1, where one is to blame.
    pub(crate) line: Option<usize>,
    /// What is wrong and what to do.
    pub(crate) reason: String,
}

/// Reads a file by its extension, upper or lower case; the notes say what a user should know about the reading.
pub(crate) fn read(path: &Path) -> Result<Loaded<Input>, Refusal> {
    let quiet = |mesh| Loaded { mesh, notes: Vec::new() };
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    match extension.as_str() {
        "mtx" => matrix_market::read(path)
            .map(|graph| quiet(Input::Graph(graph)))
            .map_err(|error| in_graph_file(path, error)),
        "obj" | "vtk" => vivace_mesh::load(path).map_err(|error| in_mesh_file(path, error)).and_then(
            |Loaded { mesh, notes }| match mesh {
                Mesh::Tri(mesh) => Ok(Loaded { mesh: Input::Tri(mesh), notes }),
                Mesh::Tet(mesh) => Ok(Loaded { mesh: Input::Tet(mesh), notes }),
                _ => Err(refusal(path, None, "this kind of mesh is not known here; use .obj or .vtk")),
            },
        ),
        "txt" => read_shape(path).map(|shape| quiet(Input::Shape(shape))),
        _ => Err(refusal(
            path,
            None,
            format!(
                "the format cannot be told from the extension {extension:?}; use .obj (triangles), .vtk \
                 (tetrahedra), .mtx (Matrix Market) or .txt (signed distance function)"
            ),
        )),
    }
}

fn read_shape(path: &Path) -> Result<Blend, Refusal> {
    let text = std::fs::read_to_string(path)
        .map_err(|error| refusal(path, None, format!("{error}; check the path and the permissions")))?;
    text.parse().map_err(|error| in_mesh_file(path, error))
}

/// Takes a mesh's error apart.
pub(crate) fn in_mesh_file(path: &Path, error: MeshError) -> Refusal {
    match error {
        MeshError::File { source, .. } => in_mesh_file(path, *source),
        MeshError::Line { line, reason } => refusal(path, Some(line), reason),
        other => refusal(path, None, other.to_string()),
    }
}

/// Takes a graph's error apart.
pub(crate) fn in_graph_file(path: &Path, error: GraphError) -> Refusal {
    match error {
        GraphError::InFile { error, .. } => in_graph_file(path, *error),
        GraphError::Parse { line, reason, remedy } => {
            refusal(path, Some(line), format!("{reason}; {remedy}"))
        }
        GraphError::Read { kind, .. } => {
            let kind = match kind {
                ErrorKind::NotFound => "no such file".to_owned(),
                other => other.to_string(),
            };
            refusal(path, None, format!("{kind}; check the path and the permissions"))
        }
        other => refusal(path, None, other.to_string()),
    }
}

fn refusal(path: &Path, line: Option<usize>, reason: impl Into<String>) -> Refusal {
    Refusal { path: path.display().to_string(), line, reason: reason.into() }
}
