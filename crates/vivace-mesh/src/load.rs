//! What reading a file gives, and reading by the file's extension.

use std::path::Path;

use crate::{MeshError, TetMesh, TriMesh, obj, vtk};

/// A mesh that was read, and what a user should know about the reading.
#[derive(Debug, Clone, PartialEq)]
pub struct Loaded<M> {
    /// The mesh.
    pub mesh: M,
    /// What was skipped, reordered or is unusual: sentences for a log, few however large the file.
    pub notes: Vec<String>,
}

impl<M> Loaded<M> {
    /// The same notes with another mesh.
    pub fn map<N>(self, change: impl FnOnce(M) -> N) -> Loaded<N> {
        Loaded { mesh: change(self.mesh), notes: self.notes }
    }
}

/// Either kind of mesh.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Mesh {
    /// A surface.
    Tri(TriMesh),
    /// A solid.
    Tet(TetMesh),
}

/// Reads a `.obj` file as a triangle mesh or a `.vtk` file as a tetrahedral mesh; case does not matter.
///
/// # Errors
/// Another extension, or what [`obj::read`] and [`vtk::read`] refuse; the message starts with the path.
pub fn load(path: impl AsRef<Path>) -> Result<Loaded<Mesh>, MeshError> {
    let path = path.as_ref();
    let extension = path.extension().unwrap_or_default().to_string_lossy().into_owned();
    match extension.to_ascii_lowercase().as_str() {
        "obj" => Ok(obj::read(path)?.map(Mesh::Tri)),
        "vtk" => Ok(vtk::read(path)?.map(Mesh::Tet)),
        _ => Err(in_file(path, MeshError::UnknownExtension { extension })),
    }
}

/// Reads a whole file and parses it; errors name the file.
pub(crate) fn read_with<T>(
    path: &Path,
    parse: impl FnOnce(&[u8]) -> Result<T, MeshError>,
) -> Result<T, MeshError> {
    let bytes = std::fs::read(path).map_err(|e| in_file(path, MeshError::Io { reason: e.to_string() }))?;
    parse(&bytes).map_err(|e| in_file(path, e))
}

/// Writes a whole file; errors name the file.
pub(crate) fn write_to(path: &Path, text: &str) -> Result<(), MeshError> {
    std::fs::write(path, text).map_err(|e| in_file(path, MeshError::Io { reason: e.to_string() }))
}

fn in_file(path: &Path, source: MeshError) -> MeshError {
    MeshError::File { path: path.to_owned(), source: Box::new(source) }
}

/// `1 vertex`, `2 vertices`.
pub(crate) fn counted(n: usize, one: &str, many: &str) -> String {
    if n == 1 { format!("1 {one}") } else { format!("{n} {many}") }
}

/// How many lines are of a kind, and where the first is.
#[derive(Default)]
pub(crate) struct Lines {
    n: usize,
    first: usize,
}

impl Lines {
    pub(crate) fn count(&mut self, line: usize) {
        if self.n == 0 {
            self.first = line;
        }
        self.n += 1;
    }

    pub(crate) fn note(&self, one: &str, many: &str, what: &str) -> Option<String> {
        (self.n > 0).then(|| format!("{} {what} (first: line {})", counted(self.n, one, many), self.first))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_read_is_named_with_its_path() {
        for (path, reason) in [
            ("no/such/mesh.obj", "check the path"),
            ("no/such/mesh.VTK", "check the path"),
            ("mesh.stl", "\"stl\""),
            ("mesh", "\"\""),
        ] {
            let message = load(path).unwrap_err().to_string();
            assert!(message.starts_with(path) && message.contains(reason), "{message}");
        }
    }
}
