//! Meshes and pictures of frames.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use glam::Vec3;
use vivace_mesh::{TriMesh, obj};
use vivace_model::Model;
use vivace_sim::Simulation;
use vivace_sim::collision::Pose;

use super::cannot_write;
use crate::commands::CommandError;
use crate::picture::{Moment, Stage, animation};
use crate::report::Progress;

/// Form of the meshes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum Format {
    /// Surface, one file a frame
    Obj,
    /// Tetrahedra, and the triangles of cloth
    Vtk,
    /// No meshes
    None,
}

/// Width and height of a picture \[px\].
const SIZE: u32 = 480;
/// From the eye to the scene.
const DIRECTION: Vec3 = Vec3::new(-0.55, -0.35, -1.0);
/// An animation shows a frame at least this long \[s\].
const SHORTEST: f32 = 0.02;

/// Writes meshes as they come, and pictures in the end, when it is known where the camera has to look.
pub(super) struct Album {
    folder: PathBuf,
    format: Format,
    pictures: bool,
    animation: bool,
    stage: Stage,
    kept: Vec<(u64, Moment)>,
    /// Where the obstacles stood when they were last written.
    written: Vec<Option<Pose>>,
}

impl Album {
    pub(super) fn new(folder: &Path, format: Format, pictures: bool, animation: bool, stage: Stage) -> Self {
        let folder = folder.to_owned();
        Self { folder, format, pictures, animation, stage, kept: Vec::new(), written: Vec::new() }
    }

    /// Takes the frame in. Obstacles are written where they have moved.
    pub(super) fn add(&mut self, simulation: &Simulation) -> Result<(), CommandError> {
        let (model, positions, frame) = (simulation.model(), simulation.positions(), simulation.frame());
        let poses: Vec<Pose> = simulation.obstacles().collect();
        if self.pictures || self.animation {
            let moment = Moment::now(simulation, self.kept.last().map(|(_, moment)| moment));
            self.kept.push((frame, moment));
        }
        let (extension, text) = match self.format {
            Format::None => return Ok(()),
            Format::Vtk => ("vtk", vtk_text(model, positions)),
            Format::Obj => {
                let mesh = TriMesh::new(positions.to_vec(), model.surface().to_vec());
                let mesh = mesh.map_err(|error| CommandError::Failed(format!("frame {frame}: {error}")))?;
                ("obj", obj::to_text(&mesh))
            }
        };
        self.written.resize(poses.len(), None);
        for (k, pose) in poses.into_iter().enumerate() {
            if self.written[k] != Some(pose)
                && let Some(text) = self.stage.obj(k, pose)
            {
                self.write(&format!("obstacle-{k}-{frame:05}.obj"), text.as_bytes())?;
                self.written[k] = Some(pose);
            }
        }
        self.write(&format!("frame-{frame:05}.{extension}"), text.as_bytes())
    }

    /// Draws what was asked for.
    pub(super) fn finish(
        self,
        simulation: &Simulation,
        every: u64,
        progress: &mut Progress,
    ) -> Result<(), CommandError> {
        if self.kept.is_empty() {
            return Ok(());
        }
        progress.note(&format!("drawing {} pictures", self.kept.len()));
        let camera = self.stage.camera(self.kept.iter().map(|(_, moment)| moment), DIRECTION);
        let mut images = Vec::new();
        for (frame, moment) in &self.kept {
            let image = self.stage.render(moment, &camera, SIZE, SIZE);
            if self.pictures {
                self.write(&format!("frame-{frame:05}.png"), &image.png()?)?;
            }
            if self.animation {
                images.push(image);
            }
        }
        if self.animation {
            let seconds = (simulation.time_step() * every as f32).clamp(SHORTEST, 1.0);
            self.write("animation.png", &animation(&images, seconds)?)?;
        }
        Ok(())
    }

    fn write(&self, name: &str, bytes: &[u8]) -> Result<(), CommandError> {
        let path = self.folder.join(name);
        std::fs::write(&path, bytes).map_err(|error| cannot_write(&path, &error))
    }
}

/// Legacy VTK: all tetrahedra, inverted ones too, or the triangles of the surface where there are none.
fn vtk_text(model: &Model, positions: &[Vec3]) -> String {
    let c = model.constraints();
    let tets = if c.tet_strain.is_empty() { &c.tet_volume.particles } else { &c.tet_strain.particles };
    let mut in_tet = vec![false; positions.len()];
    for &corner in tets.iter().flatten() {
        in_tet[corner as usize] = true;
    }
    let is_cloth = |triangle: &&[u32; 3]| !triangle.iter().all(|&corner| in_tet[corner as usize]);
    let cells: Vec<&[u32]> = tets
        .iter()
        .map(<[u32; 4]>::as_slice)
        .chain(model.surface().iter().filter(is_cloth).map(<[u32; 3]>::as_slice))
        .collect();
    let mut text = format!(
        "# vtk DataFile Version 3.0\nVivace, metres\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS {} float\n",
        positions.len()
    );
    // Writing to a string cannot fail.
    for p in positions {
        let _ = writeln!(text, "{:?} {:?} {:?}", p.x, p.y, p.z);
    }
    let n_numbers: usize = cells.iter().map(|cell| cell.len() + 1).sum();
    let _ = writeln!(text, "CELLS {} {n_numbers}", cells.len());
    for cell in &cells {
        let _ = write!(text, "{}", cell.len());
        for corner in *cell {
            let _ = write!(text, " {corner}");
        }
        text.push('\n');
    }
    let _ = writeln!(text, "CELL_TYPES {}", cells.len());
    for cell in &cells {
        text.push_str(if cell.len() == 4 { "10\n" } else { "5\n" });
    }
    text
}
