//! Legacy VTK files in ASCII, in and out: the tetrahedra of an unstructured grid.
//!
//! Read are the layout up to version 4 (`CELLS n size`, each cell led by its count) and that of 5 (`OFFSETS`, `CONNECTIVITY`).
//! Counts in headers are promises that are checked against what follows, and never reserve memory by themselves.

use std::fmt::Write as _;
use std::path::Path;

use glam::Vec3;

use crate::load::{Loaded, counted, read_with, write_to};
use crate::text::{Text, number, quoted};
use crate::{MeshError, TetMesh};

mod cells;

use cells::{Cells, tetrahedra};

/// Reads a file: see [`parse`].
///
/// # Errors
/// Those of [`parse`], and a file that cannot be read; the message starts with the path.
pub fn read(path: impl AsRef<Path>) -> Result<Loaded<TetMesh>, MeshError> {
    read_with(path.as_ref(), parse)
}

/// Parses the text of a legacy VTK file, coordinates in metres.
///
/// Vertices keep the file's order and number, used or not. Cells that are no tetrahedra, attributes and field data are skipped;
/// inverted tetrahedra get their last two corners swapped; the notes count both.
///
/// # Errors
/// [`MeshError::Line`] names the line of what is malformed: another format, version or data set, binary data, a number that is
/// none, not finite or too large, counts that do not fit, a cell that names a vertex that is not there, an end too early.
/// [`MeshError::Empty`] if there are no tetrahedra. A tetrahedron that is flat, too small for `f32` or names a vertex twice is
/// an error of [`TetMesh::new`], numbered among the tetrahedra from 0.
pub fn parse(bytes: &[u8]) -> Result<Loaded<TetMesh>, MeshError> {
    let mut reader = Reader { text: Text::new(bytes), points: None, cells: None, types: None };
    reader.header()?;
    while let Some(word) = reader.text.word_anywhere() {
        match word.to_ascii_uppercase().as_slice() {
            b"POINTS" => reader.points()?,
            b"CELLS" => reader.cells()?,
            b"CELL_TYPES" => reader.types()?,
            // Attributes come after the geometry.
            b"POINT_DATA" | b"CELL_DATA" => break,
            b"FIELD" | b"METADATA" => reader.skip_to_section(),
            _ => return Err(reader.text.error(format!("{} is no section; {SECTIONS}", quoted(word)))),
        }
    }
    reader.finish()
}

const SECTIONS: &str = "POINTS, CELLS or CELL_TYPES was expected (are there more values than announced?)";

/// The text of a legacy VTK 3.0 file with the mesh; parsed again, it gives the same mesh bit for bit.
pub fn to_text(mesh: &TetMesh) -> String {
    let (n_points, n_cells) = (mesh.positions().len(), mesh.tets().len());
    let mut text =
        String::from("# vtk DataFile Version 3.0\nVivace, metres\nASCII\nDATASET UNSTRUCTURED_GRID\n");
    // Writing to a String cannot fail. Debug gives the shortest digits that read back as the same f32.
    let _ = writeln!(text, "POINTS {n_points} float");
    for p in mesh.positions() {
        let _ = writeln!(text, "{:?} {:?} {:?}", p.x, p.y, p.z);
    }
    let _ = writeln!(text, "CELLS {n_cells} {}", 5 * n_cells);
    for [a, b, c, d] in mesh.tets() {
        let _ = writeln!(text, "4 {a} {b} {c} {d}");
    }
    let _ = writeln!(text, "CELL_TYPES {n_cells}");
    text.push_str(&"10\n".repeat(n_cells));
    text
}

/// Writes [`to_text`] into a file.
///
/// # Errors
/// A file that cannot be written; the message starts with the path.
pub fn write(path: impl AsRef<Path>, mesh: &TetMesh) -> Result<(), MeshError> {
    write_to(path.as_ref(), &to_text(mesh))
}

struct Reader<'a> {
    text: Text<'a>,
    points: Option<Vec<Vec3>>,
    cells: Option<Cells>,
    types: Option<Vec<u32>>,
}

