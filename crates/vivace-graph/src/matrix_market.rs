//! Sparse matrices in the Matrix Market coordinate format (Boisvert, Pozo and Remington 1996), read for their pattern.
//!
//! Rows are vertices, and an entry off the diagonal, *whatever its value*, an edge: explicit zeros count, because whoever stored
//! them may fill them later. The diagonal is dropped, and an entry above or below it stands for both, whatever symmetry the
//! header declares. Values (`real`, `integer`, `complex`; none for `pattern`) are checked to be numbers and forgotten.
//!
//! ```
//! use vivace_graph::matrix_market;
//!
//! let text = b"%%MatrixMarket matrix coordinate real symmetric
//! % a path of three unknowns
//! 3 3 5
//! 1 1 2.0
//! 2 1 -1.0
//! 2 2 2.0
//! 3 2 -1.0
//! 3 3 2.0
//! ";
//! let graph = matrix_market::parse(text)?;
//! assert_eq!(graph.neighbors(1), [0, 2]);
//! # Ok::<(), vivace_graph::GraphError>(())
//! ```

use std::io::{self, BufWriter, Write};
use std::path::Path;

use crate::num::MAX_VERTICES;
use crate::{ConstraintGraph, GraphError};

/// Rows that a file may have beyond its length in bytes. Every row with an entry takes at least two bytes, so a file with more
/// is nearly all empty rows: a wrong header more often than a matrix, and memory for nothing.
const FREE_ROWS: usize = 1_000_000;

/// Fewest bytes of an entry: `1 1` and the end of the line before it.
const MIN_ENTRY_BYTES: usize = 4;

/// Reads a file's bytes. O(bytes); memory in proportion to what is there, not to what the header says.
///
/// # Errors
/// Anything that is not the coordinate format of a square matrix, with the line: among others a dense (`array`) matrix, an entry
/// out of range, more or fewer entries than the header says, and more than 1,000,000 + `bytes.len()` rows.
pub fn parse(bytes: &[u8]) -> Result<ConstraintGraph, GraphError> {
    let mut lines = Lines { bytes, line: 0 };
    let n_values = parse_banner(lines.next_raw().unwrap_or_default())?;

    let size_line = lines.next_tokens();
    let (n, n_entries) = match size_line {
        Some(tokens) => parse_size(lines.line, tokens, bytes.len(), lines.bytes.len())?,
        None => {
            return fail(
                lines.line,
                "the file ends before its size".into(),
                "give a line `rows columns entries`",
            );
        }
    };

    let mut edges = Vec::new();
    let mut found = 0;
    while let Some(tokens) = lines.next_tokens() {
        found += 1;
        if found > n_entries {
            let reason = format!("this is entry {found}, but the header says {n_entries}");
            return fail(lines.line, reason, "correct the header or remove the entry");
        }
        let [row, column] = parse_entry(lines.line, tokens, n, n_values)?;
        if row != column {
            edges.push([row, column]);
        }
    }
    if found < n_entries {
        return fail(lines.line, too_few(found, n_entries), "correct the header or fetch the whole file");
    }
    ConstraintGraph::from_edges(n, &edges)
}

/// Reads a file; see [`parse`].
///
/// # Errors
/// As [`parse`], and a file that cannot be read, with its path.
pub fn read(path: impl AsRef<Path>) -> Result<ConstraintGraph, GraphError> {
    let path = path.as_ref();
    let bytes = std::fs::read(path)
        .map_err(|error| GraphError::Read { path: path.to_path_buf(), kind: error.kind() })?;
    parse(&bytes).map_err(|error| GraphError::InFile { path: path.to_path_buf(), error: Box::new(error) })
}

