//! Stills of animations, a row for each method. The columns of the data of figures 6 and 7 (`figN` stands for either):
//!
//! - `figN.csv`, a row for each still: `limit`, `method`, `frame`, `time_ms` (mean of the solver over the animation), `colors`,
//!   `iterations`, `error` (of that frame, see figures 4 and 5; empty where it blew up before), `greatest_strain` (of any edge,
//!   against its length at the start), `anchor_strain` (mean over the edges within a tenth of the scene's size of a held particle).

use glam::Vec3;
use vivace_model::State;

use super::methods::{self, Method};
use super::runs::{self, Limit, Plan, Run};
use super::scenes::Scene;
use crate::figures::{Context, FigureError};
use crate::picture::{BACKGROUND, Camera, Mesh3, Paint, Picture};
use crate::report::{Cell, Figure, PictureGrid, Table, Value};

/// What a figure of stills is about.
pub(super) struct Subject<'a> {
    pub(super) id: &'a str,
    pub(super) title: &'a str,
    /// Time budget of a frame \[ms\].
    pub(super) ms: f64,
    /// Methods beside the converged one, from the top.
    pub(super) methods: &'a [&'a str],
    /// From the eye to the scene.
    pub(super) direction: Vec3,
    /// The strain that has the color at the end of the scale.
    pub(super) most_strain: f32,
}

/// A row of stills that was simulated.
pub(super) struct Row {
    pub(super) name: &'static str,
    pub(super) run: Run,
    /// Mean strain near what is held, still by still.
    pub(super) anchors: Vec<f32>,
}

/// Equal work: sweeps a frame.
const WORK: u32 = 50;
/// Alternations a frame of the converged row.
const CONVERGED: u32 = 200;

/// Simulates and draws the rows.
pub(super) fn make(
    context: &mut Context<'_>,
    subject: &Subject<'_>,
    scene: &Scene,
    command: &str,
) -> Result<(Figure, Vec<Row>), FigureError> {
    let sizes = context.sizes.simulation.clone();
    let quarter = sizes.n_frames.div_ceil(4).max(1);
    let keep: Vec<u32> = (1..=4).map(|k| (k * quarter).min(sizes.n_frames)).collect();
    let plan = Plan { n_frames: sizes.n_frames, every: quarter, keep };
    let edges = edges(scene);
    let limits = [Limit::Milliseconds(subject.ms), Limit::Sweeps(WORK)];
    let all = methods::methods_for(scene);
    let mut jobs: Vec<(&'static str, Method, Limit)> = Vec::new();
    for limit in limits {
        let found = subject.methods.iter().filter_map(|name| all.iter().find(|m| m.name == *name).copied());
        jobs.extend(found.map(|method| (method.name, method, limit)));
    }
    jobs.extend(methods::named(methods::DIRECT).map(|m| ("Converged", m, Limit::Sweeps(CONVERGED))));
    let mut rows = Vec::new();
    for (name, method, limit) in jobs {
        context.progress.step(&format!("{}: {name}", limit.name()));
        let run = context.pool.install(|| runs::animate(scene, &method, limit, &plan))?;
        let anchors = run.kept.iter().map(|(_, state)| near_anchors(scene, &edges, state)).collect();
        rows.push(Row { name, run, anchors });
    }
    context.progress.step("pictures");
    let mut figure = Figure::new(subject.id, subject.title, command, "");
    let converged = rows.last();
    let camera = camera(scene, subject, &rows);
    for limit in limits {
        let title = format!("Stills at {}", limit.name());
        let columns: Vec<String> = plan.keep.iter().map(|frame| format!("Frame {frame}")).collect();
        let columns: Vec<&str> = columns.iter().map(String::as_str).collect();
        let mut grid = PictureGrid::new(&title, &columns).cell_width(210.0);
        for row in rows.iter().filter(|row| row.run.limit == limit).chain(converged) {
            let second = if row.name == "Converged" {
                format!("Direct, {CONVERGED} iterations")
            } else {
                format!("{:.0} iterations a frame", row.run.iterations())
            };
            grid = grid
                .row((row.name, &second), cells(scene, subject, &edges, &camera, &plan, row, sizes.still)?);
        }
        let note = format!(
            "Color: greatest strain of the edges at a vertex, from 0 (blue) to {:.0}% and more (yellow). What leaves the picture has stretched that far.",
            100.0 * subject.most_strain
        );
        figure = figure.grid(grid.note(&note));
    }
    figure = figure
        .data(data(scene, &edges, &plan, &rows))
        .option("vertices", scene.model.n_particles())
        .option("frames", sizes.n_frames);
    Ok((figure, rows))
}

/// How many steps of progress `make` takes.
pub(super) fn n_steps(subject: &Subject<'_>) -> u64 {
    2 * subject.methods.len() as u64 + 2
}

/// Sees the converged row, and of the others what is no farther out than a fifth of its size.
fn camera(scene: &Scene, subject: &Subject<'_>, rows: &[Row]) -> Camera {
    let positions = |row: &'_ Row| -> Vec<Vec3> {
        row.run.kept.iter().flat_map(|(_, state)| state.positions.iter().copied()).collect()
    };
    let mut seen = scene.state.positions.clone();
    seen.extend(rows.last().map(positions).unwrap_or_default());
    let low = seen.iter().copied().fold(Vec3::INFINITY, Vec3::min);
    let high = seen.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
    let room = 0.2 * (high - low);
    seen.extend(rows.iter().flat_map(positions).map(|p| p.clamp(low - room, high + room)));
    Camera::framing(seen, subject.direction)
}