impl Reader<'_> {
    fn header(&mut self) -> Result<(), MeshError> {
        let first = self.text.rest_of_line();
        let Some(version) = first.strip_prefix(b"# vtk DataFile Version ") else {
            return Err(self.text.error(
                "the first line is not '# vtk DataFile Version x.y'; save as a legacy VTK file (.vtk), not as XML (.vtu)",
            ));
        };
        let version = version.trim_ascii();
        let major = version.split(|&b| b == b'.').next().and_then(number::<u32>);
        if !matches!(major, Some(1..=5)) {
            return Err(self
                .text
                .error(format!("version {} is not known; save as version 3.0 or 5.1", quoted(version))));
        }
        self.text.next_line();
        self.text.next_line();
        let format = self.text.rest_of_line().trim_ascii();
        if !format.eq_ignore_ascii_case(b"ASCII") {
            return Err(self.text.error(format!("the format is {}; save as ASCII", quoted(format))));
        }
        self.text.next_line();
        let dataset = self.text.word_anywhere().unwrap_or_default();
        let kind = self.text.word().unwrap_or_default();
        if !dataset.eq_ignore_ascii_case(b"DATASET") || !kind.eq_ignore_ascii_case(b"UNSTRUCTURED_GRID") {
            let found = quoted(&[dataset, b" ", kind].concat());
            return Err(self.text.error(format!(
                "{found} holds no tetrahedra; DATASET UNSTRUCTURED_GRID is needed (tetrahedralise a surface first)"
            )));
        }
        self.end_of_line()
    }

    fn points(&mut self) -> Result<(), MeshError> {
        if self.points.is_some() {
            return Err(self.text.error("there is a second POINTS section; remove one"));
        }
        let n: usize =
            self.header_number("POINTS must be followed by the number of points and their type")?;
        self.text.rest_of_line();
        let mut points = Vec::with_capacity(n.min(self.text.bytes_left() / 6));
        for i in 0..n {
            let mut point = Vec3::ZERO;
            for k in 0..3 {
                let Some(word) = self.text.word_anywhere() else {
                    return Err(self.short("points", n, i, None));
                };
                if word[0].is_ascii_alphabetic() && number::<f32>(word).is_none() {
                    return Err(self.short("points", n, i, Some(word)));
                }
                point[k] = self.text.coordinate(word)?;
            }
            points.push(point);
        }
        self.points = Some(points);
        Ok(())
    }

    fn cells(&mut self) -> Result<(), MeshError> {
        if self.cells.is_some() {
            return Err(self.text.error("there is a second CELLS section; remove one"));
        }
        let line = self.text.line();
        let need = "CELLS must be followed by two numbers, of cells and of values";
        let (n, size) = (self.header_number::<usize>(need)?, self.header_number::<usize>(need)?);
        self.end_of_line()?;
        let with_offsets =
            self.text.clone().word_anywhere().is_some_and(|word| word.eq_ignore_ascii_case(b"OFFSETS"));
        let cells = if with_offsets {
            self.cells_by_offset(n, size, line)?
        } else {
            self.cells_by_count(n, size, line)?
        };
        self.cells = Some(cells);
        Ok(())
    }

    fn types(&mut self) -> Result<(), MeshError> {
        if self.types.is_some() {
            return Err(self.text.error("there is a second CELL_TYPES section; remove one"));
        }
        let n: usize = self.header_number("CELL_TYPES must be followed by the number of cells")?;
        self.end_of_line()?;
        let mut types = Vec::with_capacity(n.min(self.text.bytes_left() / 2));
        for i in 0..n {
            let cell_type = self.integer("cell types", n, i)?;
            types.push(cell_type);
        }
        self.types = Some(types);
        Ok(())
    }

    fn finish(self) -> Result<Loaded<TetMesh>, MeshError> {
        let missing = |section: &str| {
            let reason = format!("the file ends without {section}; it may be cut short");
            self.text.error(reason)
        };
        let points = self.points.ok_or_else(|| missing("POINTS"))?;
        let cells = self.cells.ok_or_else(|| missing("CELLS"))?;
        let types = self.types.ok_or_else(|| missing("CELL_TYPES"))?;
        if types.len() != cells.ends.len() {
            let reason = format!(
                "there are {} cells, but {} cell types; correct the counts",
                cells.ends.len(),
                types.len()
            );
            return Err(self.text.error(reason));
        }
        let tets = tetrahedra(&cells, &types, points.len())?;
        if tets.is_empty() {
            return Err(MeshError::Empty { what: "tetrahedra (cells of type 10)" });
        }
        let n_skipped = types.len() - tets.len();
        let (mesh, reordered) = TetMesh::oriented(points, tets)?;
        let mut notes = Vec::new();
        if n_skipped > 0 {
            notes.push(format!(
                "{} of other types than tetrahedra skipped",
                counted(n_skipped, "cell", "cells")
            ));
        }
        if let Some(first) = reordered.first() {
            let what = counted(reordered.len(), "inverted tetrahedron", "inverted tetrahedra");
            notes.push(format!("{what} reordered (first: tetrahedron {first})"));
        }
        let mut used = vec![false; mesh.positions().len()];
        mesh.tets().as_flattened().iter().for_each(|&v| used[v as usize] = true);
        let n_isolated = used.iter().filter(|&&u| !u).count();
        if n_isolated > 0 {
            notes.push(format!("{} in no tetrahedron", counted(n_isolated, "point", "points")));
        }
        let n_shared = mesh.n_nonmanifold_faces();
        if n_shared > 0 {
            notes.push(format!("{} of more than two tetrahedra", counted(n_shared, "triangle", "triangles")));
        }
        Ok(Loaded { mesh, notes })
    }

    /// Passes over field data or metadata, whose length only its own syntax tells.
    fn skip_to_section(&mut self) {
        const NEXT: [&[u8]; 5] = [b"POINTS", b"CELLS", b"CELL_TYPES", b"POINT_DATA", b"CELL_DATA"];
        while self.text.next_line() {
            let word = self.text.clone().word().unwrap_or_default();
            if NEXT.iter().any(|section| word.eq_ignore_ascii_case(section)) {
                return;
            }
        }
    }

    fn array_header(&mut self, name: &str) -> Result<(), MeshError> {
        match self.text.word_anywhere() {
            Some(word) if word.eq_ignore_ascii_case(name.as_bytes()) => {
                self.text.rest_of_line();
                Ok(())
            }
            Some(word) => Err(self.text.error(format!("{} stands where {name} should", quoted(word)))),
            None => Err(self.text.error(format!("the file ends where {name} should stand"))),
        }
    }

    /// A count on the line of its section.
    fn header_number<T: std::str::FromStr>(&mut self, need: &str) -> Result<T, MeshError> {
        self.text.word().and_then(number).ok_or_else(|| self.text.error(need))
    }

    fn end_of_line(&mut self) -> Result<(), MeshError> {
        match self.text.word() {
            None => Ok(()),
            Some(word) => Err(self.text.error(format!("{} is one word too many on this line", quoted(word)))),
        }
    }

    /// An integer of element `i` of `n`.
    fn integer<T: std::str::FromStr>(&mut self, what: &str, n: usize, i: usize) -> Result<T, MeshError> {
        let Some(word) = self.text.word_anywhere() else { return Err(self.short(what, n, i, None)) };
        match number(word) {
            Some(value) => Ok(value),
            None if word[0].is_ascii_alphabetic() => Err(self.short(what, n, i, Some(word))),
            None => Err(self.text.error(format!("{} is no index; write numbers from 0", quoted(word)))),
        }
    }

    fn short(&self, what: &str, n: usize, i: usize, found: Option<&[u8]>) -> MeshError {
        let end = found.map_or("the file ends".to_owned(), |word| format!("{} follows", quoted(word)));
        self.text.error(format!(
            "{n} {what} are announced, but {end} after {i}; correct the count or complete the file"
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\n";
    const POINTS: &str = "POINTS 5 float\n0 0 0 1 0 0\n0 1 0\n0 0 1 1 1 1\n";

    fn grid(rest: &str) -> Result<Loaded<TetMesh>, MeshError> {
        parse(format!("{HEAD}{POINTS}{rest}").as_bytes())
    }

    #[test]
    fn one_tetrahedron_in_both_layouts() {
        let old = grid("CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n").unwrap();
        let new =
            "CELLS 2 4\nOFFSETS vtktypeint64\n0 4\nCONNECTIVITY vtktypeint64\n0 1\n2 3\nCELL_TYPES 1\n10";
        assert_eq!(old, grid(new).unwrap());
        assert_eq!(old.mesh.tets(), [[0, 1, 2, 3]]);
        assert_eq!(
            (old.mesh.positions().len(), old.notes),
            (5, vec!["1 point in no tetrahedron".to_owned()])
        );
    }

    #[test]
    fn fields_metadata_and_attributes_are_passed_over() {
        let text = format!(
            "{HEAD}FIELD FieldData 1\nTIME 1 1 double\n0.5\n{POINTS}METADATA\nINFORMATION 0\n\ncells 1 5\n4 0 1 2 3\n\
             CELL_TYPES 1\n10\nPOINT_DATA 5\nSCALARS s float\nLOOKUP_TABLE default\nnan nan x\n"
        );
        assert_eq!(parse(text.as_bytes()).unwrap().mesh.tets().len(), 1);
    }

    #[test]
    fn other_cells_are_skipped_and_inverted_tetrahedra_reordered() {
        let loaded =
            grid("CELLS 4 18\n3 0 1 2\n4 0 2 1 3\n4 1 2 3 4\n3 0 1 2\nCELL_TYPES 4\n5 10 10 5\n").unwrap();
        assert_eq!(loaded.mesh.tets(), [[0, 2, 3, 1], [1, 2, 3, 4]]);
        let expected = [
            "2 cells of other types than tetrahedra skipped",
            "1 inverted tetrahedron reordered (first: tetrahedron 0)",
        ];
        assert_eq!(loaded.notes, expected);
    }

    #[test]
    fn faults_in_the_header_are_named() {
        for (text, reason) in [
            ("", "line 1: the first line is not"),
            ("<?xml version=\"1.0\"?>", "line 1: the first line is not"),
            ("# vtk DataFile Version 6.0\n", "line 1: version \"6.0\""),
            ("# vtk DataFile Version 3.0\nt\nBINARY\n", "line 3: the format is \"BINARY\""),
            (
                "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\n",
                "line 4: \"DATASET POLYDATA\" holds no",
            ),
            ("# vtk DataFile Version 3.0\nt\nASCII\n", "line 4: \" \" holds no"),
        ] {
            let message = parse(text.as_bytes()).unwrap_err().to_string();
            assert!(message.starts_with(reason), "{message}");
        }
    }

    #[test]
    fn faults_in_the_points_are_named() {
        for (points, line, reason) in [
            (
                "POINTS 4000000000 double\n0 0 0\n",
                7,
                "4000000000 points are announced, but the file ends after 1",
            ),
            ("POINTS 18446744073709551615 double\n", 6, "announced"),
            ("POINTS x float\n", 5, "POINTS must be followed"),
            ("POINTS -1 float\n", 5, "POINTS must be followed"),
            ("POINTS 2 float\n0 0 0\n0 0 CELLS\n", 7, "\"CELLS\" follows after 1"),
            ("POINTS 1 float\n0 0 nan\n", 6, "not finite"),
            ("POINTS 1 float\n0 0\n0,5\n", 7, "no number"),
            ("POINTS 1 float\n0 0 0 0\n", 6, "no section"),
            ("POINTS 0 float\nPOINTS 0 float\n", 6, "second POINTS"),
        ] {
            let message = parse(format!("{HEAD}{points}").as_bytes()).unwrap_err().to_string();
            assert!(message.starts_with(&format!("line {line}: ")) && message.contains(reason), "{message}");
        }
    }

    #[test]
    fn tetrahedra_that_cannot_be_simulated_are_named() {
        let flat = grid("CELLS 2 10\n4 0 1 2 3\n4 0 1 2 2\nCELL_TYPES 2\n10 10").unwrap_err();
        assert_eq!(flat, MeshError::RepeatedVertex { element: "tetrahedron", index: 1, vertex: 2 });
        let none = grid("CELLS 0 0\nCELL_TYPES 0\n").unwrap_err();
        assert!(matches!(none, MeshError::Empty { .. }));
    }

    #[test]
    fn writing_and_reading_is_the_identity() {
        let positions =
            vec![Vec3::new(-0.0, 1e-30, 0.1), Vec3::X, Vec3::Y * 12.345_67, Vec3::Z / 3.0, Vec3::ONE];
        let (mesh, _) = TetMesh::oriented(positions, vec![[0, 1, 2, 3], [4, 1, 2, 3]]).unwrap();
        let again = parse(to_text(&mesh).as_bytes()).unwrap().mesh;
        let bits = |m: &TetMesh| {
            m.positions().iter().flat_map(|p| p.to_array().map(f32::to_bits)).collect::<Vec<_>>()
        };
        assert_eq!((bits(&again), again.tets()), (bits(&mesh), mesh.tets()));
    }
}
