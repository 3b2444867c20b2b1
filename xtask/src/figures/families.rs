//! The three families of meshes that figures 2 and 3 color, at any size.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;

use vivace_graph::ConstraintGraph;
use vivace_mesh::irregularity::Irregularity;
use vivace_mesh::sdf::{Blend, Bounds, ClosedSurface, DILLO, HARE, SignedDistance};
use vivace_mesh::stuffing::Stuffing;
use vivace_mesh::{Mesh, MeshError, TetMesh, TriMesh, cloth, load};

use super::FigureError;

/// A shape that comes in many sizes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// A triangulated cloth, a spring on each edge.
    Cloth,
    /// The Stanford Bunny or its stand-in, in tetrahedra.
    Bunny,
    /// The Armadillo or its stand-in, in tetrahedra.
    Armadillo,
}

impl Family {
    /// In the paper's order.
    pub const ALL: [Self; 3] = [Self::Cloth, Self::Bunny, Self::Armadillo];

    /// As it stands in data files, and the word looked for in the names of the user's files.
    pub fn id(self) -> &'static str {
        match self {
            Self::Cloth => "cloth",
            Self::Bunny => "bunny",
            Self::Armadillo => "armadillo",
        }
    }
}

/// A mesh's constraint graph and where it comes from.
#[derive(Clone, Debug)]
pub struct Model {
    /// Who shares a constraint with whom.
    pub graph: ConstraintGraph,
    /// Triangles or tetrahedra.
    pub n_elements: usize,
    /// The file or the generator.
    pub source: String,
    /// How long reading or generating it took, its graph included \[s\].
    pub seconds: f64,
}

/// Where the meshes come from.
pub struct Families {
    seed: u64,
    bunny: Volume,
    armadillo: Volume,
}

/// A tetrahedral family: meshes that exist, and a shape to make others from.
struct Volume {
    /// Heading of the family's panels: says whether it is a stand-in.
    name: String,
    /// For the caption.
    origin: String,
    tets: Vec<Model>,
    shape: Option<(String, Shape)>,
    /// The file that the shape was read from.
    file: Option<PathBuf>,
}

enum Shape {
    Blend(Blend),
    Surface(Box<ClosedSurface>),
}

impl Shape {
    fn distance(&self) -> &dyn SignedDistance {
        match self {
            Self::Blend(blend) => blend,
            Self::Surface(surface) => surface.as_ref(),
        }
    }
}

/// A mesh of the user's serves for a wanted size up to this factor away from its own.
const NEAR: f64 = 1.3;

/// Animals, and the text that each is made from.
const STAND_INS: [(Family, &str, &str); 2] =
    [(Family::Bunny, "hare", HARE), (Family::Armadillo, "dillo", DILLO)];

impl Families {
    /// Generated shapes in the place of the scanned ones.
    ///
    /// # Errors
    /// [`FigureError::Mesh`] if a shape's file is broken.
    pub fn stand_ins(seed: u64) -> Result<Self, FigureError> {
        let [bunny, armadillo] = STAND_INS.map(|(family, ..)| stand_in(family));
        Ok(Self { seed, bunny: bunny?, armadillo: armadillo? })
    }

    /// The user's meshes, found by name anywhere under `folder`; a stand-in for a family without a file. Says in `notes` what was
    /// found, what is not used, and what the loaders had to say.
    ///
    /// # Errors
    /// [`FigureError::Folder`] if the folder cannot be read, [`FigureError::NoMeshes`] if it holds no mesh of either family.
    pub fn from_folder(folder: &Path, seed: u64, notes: &mut Vec<String>) -> Result<Self, FigureError> {
        let mut files = Vec::new();
        collect(folder, &mut files)?;
        files.sort();
        let bunny = from_files(Family::Bunny, &files, notes)?;
        let armadillo = from_files(Family::Armadillo, &files, notes)?;
        if bunny.is_none() && armadillo.is_none() {
            return Err(FigureError::NoMeshes { folder: folder.to_owned() });
        }
        let mut or_stand_in = |volume: Option<Volume>, family: Family| {
            volume.map_or_else(
                || {
                    notes.push(format!("no usable {} there: a stand-in takes its place", family.id()));
                    stand_in(family)
                },
                Ok,
            )
        };
        Ok(Self {
            seed,
            bunny: or_stand_in(bunny, Family::Bunny)?,
            armadillo: or_stand_in(armadillo, Family::Armadillo)?,
        })
    }

    /// Heading of a family's panels.
    pub fn name(&self, family: Family) -> &str {
        match family {
            Family::Cloth => "Cloth (springs)",
            Family::Bunny => &self.bunny.name,
            Family::Armadillo => &self.armadillo.name,
        }
    }

