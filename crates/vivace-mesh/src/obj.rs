//! Wavefront OBJ, in and out: the `v` and `f` lines of it.
//!
//! The reader is our own: the tobj crate renumbers vertices in the order of use, drops unused ones, takes a face cut short for
//! a line, and its errors name no line number. Tests compare the two where both can read.

use std::fmt::Write as _;
use std::path::Path;

use glam::Vec3;

use crate::load::{Lines, Loaded, counted, read_with, write_to};
use crate::text::{Text, number, quoted};
use crate::{MeshError, TriMesh};

/// Reads a file: see [`parse`].
///
/// # Errors
/// Those of [`parse`], and a file that cannot be read; the message starts with the path.
pub fn read(path: impl AsRef<Path>) -> Result<Loaded<TriMesh>, MeshError> {
    read_with(path.as_ref(), parse)
}

/// Parses the text of an OBJ file, coordinates in metres.
///
/// Vertices keep the file's order and number, used or not. Polygons become fans about their first corner. Indices may be
/// relative (negative); texture and normal slots are checked for form and dropped; `\` at the end of a line continues it;
/// a vertex may carry a weight of 1 or a color. Everything but `v` and `f` is skipped; degenerate triangles are kept. The notes
/// count what was skipped, split or is degenerate.
///
/// # Errors
/// [`MeshError::Line`] names the line of a coordinate that is no number, not finite or too large, of a vertex of fewer than
/// three coordinates, of a face of fewer than three corners, and of an index that is zero, no number or out of range.
/// [`MeshError::Empty`] if there are no vertices or no faces.
pub fn parse(bytes: &[u8]) -> Result<Loaded<TriMesh>, MeshError> {
    let mut reader = Reader::new(bytes);
    loop {
        match reader.word() {
            Some(b"v") => reader.vertex()?,
            Some(b"f") => reader.face()?,
            Some(b"l" | b"p") => reader.skipped.count(reader.text.line()),
            Some(b"vt" | b"vn" | b"vp" | b"o" | b"g" | b"s" | b"mtllib" | b"usemtl") | None => {}
            Some(_) => reader.unknown.count(reader.text.line()),
        }
        if !reader.next_line() {
            return reader.finish();
        }
    }
}

/// The text of an OBJ file with the mesh; parsed again, it gives the same mesh bit for bit.
pub fn to_text(mesh: &TriMesh) -> String {
    let mut text = String::from("# Vivace, metres\n");
    for p in mesh.positions() {
        // Debug gives the shortest digits that read back as the same f32. Writing to a String cannot fail.
        let _ = writeln!(text, "v {:?} {:?} {:?}", p.x, p.y, p.z);
    }
    for [a, b, c] in mesh.triangles().iter().map(|t| t.map(|v| u64::from(v) + 1)) {
        let _ = writeln!(text, "f {a} {b} {c}");
    }
    text
}

/// Writes [`to_text`] into a file.
///
/// # Errors
/// A file that cannot be written; the message starts with the path.
pub fn write(path: impl AsRef<Path>, mesh: &TriMesh) -> Result<(), MeshError> {
    write_to(path.as_ref(), &to_text(mesh))
}

struct Reader<'a> {
    text: Text<'a>,
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    /// The largest vertex that a face names, from 0, and the line where it first does.
    highest: Option<(u32, usize)>,
    polygons: Lines,
    skipped: Lines,
    unknown: Lines,
}

