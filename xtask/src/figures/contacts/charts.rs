//! What is drawn of a scene that was played.

use super::played::{Frame, Played, QUANTITIES};
use crate::figures::FigureError;
use crate::picture::animation;
use crate::report::{Axis, Cell, Chart, Figure, Panel, PictureGrid, Series};

/// Stills of a figure.
const STILLS: usize = 4;
/// An animation shows one frame of so many.
const EVERY: usize = 2;

/// Frames evenly over the animation, the last one included.
fn keep(n_frames: usize) -> Vec<usize> {
    (1..=STILLS).map(|k| k * n_frames / STILLS).collect()
}

/// Stills in a row, with what is known of their frames.
pub(super) fn stills(played: &Played, width: u32) -> Result<PictureGrid, FigureError> {
    let frames = keep(played.frames.len());
    let columns: Vec<String> = frames.iter().map(|frame| format!("Frame {frame}")).collect();
    let columns: Vec<&str> = columns.iter().map(String::as_str).collect();
    let mut cells = Vec::new();
    for (&frame, image) in frames.iter().zip(played.pictures(&frames, width)) {
        let Some(of) = frame.checked_sub(1).map(|idx| &played.frames[idx]) else { continue };
        let lines = [
            format!("{:.0} ms, solver alone {:.0} ms", 1e3 * of.seconds, 1e3 * of.report.times.solve),
            format!("{} contacts, {} iterations", of.report.contacts.contacts, of.report.iterations),
            format!("{} edges came or went", of.change.edges),
            format!("{} vertices recolored", of.change.vertices),
            format!("stretch {:.1}%, {} pairs cross", 100.0 * of.stretch[0], of.crossings),
        ];
        cells.push(Cell::new(image.png()?, &lines));
    }
    Ok(PictureGrid::new(&format!("Stills of {}", played.name), &columns)
        .cell_width(230.0)
        .row(("", ""), cells))
}

/// The figure with an animation of the scene.
pub(super) fn with_animation(figure: Figure, played: &Played, width: u32) -> Result<Figure, FigureError> {
    let frames: Vec<usize> = (0..=played.frames.len()).step_by(EVERY).collect();
    let images = played.pictures(&frames, width);
    let bytes = animation(&images, played.time_step * EVERY as f32)?;
    Ok(figure.image(&format!("Animation of {}", played.name), "apng", bytes))
}

/// Everything that is measured, over the frames.
pub(super) fn over_time(played: &Played) -> Chart {
    let line = |name: &str, of: &dyn Fn(&Frame) -> f64| {
        let points = played.frames.iter().enumerate().map(|(k, frame)| ((k + 1) as f64, of(frame)));
        Series::line(name, points)
    };
    let measured = |wanted: &str, name: &str| {
        let of =
            QUANTITIES.iter().find(|(known, _)| *known == wanted).map_or(none as fn(&Frame) -> f64, |q| q.1);
        line(name, &of)
    };
    let frame = || Axis::linear("Frame").min(0.0);
    let mut time = Panel::new("Time by phase", frame(), Axis::linear("Time").unit("ms").min(0.0));
    for (wanted, name) in [
        ("Time [ms]", "Whole frame"),
        ("… solver [ms]", "Solver alone"),
        ("… finding contacts [ms]", "Finding contacts"),
        ("… guard [ms]", "Guard"),
        ("… contacts made constraints, colored [ms]", "Coloring contacts"),
    ] {
        time = time.series(measured(wanted, name));
    }
    let mut changes = Panel::new("Contacts and what they change", frame(), Axis::log("Number"));
    for (wanted, name) in [
        ("Contacts", "Contacts"),
        ("Edges that came or went", "Edges changed"),
        ("Vertices recolored", "Vertices recolored"),
    ] {
        changes = changes.series(measured(wanted, name));
    }
    let mut colors = Panel::new("Graph of vertices: colors", frame(), Axis::linear("Colors").min(0.0));
    colors = colors.series(measured("Colors of vertices", "Colors of vertices"));
    let mut coloring = Panel::new("Graph of vertices: coloring", frame(), Axis::log("Time").unit("ms"));
    for (wanted, name) in [
        ("Coloring that follows the contacts [ms]", "Coloring that follows"),
        ("Coloring all vertices anew [ms]", "Coloring anew"),
    ] {
        coloring = coloring.series(measured(wanted, name));
    }
    let mut depth =
        Panel::new("Nearer than the thickness", frame(), Axis::linear("Depth").unit("mm").min(0.0))
            .series(measured("Nearer than the thickness, at most [mm]", "Deepest contact"))
            .series(measured("… in the mean of all contacts [mm]", "Mean of contacts"))
            .series(measured("Inside of an obstacle, at most [mm]", "Inside of an obstacle"));
    if let Some(thickness) = played.thickness {
        depth = depth.guide_y(1e3 * f64::from(thickness), "thickness");
    }
    let stretch = Panel::new("Stretch of the edges", frame(), Axis::linear("Stretch").unit("%").min(0.0))
        .series(line("Mean stretch", &|f: &Frame| 100.0 * f.stretch[0]));
    Chart::new(&format!("{}, frame by frame", played.name), 2)
        .panel(time)
        .panel(changes)
        .panel(colors)
        .panel(coloring)
        .panel(depth)
        .panel(stretch)
}

fn none(_: &Frame) -> f64 {
    f64::NAN
}
