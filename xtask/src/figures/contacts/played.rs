//! A scene, played, and all that is measured of each frame.

use std::path::Path;
use std::time::Instant;

use glam::{DVec3, Vec3};
use vivace_mesh::sdf::{Blend, Cuboid, SignedDistance, Sphere};
use vivace_scene::{Scene, SceneError, Solid, armadillo, noodles, pinch};
use vivace_sim::collision::Pose;
use vivace_sim::{Budget, Framework, Simulation, Solver, StepReport};
use vivace_tests::crossings::crossings;

use super::recoloring::{Change, Recoloring};
use crate::figures::FigureError;
use crate::figures::simulation::scenes::contents;
use crate::picture::{Image, Moment, Stage};
use crate::report::{Progress, Table, Value, quantile};
use crate::strain::Strain;

/// What is played, and how it is looked at.
pub struct Script {
    scene: Scene,
    solver: Solver,
    /// Iterations of each frame.
    iterations: u32,
    /// From the eye to the scene.
    direction: Vec3,
}

impl Script {
    /// Noodles, `n` vertices across.
    pub(super) fn noodles(n: usize) -> Self {
        Self::colliding(noodles(n), Vec3::new(-0.5, -0.55, -1.0))
    }

    /// The heap of cloths of `n` × (n + 1) vertices, of which one is pinched and dragged.
    pub(super) fn heap(n: usize) -> Self {
        Self::colliding(pinch(n), Vec3::new(-0.55, -0.4, -1.0))
    }

    /// The armadillo of about `n` vertices.
    pub(super) fn armadillo(n: usize) -> Self {
        let scene = armadillo(n);
        Self { scene, solver: Solver::default(), iterations: 50, direction: Vec3::new(-1.0, -0.25, 0.45) }
    }

    /// Position Based Dynamics, as the paper has it in these scenes. In fewer small steps, or with fewer iterations in each, layers of
    /// the paper's resolution jam: what a layer is pushed by has to come through those below it.
    fn colliding(scene: Scene, direction: Vec3) -> Self {
        let solver = Solver { framework: Framework::PositionBased, substeps: 8, ..Solver::default() };
        Self { scene, solver, iterations: 64, direction }
    }
}

/// One frame.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// What the step says of itself.
    pub report: StepReport,
    /// What its contacts do to graph and coloring.
    pub change: Change,
    /// The whole step \[s\].
    pub seconds: f64,
    /// Pairs of an edge and a triangle that cross.
    pub crossings: usize,
    /// How deep a particle is inside of an obstacle \[m\], at most.
    pub inside: f64,
    /// Mean and greatest stretch of the edges \[1\].
    pub stretch: [f64; 2],
}

/// A scene that has been played.
pub struct Played {
    /// Its name.
    pub name: String,
    /// What it holds.
    pub contents: String,
    /// Triangles of the surface.
    pub n_triangles: usize,
    /// Constraints.
    pub n_constraints: usize,
    /// The distance that surfaces keep \[m\], where they collide.
    pub thickness: Option<f32>,
    /// Time step \[s\].
    pub time_step: f32,
    /// Iterations of each frame.
    pub iterations: u32,
    /// The solver, in words.
    pub solver: String,
    /// Frame by frame.
    pub frames: Vec<Frame>,
    /// The start, and the end of each frame.
    moments: Vec<Moment>,
    stage: Stage,
    direction: Vec3,
}

