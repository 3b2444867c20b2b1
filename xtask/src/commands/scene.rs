//! Scenes from the command line: a file, or the name of a ready-made one.

use std::path::{Path, PathBuf};

use vivace_scene::{Scene, armadillo, drape, heap, noodles, pinch, tablecloth};

use super::CommandError;
use crate::figures::simulation::scenes::side;

/// The scene, and the folder that its paths are relative to; `n_vertices` resizes a ready-made one.
pub(super) fn load(path: &Path, n_vertices: Option<usize>) -> Result<(Scene, PathBuf), CommandError> {
    let name = path.to_str().unwrap_or_default();
    let resized = match (name, n_vertices) {
        (_, None) => Scene::named(name),
        ("tablecloth", Some(n)) => Some(tablecloth(side(n))),
        ("armadillo", Some(n)) => Some(armadillo(n)),
        ("drape", Some(n)) => Some(drape(side(n))),
        ("heap", Some(n)) => Some(heap(side(n / 9))),
        ("pinch", Some(n)) => Some(pinch(side(n / 9))),
        // Forty noodles, about 13 times as long as wide.
        ("noodles", Some(n)) => Some(noodles(side(n / 530))),
        _ => {
            return Err(CommandError::Usage(
                "--vertices is for tablecloth, armadillo, drape, heap, pinch and noodles; other scenes say their size themselves"
                    .to_owned(),
            ));
        }
    };
    if let Some(scene) = resized {
        return Ok((scene, PathBuf::from(".")));
    }
    let folder = path.parent().unwrap_or(Path::new("."));
    match Scene::load(path) {
        Ok(scene) => Ok((scene, folder.to_owned())),
        Err(error) if path.exists() => Err(CommandError::Failed(error.to_string())),
        Err(error) => {
            let names = Scene::NAMES.join(", ");
            Err(CommandError::Failed(format!("{error}; or give the name of a ready-made scene: {names}")))
        }
    }
}