/// Writes the graph as a symmetric pattern without diagonal: each edge once, row above column. [`parse`] gives it back as long
/// as it has no more than a million isolated vertices to spare.
///
/// # Errors
/// What `target` reports.
pub fn write(graph: &ConstraintGraph, target: impl Write) -> io::Result<()> {
    let mut target = BufWriter::new(target);
    let n = graph.n_vertices();
    writeln!(target, "%%MatrixMarket matrix coordinate pattern symmetric")?;
    writeln!(target, "{n} {n} {}", graph.n_edges())?;
    for [column, row] in graph.edges() {
        writeln!(target, "{} {}", row + 1, column + 1)?;
    }
    target.flush()
}

/// Checks the first line and says how many values follow the two indices of an entry.
fn parse_banner(line: &[u8]) -> Result<usize, GraphError> {
    const EXAMPLE: &str = "begin with a line like `%%MatrixMarket matrix coordinate real symmetric`";
    let words: Vec<String> =
        line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()).map(lowered).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let &["%%matrixmarket", object, format, field, symmetry] = words.as_slice() else {
        let reason = format!("{} is not a Matrix Market header of five words", shown(line));
        return fail(1, reason, EXAMPLE);
    };
    if object != "matrix" {
        return fail(1, format!("the object is {}, not a matrix", shown(object.as_bytes())), EXAMPLE);
    }
    if format == "array" {
        let remedy = "write its nonzero entries in the coordinate format";
        return fail(1, "the matrix is dense (`array`): its graph joins all to all".into(), remedy);
    }
    if format != "coordinate" {
        return fail(1, format!("unknown format {}", shown(format.as_bytes())), EXAMPLE);
    }
    if !["general", "symmetric", "skew-symmetric", "hermitian"].contains(&symmetry) {
        let remedy = "use general, symmetric, skew-symmetric or hermitian";
        return fail(1, format!("unknown symmetry {}", shown(symmetry.as_bytes())), remedy);
    }
    match field {
        "pattern" => Ok(0),
        "real" | "integer" | "double" => Ok(1),
        "complex" => Ok(2),
        _ => {
            let remedy = "use real, integer, complex or pattern";
            fail(1, format!("unknown field {}", shown(field.as_bytes())), remedy)
        }
    }
}

/// Checks `rows columns entries` against what the file can hold; returns rows and entries.
fn parse_size<'a>(
    line: usize,
    tokens: impl Iterator<Item = &'a [u8]>,
    n_bytes: usize,
    bytes_left: usize,
) -> Result<(usize, usize), GraphError> {
    const REMEDY: &str = "give a line `rows columns entries`";
    let tokens: Vec<&[u8]> = tokens.take(4).collect();
    let &[rows, columns, entries] = tokens.as_slice() else {
        return fail(line, format!("the size has {} words, not three", count_shown(&tokens, 3)), REMEDY);
    };
    let (rows, columns) = (parse_index(line, rows, REMEDY)?, parse_index(line, columns, REMEDY)?);
    let entries = parse_index(line, entries, REMEDY)?;
    if rows != columns {
        let reason = format!("the matrix is {rows} by {columns}");
        return fail(line, reason, "a graph needs a square matrix, such as A Aᵀ of a rectangular one");
    }
    let limit = MAX_VERTICES.min(FREE_ROWS.saturating_add(n_bytes));
    if rows > limit {
        let reason = format!("{rows} rows in a file of {n_bytes} bytes, where at most {limit} are allowed");
        return fail(line, reason, "correct the header or leave out empty rows");
    }
    // The last line may lack its end.
    if entries > (bytes_left + 1) / MIN_ENTRY_BYTES {
        let reason = format!("{entries} entries cannot fit in the {bytes_left} bytes that follow");
        return fail(line, reason, "correct the header or fetch the whole file");
    }
    Ok((rows, entries))
}