    /// What the meshes are and where they come from, for captions.
    pub fn caption(&self) -> String {
        format!(
            "Cloth: a jittered grid, Delaunay-triangulated, a spring on each edge. {} {} Every tetrahedron joins its four vertices with one another.",
            self.bunny.origin, self.armadillo.origin
        )
    }

    /// The file of the user's Armadillo that scenes can be filled from, and its bounds \[m\].
    pub fn own_armadillo(&self) -> Option<(&Path, Bounds)> {
        let (_, shape) = self.armadillo.shape.as_ref()?;
        Some((self.armadillo.file.as_deref()?, shape.distance().bounds()))
    }

    /// Where the Armadillo of scenes comes from, for captions.
    pub fn armadillo_origin(&self) -> String {
        // The user may have volume meshes alone whose boundary does not close.
        let is_filled = self.armadillo.shape.is_some();
        if is_filled { self.armadillo.origin.clone() } else { stand_in_origin(Family::Armadillo) }
    }

    /// Seed of the meshes.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// A mesh of each family of about `n_vertices`; made at the same time on the threads of the pool it is called in.
    ///
    /// # Errors
    /// What the generators refuse.
    pub fn models(&self, n_vertices: usize) -> Result<[Model; 3], FigureError> {
        let (cloth, (bunny, armadillo)) = rayon::join(
            || self.cloth(n_vertices),
            || {
                rayon::join(
                    || self.bunny.model(n_vertices, self.seed),
                    || self.armadillo.model(n_vertices, self.seed),
                )
            },
        );
        Ok([cloth?, bunny?, armadillo?])
    }

    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a rounded square root")]
    fn cloth(&self, n_vertices: usize) -> Result<Model, FigureError> {
        let started = Instant::now();
        let width = (n_vertices as f64).sqrt().round() as usize;
        let mesh = cloth::irregular(width, width, 1.0 / width as f32, cloth::MAX_JITTER, self.seed)?;
        Ok(Model {
            graph: ConstraintGraph::from_edges(mesh.positions().len(), &mesh.edges())?,
            n_elements: mesh.triangles().len(),
            source: format!("irregular cloth {width} x {width}"),
            seconds: started.elapsed().as_secs_f64(),
        })
    }
}

impl Volume {
    fn model(&self, n_vertices: usize, seed: u64) -> Result<Model, FigureError> {
        let away = |model: &Model| (model.graph.n_vertices() as f64 / n_vertices as f64).ln().abs();
        let nearest = self.tets.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
        match (nearest, &self.shape) {
            (Some(model), shape) if away(model) < NEAR.ln() || shape.is_none() => Ok(model.clone()),
            (_, Some(shape)) => {
                let started = Instant::now();
                Model::of_tets(&stuffed(shape, n_vertices, seed)?, format!("{} (stuffed)", shape.0), started)
            }
            (_, None) => Err(FigureError::Mesh(MeshError::Empty { what: "meshes of a family" })),
        }
    }
}

/// The shape, filled with about `n_vertices`.
fn stuffed((_, shape): &(String, Shape), n_vertices: usize, seed: u64) -> Result<TetMesh, MeshError> {
    let stuffing = Stuffing::with_about_vertices(n_vertices);
    let irregularity = Irregularity { seed, ..Irregularity::default() };
    Ok(stuffing.with_irregularity(irregularity).fill(shape.distance())?.0)
}

impl Model {
    fn of_tets(mesh: &TetMesh, source: String, started: Instant) -> Result<Self, FigureError> {
        Ok(Self {
            graph: ConstraintGraph::from_constraints(mesh.positions().len(), mesh.tets())?,
            n_elements: mesh.tets().len(),
            source,
            seconds: started.elapsed().as_secs_f64(),
        })
    }
}

fn stand_in(family: Family) -> Result<Volume, FigureError> {
    let (_, animal, text) = STAND_INS[usize::from(family == Family::Armadillo)];
    let word = if family == Family::Armadillo { "Armadillo" } else { "Bunny" };
    Ok(Volume {
        name: format!("{word} stand-in ({animal})"),
        origin: stand_in_origin(family),
        tets: Vec::new(),
        shape: Some((format!("{animal}.txt"), Shape::Blend(text.parse()?))),
        file: None,
    })
}

fn stand_in_origin(family: Family) -> String {
    let (_, animal, _) = STAND_INS[usize::from(family == Family::Armadillo)];
    let scanned = if family == Family::Armadillo { "the Armadillo" } else { "the Stanford Bunny" };
    format!(
        "STAND-IN for {scanned}: a generated {animal} (crates/vivace-mesh/shapes/{animal}.txt) by isosurface stuffing with random flips; give --meshes to use your own."
    )
}