impl<'a> Reader<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        Self {
            text: Text::new(bytes),
            positions: Vec::new(),
            triangles: Vec::new(),
            highest: None,
            polygons: Lines::default(),
            skipped: Lines::default(),
            unknown: Lines::default(),
        }
    }

    /// The next word of a line and of the lines that continue it, up to a comment.
    fn word(&mut self) -> Option<&'a [u8]> {
        loop {
            let word = self.text.word()?;
            if word.starts_with(b"#") {
                self.text.rest_of_line();
                return None;
            }
            let Some(before) = word.strip_suffix(b"\\") else { return Some(word) };
            if self.text.clone().word().is_some() {
                return Some(word);
            }
            self.text.next_line();
            if !before.is_empty() {
                return Some(before);
            }
        }
    }

    /// Leaves this line and those that continue it; false at the end of the text.
    fn next_line(&mut self) -> bool {
        while self.word().is_some() {}
        self.text.next_line()
    }

    fn vertex(&mut self) -> Result<(), MeshError> {
        let line = self.text.line();
        let mut values = [0.0; 7];
        let mut n = 0;
        while let Some(word) = self.word() {
            if n == values.len() {
                return Err(MeshError::at(line, "a vertex has at most seven numbers; give x y z"));
            }
            values[n] = self.text.coordinate(word)?;
            n += 1;
        }
        match n {
            ..=2 => return Err(MeshError::at(line, format!("a vertex needs three coordinates, not {n}"))),
            // A weight is meant for rational curves, and readers differ in what they make of it.
            4 if values[3] != 1.0 => {
                let reason =
                    format!("the vertex has the weight {}; divide by it and leave it out", values[3]);
                return Err(MeshError::at(line, reason));
            }
            5 => {
                return Err(MeshError::at(
                    line,
                    "five numbers are neither a vertex, with a weight, nor with a color",
                ));
            }
            _ => {}
        }
        self.positions.push(Vec3::new(values[0], values[1], values[2]));
        Ok(())
    }

    fn face(&mut self) -> Result<(), MeshError> {
        let line = self.text.line();
        let (mut first, mut last, mut n) = (0, 0, 0_usize);
        while let Some(word) = self.word() {
            let vertex = self.corner(word)?;
            match n {
                0 => first = vertex,
                1 => {}
                _ => self.triangles.push([first, last, vertex]),
            }
            last = vertex;
            n += 1;
        }
        match n {
            ..=2 => Err(MeshError::at(
                line,
                format!("a face needs three corners, not {n}; the file may be cut short"),
            )),
            3 => Ok(()),
            _ => {
                self.polygons.count(line);
                Ok(())
            }
        }
    }

    /// The vertex, from 0, that a corner such as `7`, `-1`, `7/2`, `7//3` or `7/2/3` names.
    fn corner(&mut self, word: &[u8]) -> Result<u32, MeshError> {
        let line = self.text.line();
        let mut slots = word.split(|&b| b == b'/');
        let index = slots.next().and_then(number::<i64>);
        let other_slots_fit = slots.by_ref().take(2).all(|s| s.is_empty() || number::<i64>(s).is_some());
        let (Some(index), true, None) = (index, other_slots_fit, slots.next()) else {
            let reason = format!("{} names no vertex; write 7, -1, 7/2, 7//3 or 7/2/3", quoted(word));
            return Err(MeshError::at(line, reason));
        };
        let n_vertices = self.positions.len();
        let vertex = match index {
            0 => return Err(MeshError::at(line, "the face names vertex 0, but OBJ counts from 1")),
            1.. => index.checked_sub(1),
            ..0 => i64::try_from(n_vertices).ok().and_then(|n| n.checked_add(index)),
        };
        let Some(vertex) = vertex.and_then(|v| u32::try_from(v).ok()) else {
            return Err(out_of_range(line, index, n_vertices));
        };
        if self.highest.is_none_or(|(highest, _)| vertex > highest) {
            self.highest = Some((vertex, line));
        }
        Ok(vertex)
    }

    fn finish(self) -> Result<Loaded<TriMesh>, MeshError> {
        let n_vertices = self.positions.len();
        if n_vertices == 0 {
            return Err(MeshError::Empty { what: "vertices (lines that start with v)" });
        }
        // Faces may name vertices that come later, so that this is known only here.
        if let Some((vertex, line)) = self.highest
            && vertex as usize >= n_vertices
        {
            return Err(out_of_range(line, i64::from(vertex) + 1, n_vertices));
        }
        if self.triangles.is_empty() {
            return Err(MeshError::Empty { what: "faces (lines that start with f)" });
        }
        let mut notes = Vec::new();
        notes.extend(self.polygons.note(
            "polygon",
            "polygons",
            "split into triangles, each about its first corner",
        ));
        notes.extend(self.skipped.note("line", "lines", "with points or curves skipped"));
        notes.extend(self.unknown.note("line", "lines", "of an unknown kind skipped"));
        let mesh = TriMesh::new(self.positions, self.triangles)?;
        notes.extend(oddities(&mesh));
        Ok(Loaded { mesh, notes })
    }
}

fn out_of_range(line: usize, index: i64, n_vertices: usize) -> MeshError {
    let reason = format!("the face names vertex {index}, but there are {n_vertices}; correct or remove it");
    MeshError::at(line, reason)
}