/// Checks `row column values...`; returns row and column from 0.
fn parse_entry<'a>(
    line: usize,
    mut tokens: impl Iterator<Item = &'a [u8]>,
    n: usize,
    n_values: usize,
) -> Result<[u32; 2], GraphError> {
    const REMEDY: &str = "give a line `row column` and the values that the header's field asks for";
    let mut next = |what: &str| match tokens.next() {
        Some(token) => Ok(token),
        None => fail(line, format!("the entry has no {what}"), REMEDY),
    };
    let mut pair = [0; 2];
    for (index, what) in pair.iter_mut().zip(["row", "column"]) {
        let number = parse_index(line, next(what)?, REMEDY)?;
        *index = match u32::try_from(number) {
            Ok(from_one) if from_one >= 1 && number <= n => from_one - 1,
            _ => {
                let remedy = "rows and columns are numbered from 1 to the size in the header";
                return fail(line, format!("the {what} is {number}, of {n}"), remedy);
            }
        };
    }
    for _ in 0..n_values {
        let value = next("value")?;
        if !is_number(value) {
            return fail(line, format!("{} is not a number", shown(value)), REMEDY);
        }
    }
    match tokens.next() {
        None => Ok(pair),
        Some(extra) => fail(line, format!("{} is one word too many", shown(extra)), REMEDY),
    }
}

fn parse_index(line: usize, token: &[u8], remedy: &'static str) -> Result<usize, GraphError> {
    match std::str::from_utf8(token).ok().and_then(|text| text.parse().ok()) {
        Some(number) => Ok(number),
        None => fail(line, format!("{} is not a count", shown(token)), remedy),
    }
}

/// Fortran writes `1.0D+00` for `1.0e+00`.
fn is_number(token: &[u8]) -> bool {
    let parses = |text: &str| text.parse::<f64>().is_ok();
    std::str::from_utf8(token).is_ok_and(|text| parses(text) || parses(&text.replace(['d', 'D'], "e")))
}

fn fail<T>(line: usize, reason: String, remedy: &'static str) -> Result<T, GraphError> {
    Err(GraphError::Parse { line, reason, remedy })
}

fn too_few(found: usize, n_entries: usize) -> String {
    format!("the file ends after {found} entries, but the header says {n_entries}")
}

fn count_shown(tokens: &[&[u8]], most: usize) -> String {
    if tokens.len() > most { format!("more than {most}") } else { tokens.len().to_string() }
}

fn lowered(word: &[u8]) -> String {
    String::from_utf8_lossy(word).to_lowercase()
}

/// The beginning of some bytes, fit for a message.
fn shown(bytes: &[u8]) -> String {
    const MOST: usize = 40;
    let start = String::from_utf8_lossy(&bytes[..bytes.len().min(MOST)]);
    let more = if bytes.len() > MOST { "..." } else { "" };
    format!("`{}{more}`", start.escape_debug())
}

/// What is left of a file, line by line.
struct Lines<'a> {
    bytes: &'a [u8],
    /// The line given out last, from 1.
    line: usize,
}