/// Files that may be meshes, recursively.
fn collect(folder: &Path, files: &mut Vec<PathBuf>) -> Result<(), FigureError> {
    let fail = |source| FigureError::Folder { folder: folder.to_owned(), source };
    for entry in std::fs::read_dir(folder).map_err(fail)? {
        let entry = entry.map_err(fail)?;
        // A link that leads nowhere is nobody's mesh; a folder behind a link may lead back here.
        let Ok(kind) = entry.file_type() else { continue };
        let path = entry.path();
        if kind.is_dir() {
            collect(&path, files)?;
        } else if ["obj", "vtk"].iter().any(|known| has_extension(&path, known)) {
            files.push(path);
        }
    }
    Ok(())
}

fn has_extension(path: &Path, wanted: &str) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(wanted))
}

fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// A family from the files that bear its name; none if none is usable.
fn from_files(
    family: Family,
    files: &[PathBuf],
    notes: &mut Vec<String>,
) -> Result<Option<Volume>, FigureError> {
    let (mut tets, mut surfaces) = (Vec::new(), BTreeMap::new());
    let mut boundary: Option<(usize, String, TriMesh, PathBuf)> = None;
    for path in files.iter().filter(|path| file_name(path).to_lowercase().contains(family.id())) {
        let (name, started) = (file_name(path), Instant::now());
        let loaded = match load(path) {
            Ok(loaded) => loaded,
            Err(error) => {
                notes.push(format!("passed over: {error}"));
                continue;
            }
        };
        notes.extend(loaded.notes.iter().map(|note| format!("{name}: {note}")));
        match loaded.mesh {
            Mesh::Tet(mesh) => {
                let n_tets = mesh.tets().len();
                if boundary.as_ref().is_none_or(|(most, ..)| n_tets > *most)
                    && let Ok((surface, _)) = mesh.boundary_mesh()
                {
                    boundary = Some((n_tets, format!("boundary of {name}"), surface, path.clone()));
                }
                tets.push(Model::of_tets(&mesh, name, started)?);
            }
            Mesh::Tri(mesh) => {
                surfaces.insert((mesh.triangles().len(), name), (mesh, path.clone()));
            }
            _ => notes.push(format!("{name}: neither a surface nor a volume; passed over")),
        }
    }
    // The finest surface that closes; else what the largest volume mesh ends in.
    let mut candidates: Vec<(String, TriMesh, PathBuf)> =
        surfaces.into_iter().rev().map(|((_, name), (mesh, path))| (name, mesh, path)).collect();
    candidates.extend(boundary.map(|(_, name, mesh, path)| (name, mesh, path)));
    let (mut shape, mut file) = (None, None);
    for (name, mesh, path) in candidates {
        match ClosedSurface::new(&mesh) {
            Ok(surface) => {
                shape = Some((name, Shape::Surface(Box::new(surface))));
                // Scenes look for files in their own folder.
                file = std::path::absolute(path).ok();
                break;
            }
            Err(error) => notes.push(format!("{name}: cannot be filled with tetrahedra: {error}")),
        }
    }
    if tets.is_empty() && shape.is_none() {
        return Ok(None);
    }
    let name = match family {
        Family::Armadillo => "Armadillo (tetrahedra)",
        _ => "Bunny (tetrahedra)",
    };
    let names: Vec<&str> = tets.iter().map(|model| model.source.as_str()).collect();
    let used = match names.as_slice() {
        [] => String::new(),
        names => format!(" {} as they are, where one is of about the wanted size;", names.join(", ")),
    };
    let filled = match &shape {
        Some((name, _)) => format!(" other sizes from {name} by isosurface stuffing with random flips"),
        None => " no closed surface to make other sizes from".to_owned(),
    };
    let word = if family == Family::Armadillo { "Armadillo" } else { "Bunny" };
    let origin = format!(
        "{word}: the user\u{2019}s files:{used}{filled}. (The scanned models: Stanford Computer Graphics Laboratory.)"
    );
    notes.push(origin.clone());
    Ok(Some(Volume { name: name.to_owned(), origin, tets, shape, file }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stand_ins_say_so_and_have_about_the_wanted_size() {
        let families = Families::stand_ins(3).unwrap();
        assert_eq!(families.caption().matches("STAND-IN").count(), 2);
        for (family, model) in Family::ALL.into_iter().zip(families.models(600).unwrap()) {
            let n = model.graph.n_vertices();
            assert!((400..900).contains(&n), "{family:?}: {n}");
            assert!(model.n_elements > n && model.graph.min_degree() >= 2);
        }
    }

    #[test]
    fn a_folder_without_meshes_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let result =
            |path: &Path| Families::from_folder(path, 0, &mut Vec::new()).err().map(|e| e.to_string());
        assert!(result(folder.path()).is_some_and(|text| text.contains("bunny")));
        assert!(result(&folder.path().join("missing")).is_some_and(|text| text.contains("--meshes")));
        std::fs::write(folder.path().join("bunny.obj"), "v 0 0 0\nf 1 2 3\n").unwrap();
        assert!(result(folder.path()).is_some());
    }
}
