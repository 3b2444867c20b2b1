//! What can go wrong while a report is written.

use std::path::{Path, PathBuf};

/// Why a report, one of its files or one of its pictures could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// A file or folder could not be written.
    #[error("cannot write {}: {source}; is the folder writable, and is there space left?", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
    /// A table could not be written as CSV.
    #[error("cannot write {} as CSV: {source}", path.display())]
    Csv {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: csv::Error,
    },
    /// A value has no form in JSON.
    #[error("cannot turn {what} into JSON: {source}")]
    Json {
        /// What was being written.
        what: String,
        /// The reason.
        source: serde_json::Error,
    },
    /// Records for a table were no plain structs.
    #[error("table {table}: record {record} is no struct with named fields")]
    Record {
        /// The table's name.
        table: String,
        /// Index of the record.
        record: usize,
    },
    /// A picture could not be rasterised or encoded.
    #[error("cannot draw {what}: {reason}")]
    Picture {
        /// The picture's name.
        what: String,
        /// The reason.
        reason: String,
    },
}

impl ReportError {
    /// A failed write to `path`.
    pub fn io(path: &Path, source: std::io::Error) -> Self {
        Self::Io { path: path.to_owned(), source }
    }

    /// A picture that could not be drawn.
    pub fn picture(what: &str, reason: impl std::fmt::Display) -> Self {
        Self::Picture { what: what.to_owned(), reason: reason.to_string() }
    }
}