impl<'a> Lines<'a> {
    fn next_raw(&mut self) -> Option<&'a [u8]> {
        if self.bytes.is_empty() {
            return None;
        }
        self.line += 1;
        let (line, rest) = match self.bytes.iter().position(|&byte| byte == b'\n') {
            Some(end) => (&self.bytes[..end], &self.bytes[end + 1..]),
            None => (self.bytes, &[][..]),
        };
        self.bytes = rest;
        Some(line)
    }

    /// The words of the next line that holds any and is no comment.
    fn next_tokens(&mut self) -> Option<impl Iterator<Item = &'a [u8]> + use<'a>> {
        loop {
            let line = self.next_raw()?.trim_ascii();
            if !line.is_empty() && !line.starts_with(b"%") {
                return Some(line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(text: &str, expected: &[[u32; 2]]) {
        let graph = parse(text.as_bytes()).unwrap();
        assert_eq!(graph.edges().collect::<Vec<_>>(), expected, "{text}");
    }

    fn refused(text: &str) -> String {
        parse(text.as_bytes()).unwrap_err().to_string()
    }

    #[test]
    fn fields_and_symmetries() {
        let pair = [[0, 1]];
        check("%%MatrixMarket matrix coordinate pattern general\n2 2 1\n1 2\n", &pair);
        check("%%MatrixMarket matrix coordinate real symmetric\n2 2 2\n1 1 4\n2 1 -1.5e3", &pair);
        check("%%matrixmarket MATRIX Coordinate Integer skew-symmetric\r\n2 2 1\r\n2 1 0\r\n", &pair);
        check("%%MatrixMarket matrix coordinate complex hermitian\n2 2 1\n2 1 1.0D+00 -2\n", &pair);
        check("%%MatrixMarket matrix coordinate pattern general\n0 0 0\n", &[]);
    }

    #[test]
    fn comments_and_blank_lines() {
        check(
            "%%MatrixMarket matrix coordinate pattern general\n%\n\n 3\t3 3 \n%% here\n1 2\n  \n 2 1\n3 3\n\n",
            &[[0, 1]],
        );
    }

    #[test]
    fn the_line_and_the_remedy_are_named() {
        let real = "%%MatrixMarket matrix coordinate real general\n";
        for (text, line, part) in [
            ("", 1, "header of five words"),
            ("hello", 1, "`hello`"),
            ("%%MatrixMarket vector coordinate real general", 1, "not a matrix"),
            ("%%MatrixMarket matrix array real general\n1 1\n1", 1, "coordinate format"),
            ("%%MatrixMarket matrix coordinate quaternion general", 1, "`quaternion`"),
            ("%%MatrixMarket matrix coordinate real odd", 1, "`odd`"),
            (real, 1, "ends before its size"),
            (&format!("{real}2 2"), 2, "has 2 words"),
            (&format!("{real}2 2 1 1"), 2, "more than 3 words"),
            (&format!("{real}2 -2 1"), 2, "`-2`"),
            (&format!("{real}2 3 0"), 2, "2 by 3"),
            (&format!("{real}2 2 1\n0 1 1\n"), 3, "numbered from 1"),
            (&format!("{real}2 2 1\n% c\n1 3 1\n"), 4, "column is 3, of 2"),
            (&format!("{real}2 2 1\n1 2\n"), 3, "no value"),
            (&format!("{real}2 2 1\n1 2 x\n"), 3, "`x`"),
            (&format!("{real}2 2 1\n1 2 1 1\n"), 3, "one word too many"),
            (&format!("{real}2 2 1\n1 2 1\n2 1 1\n"), 4, "this is entry 2"),
            (&format!("{real}2 2 2\n1 2 1.00000\n\n"), 4, "ends after 1 entries"),
        ] {
            let error = refused(text);
            assert!(
                error.starts_with(&format!("line {line}: ")) && error.contains(part),
                "{text:?}: {error}"
            );
            assert!(error.contains("; "), "no remedy: {error}");
        }
    }

    #[test]
    fn a_header_alone_reserves_nothing() {
        let head = "%%MatrixMarket matrix coordinate pattern general\n";
        assert!(
            refused(&format!("{head}3 3 4000000000\n1 2\n2 3\n1 3\n")).contains("cannot fit in the 12 bytes")
        );
        assert!(
            refused(&format!("{head}4294967294 4294967294 1\n1 2\n")).contains("at most 1000077 are allowed")
        );
        assert!(refused(&format!("{head}99999999999999999999 1 1\n1 2\n")).contains("is not a count"));
        check(&format!("{head}1000000 1000000 1\n1000000 1"), &[[0, 999_999]]);
    }

    #[test]
    fn paths_are_named() {
        let path = std::env::temp_dir().join(format!("vivace-graph-{}.mtx", std::process::id()));
        let name = path.display().to_string();
        let error = read(&path).unwrap_err();
        assert!(error.to_string().contains(&name), "{error}");
        std::fs::write(&path, "%%MatrixMarket matrix coordinate pattern general\n1 1 1\n1 2\n").unwrap();
        let error = read(&path).unwrap_err();
        std::fs::remove_file(&path).unwrap();
        assert!(error.to_string().starts_with(&format!("{name}: line 3: ")), "{error}");
    }
}
