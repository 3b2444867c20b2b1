//! Writing and reading give the same mesh, and other readers of the same formats agree with ours.

#![expect(clippy::unwrap_used, reason = "a panic is how a test fails")]

use glam::Vec3;
use proptest::prelude::*;
use vivace_mesh::{MAX_COORDINATE, Mesh, TetMesh, TriMesh, ball, beam, cloth, load, obj, vtk};
use vtkio::model::{CellType, DataSet, Piece, UnstructuredGridPiece, VertexNumbers};

fn bits(positions: &[Vec3]) -> Vec<[u32; 3]> {
    positions.iter().map(|p| p.to_array().map(f32::to_bits)).collect()
}

/// Any coordinate that a mesh may have, subnormal and negative zero among them.
fn coordinate() -> impl Strategy<Value = f32> {
    proptest::num::f32::ANY.prop_filter("in range", |x| x.abs() <= MAX_COORDINATE)
}

/// Mostly within a few metres, so that few tetrahedra are flat; now and then tiny or negative zero.
fn moderate() -> impl Strategy<Value = f32> {
    prop_oneof![6 => -3.0_f32..3.0, 1 => -1e-38_f32..1e-38, 1 => Just(-0.0)]
}

proptest! {
    #[test]
    fn obj_keeps_every_bit(
        points in prop::collection::vec([coordinate(), coordinate(), coordinate()], 1..20),
        faces in prop::collection::vec(prop::array::uniform3(any::<prop::sample::Index>()), 1..20),
    ) {
        let n = points.len();
        let triangles = faces.iter().map(|f| f.map(|v| u32::try_from(v.index(n)).unwrap())).collect();
        let mesh = TriMesh::new(points.into_iter().map(Vec3::from_array).collect(), triangles).unwrap();
        let again = obj::parse(obj::to_text(&mesh).as_bytes()).unwrap().mesh;
        prop_assert_eq!(bits(again.positions()), bits(mesh.positions()));
        prop_assert_eq!(again.triangles(), mesh.triangles());
    }

    #[test]
    fn vtk_keeps_every_bit(points in prop::collection::vec(prop::array::uniform3(moderate()), 4..40)) {
        let positions: Vec<Vec3> = points.into_iter().map(Vec3::from_array).collect();
        let cells = (0..u32::try_from(positions.len() / 4).unwrap()).map(|k| [0, 1, 2, 3].map(|c| 4 * k + c));
        let sound = cells.filter(|&tet| TetMesh::oriented(positions.clone(), vec![tet]).is_ok()).collect::<Vec<_>>();
        prop_assume!(!sound.is_empty());
        let (mesh, _) = TetMesh::oriented(positions, sound).unwrap();
        let again = vtk::parse(vtk::to_text(&mesh).as_bytes()).unwrap().mesh;
        prop_assert_eq!(bits(again.positions()), bits(mesh.positions()));
        prop_assert_eq!(again.tets(), mesh.tets());
    }
}

#[test]
fn files_are_written_and_loaded_by_extension() {
    let folder = tempfile::tempdir().unwrap();
    let (surface, solid) = (cloth::irregular(9, 7, 0.1, 0.3, 1).unwrap(), ball::layered(2, 0.3).unwrap());
    let (obj_path, vtk_path) = (folder.path().join("a.OBJ"), folder.path().join("a.vtk"));
    obj::write(&obj_path, &surface).unwrap();
    vtk::write(&vtk_path, &solid).unwrap();
    let (loaded_surface, loaded_solid) = (load(&obj_path).unwrap(), load(&vtk_path).unwrap());
    assert_eq!((loaded_surface.mesh, loaded_surface.notes), (Mesh::Tri(surface.clone()), vec![]));
    assert_eq!((loaded_solid.mesh, loaded_solid.notes), (Mesh::Tet(solid), vec![]));
    let nowhere = folder.path().join("no/such/folder.obj");
    let message = obj::write(&nowhere, &surface).unwrap_err().to_string();
    assert!(message.starts_with(&*nowhere.to_string_lossy()), "{message}");
}

/// What tobj makes of an OBJ file: the corners of all triangles as positions, for it renumbers the vertices.
fn corners_by_tobj(text: &str) -> Vec<[f32; 3]> {
    let options = tobj::LoadOptions { triangulate: true, ..Default::default() };
    let (models, _) = tobj::load_obj_buf(&mut text.as_bytes(), &options, |_| Ok(Default::default())).unwrap();
    let corner = |m: &tobj::Mesh, i: u32| [0, 1, 2].map(|k| m.positions[3 * i as usize + k]);
    models
        .iter()
        .flat_map(|m| m.mesh.indices.iter().map(|&i| corner(&m.mesh, i)).collect::<Vec<_>>())
        .collect()
}