impl Played {
    pub(super) fn play(script: Script, n_frames: u32, progress: &mut Progress) -> Result<Self, FigureError> {
        let Script { scene, solver, iterations, direction } = script;
        let folder = Path::new(".");
        let mut simulation = Simulation::new(&scene, solver)?;
        let model = simulation.model().clone();
        let strain = Strain::at_rest(&model, simulation.positions());
        let stage = Stage::new(&scene, folder, &model, simulation.positions())?;
        let solids = solids(&scene, folder)?;
        let mut recoloring = Recoloring::new(&model)?;
        let (mut frames, mut moments) = (Vec::new(), vec![Moment::now(&simulation, None)]);
        for frame in 0..n_frames {
            if frame % n_frames.div_ceil(4).max(1) == 0 {
                progress.step(&format!("{}: frame {}", scene.name, frame + 1));
            }
            let start = Instant::now();
            let report = simulation.step(Budget::iterations(iterations))?;
            let seconds = start.elapsed().as_secs_f64();
            let now = Moment::now(&simulation, moments.last());
            let has_collisions = scene.collisions.is_some();
            frames.push(Frame {
                report,
                change: recoloring.follow(simulation.contacts())?,
                seconds,
                crossings: if has_collisions { crossings(&now.positions, model.surface()).len() } else { 0 },
                inside: deepest(&solids, &now),
                stretch: strain.measure(&now.positions),
            });
            moments.push(now);
        }
        let c = model.constraints();
        Ok(Self {
            name: scene.name.clone(),
            contents: contents(&scene, &model),
            n_triangles: model.surface().len(),
            n_constraints: c.springs.len() + c.bending.len() + c.tet_strain.len(),
            thickness: scene.collisions.as_ref().map(|collisions| collisions.thickness),
            time_step: scene.time_step,
            iterations,
            solver: match solver.framework {
                Framework::PositionBased => format!("XPBD in {} small steps", solver.substeps),
                Framework::ProjectiveDynamics { .. } => "Projective Dynamics".to_owned(),
            },
            frames,
            moments,
            stage,
            direction,
        })
    }

    /// A picture `width` × `width` pixels of each of these frames; 0 is the start. One camera for all sees all the time.
    pub(super) fn pictures(&self, frames: &[usize], width: u32) -> Vec<Image> {
        let camera = self.stage.camera(frames.iter().map(|&frame| &self.moments[frame]), self.direction);
        frames.iter().map(|&frame| self.stage.render(&self.moments[frame], &camera, width, width)).collect()
    }

    /// A quantity of all frames, ascending.
    pub(super) fn sorted(&self, of: impl Fn(&Frame) -> f64) -> Vec<f64> {
        let mut all: Vec<f64> = self.frames.iter().map(of).collect();
        all.sort_by(f64::total_cmp);
        all
    }

    /// Its median.
    pub(super) fn median(&self, of: impl Fn(&Frame) -> f64) -> f64 {
        quantile(&self.sorted(of), 0.5)
    }

    /// Its greatest value.
    pub(super) fn most(&self, of: impl Fn(&Frame) -> f64) -> f64 {
        self.sorted(of).last().copied().unwrap_or(f64::NAN)
    }

    /// Median, 95%, 99% and greatest of each quantity of a frame.
    pub(super) fn summary(&self) -> Table {
        let name = format!("A frame of {}", self.name);
        let mut table = Table::new(&name, &["Of a frame", "Median", "95%", "99%", "Greatest"]);
        for (name, of) in QUANTITIES {
            let all = self.sorted(of);
            if all.iter().all(|value| value.is_finite()) {
                let at = |q| Value::from(quantile(&all, q));
                table.push([name.into(), at(0.5), at(0.95), at(0.99), at(1.0)]);
            }
        }
        table
    }

    /// A row for each frame; see [`super`].
    pub(super) fn data(&self) -> Table {
        let mut columns = vec!["scene", "frame"];
        columns.extend(COLUMNS);
        let mut table = Table::new("", &columns);
        for (idx, frame) in self.frames.iter().enumerate() {
            let values = QUANTITIES.iter().map(|(_, of)| of(frame));
            let values = values.map(|x| if x.fract() == 0.0 { Value::Int(whole(x)) } else { Value::Real(x) });
            table.push([Value::from(self.name.as_str()), (idx + 1).into()].into_iter().chain(values));
        }
        table
    }
}

/// Number without a fraction.
#[expect(clippy::cast_possible_truncation, reason = "saturates")]
fn whole(value: f64) -> i64 {
    value as i64
}

type Quantity = fn(&Frame) -> f64;

const COLUMNS: [&str; 20] = [
    "time_ms",
    "detect_ms",
    "color_ms",
    "solve_ms",
    "guard_ms",
    "contacts",
    "changed_edges",
    "recolored",
    "vertex_colors",
    "recolor_ms",
    "color_anew_ms",
    "colors",
    "iterations",
    "held_back",
    "deepest_mm",
    "mean_depth_mm",
    "crossings",
    "inside_mm",
    "mean_stretch",
    "greatest_stretch",
];

