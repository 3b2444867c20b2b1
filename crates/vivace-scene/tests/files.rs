//! Scene files: what is read back, what is refused and with which words.

use std::path::{Path, PathBuf};

use vivace_scene::{Scene, SceneError};

fn scenes() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/scenes")
}

/// `BLESS=1 cargo test -p vivace-scene` writes the files anew.
#[test]
fn the_files_are_the_functions() {
    for name in Scene::NAMES {
        let scene = Scene::named(name).unwrap();
        let path = scenes().join(name).with_extension("ron");
        if std::env::var_os("BLESS").is_some() {
            std::fs::write(&path, scene.to_ron().unwrap()).unwrap();
        }
        assert_eq!(Scene::load(&path), Ok(scene), "{name}");
    }
    assert_eq!(Scene::named("tableclot"), None);
    assert_eq!(std::fs::read_dir(scenes()).unwrap().count(), Scene::NAMES.len());
}

#[test]
fn both_formats_read_back_what_they_wrote() {
    for name in Scene::NAMES {
        let scene = Scene::named(name).unwrap();
        assert_eq!(Scene::from_ron(&scene.to_ron().unwrap()), Ok(scene.clone()), "{name}");
        assert_eq!(Scene::from_json(&scene.to_json().unwrap()), Ok(scene), "{name}");
    }
    assert_eq!(Scene::from_ron("()"), Ok(Scene::default()));
    assert_eq!(Scene::from_json("{}"), Ok(Scene::default()));
}

#[test]
fn a_fault_in_a_text_has_its_line_and_column() {
    let faults = [
        ("(\n  nam: \"x\",\n)", 2, 3, "nam"),
        ("(\n  name: \"x\",\n  time_step: fast,\n)", 3, 14, "float"),
        ("(bodies: [(\n  shape: Cube(\n))])", 2, 10, "Cube"),
        ("(bodies: [(\n shape: Ball(n: 2, radius: 1),\n material: Volume(densty: 1),\n)])", 3, 19, "densty"),
    ];
    for (text, wanted_line, wanted_column, word) in faults {
        let Err(SceneError::Syntax { path: None, line, column, reason }) = Scene::from_ron(text) else {
            panic!("{text}: {:?}", Scene::from_ron(text));
        };
        assert!(reason.contains(word), "{reason}");
        assert_eq!((line, column), (wanted_line, wanted_column), "{text}: {reason}");
    }
    let Err(SceneError::Syntax { line, column, reason, .. }) = Scene::from_json("{\n  \"nam\": 1\n}") else {
        panic!("accepted");
    };
    assert_eq!((line, column), (2, 7));
    assert!(reason.contains("nam") && !reason.contains("line"), "{reason}");
}

#[test]
fn a_file_is_named_in_its_errors() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("bad.ron"), "(\n  nam: 1)").unwrap();
    std::fs::write(path("bad.JSON"), "{").unwrap();
    std::fs::write(path("scene.toml"), "").unwrap();
    for (name, words) in [
        ("bad.ron", "bad.ron, line 2, column 3: "),
        ("bad.JSON", "bad.JSON, line 1, column 1: "),
        ("gone.ron", "gone.ron"),
        ("scene.toml", "neither .ron nor .json"),
    ] {
        let text = Scene::load(path(name)).unwrap_err().to_string();
        assert!(text.contains(words), "{text}");
    }
}

#[test]
fn meshes_are_found_beside_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("two.obj"), "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 4\nf 2 3 4\n").unwrap();
    std::fs::write(path("ball.txt"), "cone 0 0 0 1 0 0 0 1\n").unwrap();
    let text = r#"(bodies: [
        (shape: Mesh("two.obj"), material: Cloth(bending: None)),
        (shape: Sdf(source: Path("ball.txt"), vertices: 100), material: Volume()),
        (shape: Sdf(source: Text("cone 0 0 0 1 0 0 0 1"), vertices: 100), material: Volume(), at: (3, 0, 0)),
    ])"#;
    std::fs::write(path("scene.ron"), text).unwrap();
    let scene = Scene::load(path("scene.ron")).unwrap();
    let (model, state) = scene.build(folder.path()).unwrap();
    assert_eq!((model.constraints().springs.len(), model.constraints().bending.len()), (5, 0));
    let (one, other) = state.positions[4..].split_at((model.n_particles() - 4) / 2);
    assert_eq!(one.iter().map(|p| *p + 3.0 * glam::Vec3::X).collect::<Vec<_>>(), other);

    let text = scene.build(&path("elsewhere")).unwrap_err().to_string();
    assert!(text.starts_with("body 0 (Mesh): ") && text.contains("two.obj"), "{text}");
}