fn corners_by_us(text: &str) -> Vec<[f32; 3]> {
    let mesh = obj::parse(text.as_bytes()).unwrap().mesh;
    mesh.triangles().as_flattened().iter().map(|&v| mesh.positions()[v as usize].to_array()).collect()
}

#[test]
fn tobj_reads_the_same_triangles() {
    let slots = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvt 1 0\nvn 0 0 1\nvn 0 1 0\n\
                 o a\nf 1/1/1 2/2/1 3/1/2 4/2/2\ng b\nf 5//1 -4//2 -3//1\r\nf 1/1\t2/2 5/1 \nf 1 2 3 4 5\n";
    for text in [slots.to_owned(), obj::to_text(&cloth::irregular(30, 20, 0.1, 0.4, 5).unwrap())] {
        assert_eq!(corners_by_us(&text), corners_by_tobj(&text));
    }
}

#[test]
fn tobj_would_lose_what_we_keep() {
    // The reasons for a reader of our own. Where this fails, tobj has changed, and the choice can be looked at again.
    let text = "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 4 3 2\nf 1 2\n";
    let options = tobj::LoadOptions { triangulate: true, ignore_lines: true, ..Default::default() };
    let (models, _) = tobj::load_obj_buf(&mut text.as_bytes(), &options, |_| Ok(Default::default())).unwrap();
    assert_eq!(models[0].mesh.positions[..3], [0.0, 1.0, 0.0], "renumbered in the order of use");
    assert_eq!(models[0].mesh.positions.len(), 9, "the unused vertex is gone, and the cut face is no error");
    assert!(obj::parse(text.as_bytes()).unwrap_err().to_string().starts_with("line 6: "));
}

/// Positions and tetrahedra as vtkio reads them.
fn grid_by_vtkio(text: &str) -> (Vec<f32>, Vec<u32>) {
    let file = vtkio::Vtk::parse_legacy_be(text.as_bytes()).unwrap();
    let DataSet::UnstructuredGrid { pieces, .. } = file.data else { panic!("no unstructured grid") };
    let Some(Piece::Inline(piece)) = pieces.into_iter().next() else { panic!("no piece") };
    let UnstructuredGridPiece { points, cells, .. } = *piece;
    let VertexNumbers::Legacy { vertices, .. } = cells.cell_verts else { panic!("not the legacy layout") };
    let (mut tets, mut rest) = (Vec::new(), vertices.as_slice());
    for cell_type in cells.types {
        let (cell, after) = rest[1..].split_at(rest[0] as usize);
        if cell_type == CellType::Tetra {
            tets.extend_from_slice(cell);
        }
        rest = after;
    }
    (points.cast_into::<f32>().unwrap(), tets)
}

#[test]
fn vtkio_reads_the_same_grid() {
    let mixed = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 float\n\
                 0.1 0 0 1 0 -1e-7\n0 1 0 0 0 1\n1.5 1 1\nCELLS 3 14\n4 0 1 2 3\n3 0 1 2\n4 4 2 1 3\nCELL_TYPES 3\n10\n5\n10\n";
    for text in [
        mixed.to_owned(),
        vtk::to_text(&beam::regular([5, 2, 3], 0.3).unwrap()),
        vtk::to_text(&ball::layered(3, 1.7).unwrap()),
    ] {
        let mesh = vtk::parse(text.as_bytes()).unwrap().mesh;
        let (points, tets) = grid_by_vtkio(&text);
        assert_eq!(mesh.positions().iter().flat_map(Vec3::to_array).collect::<Vec<_>>(), points);
        assert_eq!(mesh.tets().as_flattened(), tets);
    }
}

#[test]
fn we_read_what_vtkio_writes() {
    let mesh = beam::regular([2, 2, 2], 0.3).unwrap();
    let file = vtkio::Vtk::parse_legacy_be(vtk::to_text(&mesh).as_bytes()).unwrap();
    let mut text = String::new();
    file.write_legacy_ascii(&mut text).unwrap();
    assert_eq!(vtk::parse(text.as_bytes()).unwrap().mesh, mesh);
}
