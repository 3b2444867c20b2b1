//! The cells of an unstructured grid, in the layouts of VTK up to version 4 and from version 5.

use super::Reader;
use crate::MeshError;

/// VTK's numbers for a tetrahedron and for a polyhedron.
const TETRA: u32 = 10;
const POLYHEDRON: u32 = 42;

/// Cells of any type: their vertices one after another, and for each its line and where its vertices end.
pub(super) struct Cells {
    vertices: Vec<u32>,
    pub(super) ends: Vec<(usize, usize)>,
}

impl Reader<'_> {
    /// Up to version 4: each cell is a count and as many vertices, `size` numbers in all.
    pub(super) fn cells_by_count(
        &mut self,
        n: usize,
        size: usize,
        header: usize,
    ) -> Result<Cells, MeshError> {
        let capacity = n.min(self.text.bytes_left() / 4);
        let mut cells = Cells { vertices: Vec::new(), ends: Vec::with_capacity(capacity) };
        let misfit = |found: &str| {
            let reason =
                format!("CELLS announces {n} cells in {size} numbers, but {found}; correct the counts");
            MeshError::at(header, reason)
        };
        let mut used = 0_usize;
        for i in 0..n {
            let count = self.integer::<usize>("cells", n, i)?;
            used = used.saturating_add(1).saturating_add(count);
            if used > size {
                return Err(misfit(&format!("the first {} need {used}", i + 1)));
            }
            let line = self.text.line();
            for _ in 0..count {
                let vertex = self.integer("cells", n, i)?;
                cells.vertices.push(vertex);
            }
            cells.ends.push((line, cells.vertices.len()));
        }
        if used == size { Ok(cells) } else { Err(misfit(&format!("the cells hold {used}"))) }
    }

    /// From version 5: one offset more than cells, then all vertices.
    pub(super) fn cells_by_offset(
        &mut self,
        n: usize,
        size: usize,
        header: usize,
    ) -> Result<Cells, MeshError> {
        self.array_header("OFFSETS")?;
        let mut ends = Vec::with_capacity(n.min(self.text.bytes_left() / 2));
        let mut last = 0;
        for i in 0..n {
            let offset = self.integer::<usize>("offsets", n, i)?;
            let fits = if i == 0 { offset == 0 } else { (last..=size).contains(&offset) };
            if !fits {
                let reason = format!("offset {i} is {offset}; offsets start at 0 and rise to {size} at most");
                return Err(self.text.error(reason));
            }
            last = offset;
            if i > 0 {
                ends.push((self.text.line(), offset));
            }
        }
        if last != size {
            let reason =
                format!("the last offset is {last}, but CELLS announces {size} values; correct the counts");
            return Err(MeshError::at(header, reason));
        }
        self.array_header("CONNECTIVITY")?;
        let mut vertices = Vec::with_capacity(size.min(self.text.bytes_left() / 2));
        for i in 0..size {
            let vertex = self.integer("vertices", size, i)?;
            vertices.push(vertex);
        }
        Ok(Cells { vertices, ends })
    }
}

/// The cells that are tetrahedra. Indices of the others are checked too: a file that lies there may lie elsewhere.
pub(super) fn tetrahedra(cells: &Cells, types: &[u32], n_points: usize) -> Result<Vec<[u32; 4]>, MeshError> {
    let mut tets = Vec::new();
    let mut start = 0;
    for (index, (&(line, end), &cell_type)) in cells.ends.iter().zip(types).enumerate() {
        let vertices = &cells.vertices[start..end];
        start = end;
        if cell_type == TETRA {
            let Ok(tet) = vertices.try_into() else {
                let reason =
                    format!("cell {index} is a tetrahedron of {} vertices; it must have 4", vertices.len());
                return Err(MeshError::at(line, reason));
            };
            tets.push(tet);
        }
        // The face list of a polyhedron holds counts among its indices.
        if cell_type != POLYHEDRON
            && let Some(vertex) = vertices.iter().find(|&&v| v as usize >= n_points)
        {
            let reason =
                format!("cell {index} names point {vertex}, but there are {n_points} (numbered from 0)");
            return Err(MeshError::at(line, reason));
        }
    }
    Ok(tets)
}

#[cfg(test)]
mod tests {
    use crate::MeshError;
    use crate::vtk::parse;

    const HEAD: &str = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\n\
                        POINTS 5 float\n0 0 0 1 0 0\n0 1 0\n0 0 1 1 1 1\n";

    /// Line (within what follows the points) and text of the error.
    fn error(rest: &str) -> (usize, String) {
        match parse(format!("{HEAD}{rest}").as_bytes()) {
            Err(MeshError::Line { line, reason }) => (line - 8, reason),
            other => panic!("{rest:?}: {other:?}"),
        }
    }

    #[test]
    fn faults_in_the_cells_are_named() {
        for (rest, line, reason) in [
            ("CELLS 1 4\n4 0 1 2 3\n", 1, "the first 1 need 5"),
            ("CELLS 1 6\n4 0 1 2 3\nCELL_TYPES 1\n10\n", 1, "the cells hold 5"),
            ("CELLS 1 18446744073709551615\n18446744073709551615 0", 2, "the file ends after 0"),
            ("CELLS 2 10\n4 0 1 2 3\n4 0", 3, "the file ends after 1"),
            ("CELLS 1 5\n4 0 1 2 -3\n", 2, "\"-3\" is no index"),
            ("CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 2\n10 10", 4, "1 cells, but 2 cell types"),
            ("CELLS 1 5\n4 0 1 2 3\n", 3, "ends without CELL_TYPES"),
            ("CELLS 1 5\n4 0 1 2 5\nCELL_TYPES 1\n10", 2, "cell 0 names point 5, but there are 5"),
            ("CELLS 2 9\n4 0 1 2 3\n3 0 1 9\nCELL_TYPES 2\n10 5", 3, "cell 1 names point 9"),
            ("CELLS 1 4\n3 0 1 2\nCELL_TYPES 1\n10", 2, "a tetrahedron of 3 vertices"),
            ("CELLS 1 5 6\n", 1, "one word too many"),
            ("CELLS 2 4\nOFFSETS x\n0 3\nCONNECTIVITY x\n0 1 2 3", 1, "the last offset is 3"),
            ("CELLS 2 4\nOFFSETS x\n1 4\n", 3, "offset 0 is 1"),
            ("CELLS 3 4\nOFFSETS x\n0 4 3\n", 3, "offset 2 is 3"),
            ("CELLS 2 4\nOFFSETS x\n0 4\n0 1 2 3", 4, "where CONNECTIVITY should"),
            ("CELLS 2 4\nOFFSETS x\n0 4", 3, "ends where CONNECTIVITY should"),
            (
                "CELLS 2 4\nOFFSETS x\n0 4\nCONNECTIVITY x\n0 1 2\nCELL_TYPES",
                6,
                "\"CELL_TYPES\" follows after 3",
            ),
        ] {
            let (at, message) = error(rest);
            assert!(at == line && message.contains(reason), "{rest:?}: line {at}: {message}");
        }
    }
}