/// Notes on what is legal, but may not be meant.
fn oddities(mesh: &TriMesh) -> Vec<String> {
    let report = mesh.report();
    let n_degenerate = report.n_repeated_triangles + report.n_flat_triangles;
    let notes = [
        (report.n_isolated_vertices, "vertex", "vertices", "without an edge"),
        (n_degenerate, "triangle", "triangles", "without area"),
        (report.n_nonmanifold_edges, "edge", "edges", "of more than two triangles, which get no hinge"),
        (report.n_misoriented_edges, "edge", "edges", "along which two triangles run in the same direction"),
        (
            report.n_components.saturating_sub(1),
            "part",
            "parts",
            "unconnected with the first (vertices are not welded)",
        ),
    ];
    notes
        .into_iter()
        .filter(|n| n.0 > 0)
        .map(|(n, one, many, what)| format!("{} {what}", counted(n, one, many)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 0 1\n";

    fn triangles(text: &str) -> Vec<[u32; 3]> {
        parse(text.as_bytes()).unwrap().mesh.triangles().to_vec()
    }

    /// The line that the error names.
    fn error_line(text: &str) -> usize {
        match parse(text.as_bytes()) {
            Err(MeshError::Line { line, .. }) => line,
            other => panic!("{text:?}: {other:?}"),
        }
    }

    #[test]
    fn a_face_is_read_in_every_form() {
        for face in [
            "1 3 2",
            "1/1/1 3/2/1 2/3/9",
            "1//1 3//1 2//1",
            "-3 -1 -2",
            "+1 3/ 2//",
            "1 3 2 # c",
            "1 3 \\\n 2",
            "1 3\\\r\n2",
        ] {
            assert_eq!(triangles(&format!("{TRIANGLE}f {face}")), [[0, 2, 1]], "{face}");
        }
    }

    #[test]
    fn vertices_keep_their_order_and_isolated_ones_stay() {
        let loaded = parse(b"v 9 9 9\nv 0 0 0 1\nv 0 0 1 .5 .5 .5\nv 8 8 8\nv 1 0 0\nf 5 3 2\n").unwrap();
        assert_eq!(loaded.mesh.positions()[0], Vec3::splat(9.0));
        assert_eq!((loaded.mesh.positions().len(), loaded.mesh.triangles()), (5, &[[4, 2, 1]][..]));
        assert_eq!(loaded.notes, ["2 vertices without an edge"]);
    }

    #[test]
    fn a_face_may_come_before_its_vertices() {
        assert_eq!(triangles(&format!("f 1 2 3\n{TRIANGLE}")), [[0, 1, 2]]);
        assert_eq!(error_line(&format!("f -1 2 3\n{TRIANGLE}")), 1);
    }

    #[test]
    fn polygons_become_fans() {
        let text = "v 0 0 0\nv 1 0 0\nv 2 1 0\nv 1 2 0\nv 0 1 0\nf 1 2 3 4 5\n";
        assert_eq!(triangles(text), [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
        let notes = parse(text.as_bytes()).unwrap().notes;
        assert_eq!(notes, ["1 polygon split into triangles, each about its first corner (first: line 6)"]);
    }

    #[test]
    fn what_is_skipped_is_counted() {
        let notes =
            parse(format!("mtllib a b\n{TRIANGLE}\ng\nl 1 2\nl 2 3\nwhat \\\nv 1\nf 1 2 2\n").as_bytes())
                .unwrap()
                .notes;
        let expected = [
            "2 lines with points or curves skipped (first: line 7)",
            "1 line of an unknown kind skipped (first: line 9)",
            "3 vertices without an edge",
            "1 triangle without area",
        ];
        assert_eq!(notes, expected);
    }

    #[test]
    fn errors_name_their_line() {
        for face in [
            "1 2",
            "1",
            "",
            "1 2 0",
            "1 2 4",
            "1 2 -4",
            "1 2 x",
            "1 2 3/x",
            "1 2 3/1/1/1",
            "1 2 3.0",
            "1 2 /3",
        ] {
            assert_eq!(error_line(&format!("{TRIANGLE}\nf {face}\n")), 5, "{face}");
        }
        for face in ["99999999999", "-9223372036854775808", "9223372036854775807", "4294967296"] {
            assert_eq!(error_line(&format!("{TRIANGLE}f 1 2 {face}\nf 1 2 3")), 4, "{face}");
        }
        for vertex in [
            "0 0",
            "",
            "0 0 x",
            "0,0 0 0",
            "nan 0 0",
            "0 inf 0",
            "0 0 1e30",
            "1 2 3 2",
            "1 2 3 4 5",
            "1 2 3 4 5 6 7 8",
        ] {
            assert_eq!(error_line(&format!("# c\nv 0 0 0\nv {vertex}\n")), 3, "{vertex}");
        }
    }

    #[test]
    fn nothing_to_read_is_an_error() {
        for text in ["", "# only a comment", "\x00\x01\u{7f}", "\n\n\n"] {
            let error = parse(text.as_bytes()).unwrap_err();
            assert!(matches!(error, MeshError::Empty { what } if what.starts_with("vertices")), "{text:?}");
        }
        let error = parse(TRIANGLE.as_bytes()).unwrap_err();
        assert!(matches!(error, MeshError::Empty { what } if what.starts_with("faces")));
    }

    #[test]
    fn writing_and_reading_is_the_identity() {
        let values = [f32::MIN_POSITIVE, 1e-45, -0.0, 1.0 / 3.0, 16_777_217.0, 1e12, -9.999_999e11, 0.1];
        let positions: Vec<Vec3> = values.iter().map(|&x| Vec3::new(x, -x, 1.0)).collect();
        let mesh = TriMesh::new(positions, vec![[0, 1, 2], [7, 7, 3]]).unwrap();
        let again = parse(to_text(&mesh).as_bytes()).unwrap().mesh;
        let bits = |m: &TriMesh| {
            m.positions().iter().flat_map(|p| p.to_array().map(f32::to_bits)).collect::<Vec<_>>()
        };
        assert_eq!((bits(&again), again.triangles()), (bits(&mesh), mesh.triangles()));
    }
}