fn cells(
    scene: &Scene,
    subject: &Subject<'_>,
    edges: &[[u32; 2]],
    camera: &Camera,
    plan: &Plan,
    row: &Row,
    width: u32,
) -> Result<Vec<Cell>, FigureError> {
    let mut cells = Vec::new();
    for frame in &plan.keep {
        let Some((_, state)) = row.run.kept.iter().find(|(kept, _)| kept == frame) else {
            let image = Picture::render(&[], camera, width, width);
            debug_assert!(image.pixels.starts_with(&BACKGROUND));
            let when = row.run.blown_up.unwrap_or(*frame);
            cells.push(Cell::new(image.png()?, &[format!("blown up at frame {when}")]));
            continue;
        };
        let strains = vertex_strains(scene, edges, &state.positions);
        let mesh = Mesh3 {
            positions: &state.positions,
            triangles: scene.model.surface(),
            // The dark end of the colors would hide the light.
            colors: Paint::Scalar {
                values: &strains,
                low: -0.3 * subject.most_strain,
                high: subject.most_strain,
            },
        };
        let image = Picture::render(&[mesh], camera, width, width);
        let measured = row.run.frames.iter().find(|f| f.frame == *frame);
        let lines = measured.map_or_else(
            || vec!["not measured".to_owned()],
            |f| {
                let colors = if f.colors == 0 { String::new() } else { format!(", {} colors", f.colors) };
                vec![
                    format!("error {}", Value::Real(f.error).shown()),
                    format!("{:.1} ms, {} iterations{colors}", f.ms, f.iterations),
                ]
            },
        );
        cells.push(Cell::new(image.png()?, &lines));
    }
    Ok(cells)
}

fn data(scene: &Scene, edges: &[[u32; 2]], plan: &Plan, rows: &[Row]) -> Table {
    let columns = [
        "limit",
        "method",
        "frame",
        "time_ms",
        "colors",
        "iterations",
        "error",
        "greatest_strain",
        "anchor_strain",
    ];
    let mut table = Table::new("", &columns);
    for row in rows {
        for frame in &plan.keep {
            let measured = row.run.frames.iter().find(|f| f.frame == *frame);
            let kept = row.run.kept.iter().position(|(kept, _)| kept == frame);
            let strain = kept.map(|k| {
                vertex_strains(scene, edges, &row.run.kept[k].1.positions).into_iter().fold(0.0_f32, f32::max)
            });
            table.push([
                row.run.limit.name().into(),
                row.name.into(),
                (*frame).into(),
                row.run.mean_ms.into(),
                measured.map(|f| f.colors).into(),
                measured.map(|f| f.iterations).into(),
                measured.map(|f| f.error).into(),
                strain.into(),
                kept.map(|k| row.anchors[k]).into(),
            ]);
        }
    }
    table
}

/// Pairs of particles that a spring or a tetrahedron joins, without hinges.
fn edges(scene: &Scene) -> Vec<[u32; 2]> {
    let constraints = scene.model.constraints();
    let mut edges = constraints.springs.particles.clone();
    for [a, b, c, d] in &constraints.tet_strain.particles {
        for (p, q) in [(a, b), (a, c), (a, d), (b, c), (b, d), (c, d)] {
            edges.push([*p.min(q), *p.max(q)]);
        }
    }
    edges.sort_unstable();
    edges.dedup();
    edges
}

fn strain(scene: &Scene, positions: &[Vec3], [a, b]: [u32; 2]) -> f32 {
    let length = |p: &[Vec3]| p[a as usize].distance(p[b as usize]);
    (length(positions) / length(&scene.state.positions) - 1.0).abs()
}

fn vertex_strains(scene: &Scene, edges: &[[u32; 2]], positions: &[Vec3]) -> Vec<f32> {
    let mut strains = vec![0.0_f32; positions.len()];
    for &edge in edges {
        let strain = strain(scene, positions, edge);
        for p in edge {
            strains[p as usize] = strains[p as usize].max(strain);
        }
    }
    strains
}

/// Mean strain of the edges within a tenth of the scene's size of a held particle.
fn near_anchors(scene: &Scene, edges: &[[u32; 2]], state: &State) -> f32 {
    let start = &scene.state.positions;
    let held: Vec<Vec3> =
        (0..).zip(start).filter(|(p, _)| scene.model.is_pinned(*p)).map(|(_, at)| *at).collect();
    let near = 0.1 * runs::size(start);
    let is_near = |p: u32| held.iter().any(|at| at.distance(start[p as usize]) < near);
    let strains: Vec<f32> = edges
        .iter()
        .filter(|[a, b]| {
            is_near(*a) && is_near(*b) && !(scene.model.is_pinned(*a) && scene.model.is_pinned(*b))
        })
        .map(|edge| strain(scene, &state.positions, *edge))
        .collect();
    strains.iter().sum::<f32>() / strains.len().max(1) as f32
}