/// What is measured of a frame, in the order of [`COLUMNS`].
pub(super) const QUANTITIES: [(&str, Quantity); COLUMNS.len()] = [
    ("Time [ms]", |f| 1e3 * f.seconds),
    ("… finding contacts [ms]", |f| 1e3 * f.report.times.detect),
    ("… contacts made constraints, colored [ms]", |f| 1e3 * f.report.times.color),
    ("… solver [ms]", |f| 1e3 * f.report.times.solve),
    ("… guard [ms]", |f| 1e3 * f.report.times.guard),
    ("Contacts", |f| f.report.contacts.contacts as f64),
    ("Edges that came or went", |f| f.change.edges as f64),
    ("Vertices recolored", |f| f.change.vertices as f64),
    ("Colors of vertices", |f| f64::from(f.change.colors)),
    ("Coloring that follows the contacts [ms]", |f| 1e3 * f.change.seconds),
    ("Coloring all vertices anew [ms]", |f| 1e3 * f.change.seconds_anew),
    ("Colors of the solver", |f| f64::from(f.report.colors)),
    ("Iterations", |f| f64::from(f.report.iterations)),
    ("Particles held back by the guard", |f| f.report.contacts.held_back as f64),
    ("Nearer than the thickness, at most [mm]", |f| 1e3 * f64::from(f.report.contacts.deepest)),
    ("… in the mean of all contacts [mm]", |f| 1e3 * f64::from(f.report.contacts.mean_depth)),
    ("Pairs that cross", |f| f.crossings as f64),
    ("Inside of an obstacle, at most [mm]", |f| 1e3 * f.inside),
    ("Stretch of an edge, mean [1]", |f| f.stretch[0]),
    ("Stretch of an edge, at most [1]", |f| f.stretch[1]),
];

/// Signed distances of the scene's obstacles themselves, not of their samples, in their own coordinates.
fn solids(scene: &Scene, folder: &Path) -> Result<Vec<Box<dyn SignedDistance + Sync>>, SceneError> {
    let all = scene.collisions.iter().flat_map(|collisions| &collisions.obstacles).enumerate();
    let of = |(obstacle, of): (usize, &vivace_scene::Obstacle)| -> Result<_, SceneError> {
        Ok(match &of.solid {
            Solid::Plane => Box::new(HalfSpace) as Box<dyn SignedDistance + Sync>,
            &Solid::Sphere { radius } => Box::new(Sphere { center: DVec3::ZERO, radius: radius.into() }),
            &Solid::Box { half_extent } => {
                Box::new(Cuboid { center: DVec3::ZERO, half_extent: half_extent.as_dvec3() })
            }
            Solid::Capsule { half_length, radius } => {
                let text = format!("cone 0 -{half_length} 0 {radius} 0 {half_length} 0 {radius}");
                let blend = text.parse::<Blend>();
                Box::new(blend.map_err(|error| SceneError::Obstacle { obstacle, source: error.into() })?)
            }
            Solid::Sdf { source, .. } => source
                .distance(folder)
                .map_err(|source| SceneError::Obstacle { obstacle, source: source.into() })?,
        })
    };
    all.map(of).collect()
}

/// All that is below y = 0.
struct HalfSpace;

impl SignedDistance for HalfSpace {
    fn value(&self, point: DVec3) -> f64 {
        point.y
    }

    fn bounds(&self) -> vivace_mesh::sdf::Bounds {
        vivace_mesh::sdf::Bounds::around(DVec3::ZERO, DVec3::INFINITY)
    }
}

/// How deep a particle is inside of a solid \[m\]; 0 if none is.
fn deepest(solids: &[Box<dyn SignedDistance + Sync>], moment: &Moment) -> f64 {
    let inside = |(solid, pose): (&(dyn SignedDistance + Sync), &Pose)| {
        let back = pose.rotation.as_dquat().inverse();
        let local = |p: &Vec3| back * (p.as_dvec3() - pose.position.as_dvec3());
        moment.positions.iter().map(|p| -solid.value(local(p))).fold(0.0, f64::max)
    };
    solids.iter().map(Box::as_ref).zip(&moment.poses).map(inside).fold(0.0, f64::max)
}
