//! Small scenes, each with one thing taken to its end.

use glam::Vec3;
use vivace_mesh::{TetMesh, beam, cloth};
use vivace_model::{Model, ModelBuilder, State};

use crate::figures::FigureError;

/// A scene and what is asked of it.
#[derive(Debug, Clone)]
pub struct Case {
    /// What is taken to its end.
    pub group: &'static str,
    /// How far.
    pub name: String,
    /// The model.
    pub model: Model,
    /// Where it begins.
    pub state: State,
    /// Time step \[s\].
    pub h: f32,
    /// Iterations a frame.
    pub iterations: u32,
    /// Frames.
    pub n_frames: u32,
    /// ω in the place of the method's own.
    pub omega: Option<f32>,
}

const H: f32 = 1.0 / 30.0;

/// What holds a scene.
#[derive(Clone, Copy, PartialEq)]
enum Held {
    Ends,
    All,
    Nothing,
}

/// A cloth of 12 x 12 particles, held at two corners; the corner opposite is `ratio` times as heavy.
fn sheet(stiffness: f32, ratio: f32, held: Held) -> Result<(Model, State), FigureError> {
    let mesh = cloth::regular(12, 12, 0.09)?;
    let mut of_mesh = ModelBuilder::new();
    of_mesh.cloth(&mesh, 0.2)?;
    let (plain, _) = of_mesh.build()?;
    let mut masses = plain.masses().to_vec();
    if let Some(last) = masses.last_mut() {
        *last *= ratio;
    }
    let mut builder = ModelBuilder::new();
    builder.particles(mesh.positions(), &masses)?;
    builder.springs(0, &mesh.edges(), stiffness)?;
    builder.hinges(0, &mesh.hinges(), 1e-7 * stiffness, false)?;
    for p in 0..144 {
        if held == Held::All || (held == Held::Ends && (p == 0 || p == 11)) {
            builder.pin(p)?;
        }
    }
    Ok(builder.build()?)
}

/// A beam of 4 x 2 x 2 cells, held at one end.
fn bar(mesh: &TetMesh, stiffness: f32, held: Held) -> Result<(Model, State), FigureError> {
    let mut builder = ModelBuilder::new();
    builder.volume(mesh, 1000.0)?;
    builder.tet_strain(0, mesh.tets(), stiffness)?;
    builder.tet_volume(0, mesh.tets(), stiffness, [0.95, 1.05])?;
    let first = mesh.positions().iter().map(|p| p.x).fold(f32::INFINITY, f32::min);
    for (p, at) in (0..).zip(mesh.positions()) {
        if held == Held::All || (held == Held::Ends && at.x < first + 1e-4) {
            builder.pin(p)?;
        }
    }
    Ok(builder.build()?)
}

fn bar_mesh() -> Result<TetMesh, FigureError> {
    Ok(beam::regular([4, 2, 2], 0.1)?)
}

/// The beam with its height squeezed to a thousandth: every tetrahedron is a sliver at rest.
fn sliver_mesh() -> Result<TetMesh, FigureError> {
    let mesh = bar_mesh()?;
    let squeezed = mesh.positions().iter().map(|p| Vec3::new(p.x, 1e-3 * p.y, p.z)).collect();
    Ok(TetMesh::new(squeezed, mesh.tets().to_vec())?)
}

/// Positions without any order, in a box of the size of the scene.
fn scrambled(state: &mut State, held: &Model) {
    let mut seed = 1_u32;
    let mut random = || {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (seed >> 8) as f32 / (1 << 24) as f32
    };
    for (p, at) in (0..).zip(&mut state.positions) {
        let new = Vec3::new(random(), random(), random());
        if !held.is_pinned(p) {
            *at = new;
        }
    }
}

fn free(model: &Model, state: &mut State, change: impl Fn(Vec3) -> Vec3) {
    for (p, at) in (0..).zip(&mut state.positions) {
        if !model.is_pinned(p) {
            *at = change(*at);
        }
    }
}

/// Collects cases.
struct List(Vec<Case>);

impl List {
    fn add(&mut self, group: &'static str, name: String, (model, state): (Model, State)) -> &mut Case {
        let case = Case { group, name, model, state, h: H, iterations: 20, n_frames: 30, omega: None };
        self.0.push(case);
        let last = self.0.len() - 1;
        &mut self.0[last]
    }
}

