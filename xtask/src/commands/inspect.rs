//! `cargo xtask inspect`: what the user's files hold, or why they are refused.

mod facts;
mod text;

use std::path::PathBuf;

use serde::Serialize;
use vivace_mesh::Loaded;

use super::input::{self, Refusal};
use super::{CommandError, output};
use facts::Facts;

/// Say what meshes and graphs are like, or why they are refused.
///
/// Files are .obj (triangles), .vtk (tetrahedra), .mtx (a matrix in Matrix Market
/// form) or .txt (a signed distance function of cones and ellipsoids). Exit code 0
/// when every file loads, 1 when one is refused; all of them are shown.
#[derive(Debug, Clone, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Args {
    /// The files.
    #[arg(required = true)]
    pub files: Vec<PathBuf>,
    /// Write one JSON array instead of text.
    #[arg(long)]
    pub json: bool,
}

/// One file in JSON.
#[derive(Serialize)]
struct Record<'a> {
    file: String,
    loads: bool,
    #[serde(skip_serializing_if = "Option::is_none", flatten)]
    facts: Option<&'a Facts>,
    notes: &'a [String],
    #[serde(skip_serializing_if = "Option::is_none")]
    line: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<&'a str>,
}

/// Shows every file, in order.
///
/// # Errors
/// A file that is refused, once all have been shown.
pub fn run(args: Args) -> Result<(), CommandError> {
    let mut records = Vec::new();
    let mut n_refused = 0;
    for path in &args.files {
        let inspected = input::read(path).and_then(|Loaded { mesh, notes }| {
            let facts = Facts::of(path, &mesh)?;
            Ok(Loaded { mesh: facts, notes })
        });
        n_refused += usize::from(inspected.is_err());
        let name = path.display().to_string();
        if args.json {
            records.push(to_json(name, &inspected)?);
        } else {
            output::print(&text::block(&name, &inspected))?;
        }
    }
    if args.json {
        output::print(&format!("[\n{}\n]\n", records.join(",\n")))?;
    }
    match n_refused {
        0 => Ok(()),
        _ => Err(CommandError::Failed(format!(
            "{} of {} refused",
            n_refused,
            output::counted(args.files.len(), "file", "files")
        ))),
    }
}

fn to_json(file: String, inspected: &Result<Loaded<Facts>, Refusal>) -> Result<String, CommandError> {
    let record = match inspected {
        Ok(Loaded { mesh, notes }) => {
            Record { file, loads: true, facts: Some(mesh), notes, line: None, error: None }
        }
        Err(Refusal { line, reason, .. }) => {
            Record { file, loads: false, facts: None, notes: &[], line: *line, error: Some(reason) }
        }
    };
    serde_json::to_string_pretty(&record)
        .map_err(|error| CommandError::Failed(format!("cannot write {} as JSON: {error}", record.file)))
}
