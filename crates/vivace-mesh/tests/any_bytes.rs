//! Whatever the bytes: an error or a mesh, never a panic, and never more memory than the text can justify.

#![expect(clippy::unwrap_used, reason = "a panic is how a test fails")]

use proptest::prelude::*;
use vivace_mesh::{ball, cloth, obj, vtk};

/// Parses both ways; what is taken must be measurable and survive writing and reading.
fn parse(bytes: &[u8]) {
    if let Ok(loaded) = obj::parse(bytes) {
        let numbers = format!("{:?}", loaded.mesh.report());
        assert!(!numbers.contains("NaN") && !numbers.contains("inf"), "{numbers}");
        assert!(loaded.mesh.hinges().iter().all(|[a, b, c, d]| a != b && c != d));
        assert_eq!(obj::parse(obj::to_text(&loaded.mesh).as_bytes()).unwrap().mesh, loaded.mesh);
        assert!(loaded.mesh.positions().len() + loaded.mesh.triangles().len() <= bytes.len());
    }
    if let Ok(loaded) = vtk::parse(bytes) {
        let numbers = format!("{:?}", loaded.mesh.report());
        assert!(!numbers.contains("NaN") && !numbers.contains("inf"), "{numbers}");
        assert!(loaded.mesh.volumes().iter().all(|&v| v > 0.0));
        assert_eq!(vtk::parse(vtk::to_text(&loaded.mesh).as_bytes()).unwrap().mesh, loaded.mesh);
        assert!(loaded.mesh.positions().len() + loaded.mesh.tets().len() <= bytes.len());
    }
}

const OBJ_WORDS: &[&str] = &[
    "v",
    "f",
    "vt",
    "vn",
    "l",
    "p",
    "o",
    "#",
    "\\",
    "\n",
    "\n",
    "\n",
    "\r\n",
    "\t",
    "1",
    "2",
    "3",
    "4",
    "-1",
    "-2",
    "0",
    "5",
    "1/2",
    "1//2",
    "1/2/3",
    "/",
    "//",
    "1/",
    "1e30",
    "1e-30",
    "-0",
    "nan",
    "inf",
    "1,5",
    "9223372036854775807",
    "-9223372036854775808",
    "4294967295",
    "\u{feff}",
    "é",
    "1e12",
    "\u{0}",
];

const VTK_WORDS: &[&str] = &[
    "# vtk DataFile Version 3.0\n",
    "ASCII\n",
    "DATASET UNSTRUCTURED_GRID\n",
    "POINTS",
    "CELLS",
    "CELL_TYPES",
    "OFFSETS",
    "CONNECTIVITY",
    "FIELD",
    "METADATA",
    "POINT_DATA",
    "CELL_DATA",
    "float\n",
    "double\n",
    "vtktypeint64\n",
    "\n",
    "0",
    "1",
    "2",
    "3",
    "4",
    "5",
    "10",
    "10\n",
    "12",
    "42",
    "-1",
    "18446744073709551615",
    "4294967295",
    "4000000000",
    "1e30",
    "nan",
    "x",
    "0.5",
    "\r\n",
];

fn words(list: &'static [&'static str]) -> impl Strategy<Value = String> {
    let word = prop_oneof![4 => prop::sample::select(list).prop_map(str::to_owned), 1 => "[0-9]{1,2}"];
    prop::collection::vec(word, 0..120).prop_map(|words| words.join(" "))
}

/// A valid file, and which of its bytes are replaced, removed, doubled; and where it is cut.
fn mutated(valid: String) -> impl Strategy<Value = Vec<u8>> {
    let n = valid.len();
    let edit = (0..n, 0..4, prop_oneof![any::<u8>(), prop::sample::select(&b" \n-0123456789.e/"[..])]);
    (prop::collection::vec(edit, 1..6), prop::option::weighted(0.2, 0..n)).prop_map(move |(edits, cut)| {
        let mut bytes = valid.clone().into_bytes();
        for (at, kind, byte) in edits {
            let at = at.min(bytes.len() - 1);
            match kind {
                0 => bytes[at] = byte,
                1 => drop(bytes.remove(at)),
                2 => bytes.insert(at, byte),
                _ => bytes.swap(at, n / 2),
            }
        }
        bytes.truncate(cut.unwrap_or(n + 6));
        bytes
    })
}

fn obj_file() -> String {
    obj::to_text(&cloth::alternating(4, 3, 0.25).unwrap())
}

fn vtk_file() -> String {
    vtk::to_text(&ball::layered(1, 1.0).unwrap())
}

fn vtk_5_file() -> String {
    "# vtk DataFile Version 5.1\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 float\n0 0 0 1 0 0 0 1 0 0 0 1 1 1 1\n\
     METADATA\nINFORMATION 0\n\nCELLS 3 8\nOFFSETS vtktypeint64\n0 4 8\nCONNECTIVITY vtktypeint64\n0 1 2 3 4 2 1 3\n\
     CELL_TYPES 2\n10\n10\nPOINT_DATA 5\n"
        .to_owned()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn arbitrary_bytes(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        parse(&bytes);
    }

    #[test]
    fn arbitrary_words_of_obj(text in words(OBJ_WORDS)) {
        parse(text.as_bytes());
        parse(format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n{text}").as_bytes());
    }

    #[test]
    fn arbitrary_words_of_vtk(text in words(VTK_WORDS)) {
        let head = "# vtk DataFile Version 4.2\nt\nASCII\nDATASET UNSTRUCTURED_GRID\n";
        parse(format!("{head}{text}").as_bytes());
        parse(format!("{head}POINTS 4 float\n0 0 0 1 0 0 0 1 0 0 0 1\nCELLS {text}").as_bytes());
    }

    #[test]
    fn mutated_obj(bytes in mutated(obj_file())) {
        parse(&bytes);
    }

    #[test]
    fn mutated_vtk(bytes in mutated(vtk_file())) {
        parse(&bytes);
    }

    #[test]
    fn mutated_vtk_5(bytes in mutated(vtk_5_file())) {
        parse(&bytes);
    }
}

#[test]
fn the_files_to_be_mutated_are_valid() {
    assert!(obj::parse(obj_file().as_bytes()).is_ok());
    assert!(vtk::parse(vtk_file().as_bytes()).is_ok());
    assert!(vtk::parse(vtk_5_file().as_bytes()).is_ok());
}

#[test]
fn every_cut_of_a_file_is_refused_or_read() {
    for file in [obj_file(), vtk_file(), vtk_5_file()] {
        for end in 0..file.len() {
            parse(&file.as_bytes()[..end]);
        }
    }
}