/// All cases; `reduced` leaves one of each kind, for tests.
///
/// # Errors
/// What meshes and models refuse.
pub fn cases(reduced: bool) -> Result<Vec<Case>, FigureError> {
    let mut list = List(Vec::new());
    let mesh = bar_mesh()?;
    let soft = |held| sheet(100.0, 1.0, held);
    let body = |held| bar(&mesh, 1e5, held);
    let few = |all: &[f32]| if reduced { vec![all[0], all[all.len() - 1]] } else { all.to_vec() };
    for h in few(&[1e-5, 1e-3, 1.0 / 30.0, 0.1, 1.0]) {
        list.add("time step", format!("cloth, h = {h:.0e} s"), soft(Held::Ends)?).h = h;
        list.add("time step", format!("beam, h = {h:.0e} s"), body(Held::Ends)?).h = h;
    }
    for k in few(&[1e-4, 1e-2, 1.0, 1e4, 1e6, 1e8]) {
        list.add("stiffness", format!("cloth, {k:.0e} N/m"), sheet(k, 1.0, Held::Ends)?);
    }
    for e in few(&[1e-1, 1e1, 1e3, 1e7, 1e9, 1e11]) {
        list.add("stiffness", format!("beam, {e:.0e} Pa"), bar(&mesh, e, Held::Ends)?);
    }
    for ratio in few(&[1e-6, 1e-3, 1e3, 1e6]) {
        list.add(
            "mass ratio",
            format!("cloth, a corner {ratio:.0e} times as heavy"),
            sheet(100.0, ratio, Held::Ends)?,
        );
    }
    for n in [0, 1, if reduced { 1000 } else { 10_000 }] {
        for (what, scene) in [("cloth", soft(Held::Ends)?), ("beam", body(Held::Ends)?)] {
            let case = list.add("iterations", format!("{what}, {n} a frame"), scene);
            case.iterations = n;
            if n > 1 {
                case.n_frames = if reduced { 1 } else { 2 };
            }
        }
    }
    for omega in [0.01, 1.99] {
        for (what, scene) in [("cloth", soft(Held::Ends)?), ("beam", body(Held::Ends)?)] {
            list.add("\u{3c9}", format!("{what}, \u{3c9} = {omega}"), scene).omega = Some(omega);
        }
    }
    for (held, how) in [(Held::All, "all held"), (Held::Nothing, "nothing held")] {
        list.add("anchors", format!("cloth, {how}"), soft(held)?);
        list.add("anchors", format!("beam, {how}"), body(held)?);
    }
    starts(&mut list, &mesh)?;
    list.add("slivers", "beam, a thousandth as high".to_owned(), bar(&sliver_mesh()?, 1e5, Held::Ends)?);
    for (what, (model, mut state)) in [("cloth", soft(Held::Ends)?), ("beam", body(Held::Ends)?)] {
        state.positions.iter_mut().for_each(|p| p.x += 1e6);
        list.add("far out", format!("{what}, 10\u{2076} m from the origin"), (model, state));
    }
    Ok(list.0)
}

/// A cloth with nothing at its end, for bad input.
///
/// # Errors
/// What the model refuses.
pub fn usual() -> Result<Case, FigureError> {
    let mut list = List(Vec::new());
    let name = "cloth, NaN at frame 100".to_owned();
    Ok(list.add("bad input", name, sheet(100.0, 1.0, Held::Ends)?).clone())
}

/// Bad starts: at rest, but nowhere near the rest shape.
fn starts(list: &mut List, mesh: &TetMesh) -> Result<(), FigureError> {
    for (what, scene) in [("cloth", sheet(100.0, 1.0, Held::Ends)?), ("beam", bar(mesh, 1e5, Held::Ends)?)] {
        let mut add = |how: &str, change: &dyn Fn(&Model, &mut State)| {
            let (model, mut state) = scene.clone();
            change(&model, &mut state);
            list.add("start", format!("{what}, {how}"), (model, state));
        };
        add("flat", &|model, state| free(model, state, |p| Vec3::new(p.x, 0.0, p.z)));
        add("inverted", &|model, state| free(model, state, |p| Vec3::new(-p.x, p.y, p.z)));
        add("in one point", &|model, state| free(model, state, |_| Vec3::splat(0.2)));
        add("scrambled", &|model, state| scrambled(state, model));
    }
    Ok(())
}
