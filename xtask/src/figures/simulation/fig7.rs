//! Figure 7: stills of the armadillo, a row for each method. The columns of its data: see `stills.rs`.

use glam::Vec3;

use super::stills::{self, Row, Subject};
use super::{methods, scenes};
use crate::figures::{Context, FigureError};
use crate::report::{Figure, Value};

const SUBJECT: Subject<'_> = Subject {
    id: "fig7",
    title: "Figure 7: stills of the armadillo",
    ms: 15.0,
    methods: &[methods::PAPER, methods::SHIPPED, methods::WANG],
    direction: Vec3::new(-1.0, -0.25, 0.45),
    most_strain: 0.5,
};

/// Makes the figure.
///
/// # Errors
/// What scenes, solvers and pictures run into.
pub fn make(context: &mut Context<'_>, command: &str) -> Result<Figure, FigureError> {
    context.progress.figure(SUBJECT.id, stills::n_steps(&SUBJECT));
    let scene = scenes::armadillo(context.families, context.sizes.simulation.vertices)?;
    let (mut figure, rows) = stills::make(context, &SUBJECT, &scene, command)?;
    let fate = |row: &Row| {
        let error = row.run.blown_up.map_or_else(
            || format!("median error {}", Value::Real(row.run.median()).shown()),
            |frame| format!("blown up at frame {frame}"),
        );
        format!("{} at {}: {error}", row.name, row.run.limit.name())
    };
    let fates: Vec<String> = rows.iter().filter(|row| row.name != "Converged").map(fate).collect();
    figure.caption = format!(
        "In short. {}.\n\nStills from the animation of figure 5, and at equal work. {} The lowest row is converged: Direct, 200 iterations a frame. Time: of the solver in that frame, {}.",
        fates.join("; "),
        scene.caption,
        context.machine
    );
    figure.seconds = Some(context.progress.done());
    Ok(figure)
}
