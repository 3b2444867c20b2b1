//! Figure 4: relative error over the tablecloth animation. The columns of its data: see [`super`].

use super::{Comparison, Subject, scenes};
use crate::figures::{Context, FigureError};
use crate::report::Figure;

const SUBJECT: Subject<'_> =
    Subject { id: "fig4", title: "Figure 4: error in the tablecloth animation", times: &[4.0, 8.0] };

/// Makes the figure.
///
/// # Errors
/// What scenes and solvers run into.
pub fn make(context: &mut Context<'_>, command: &str) -> Result<Figure, FigureError> {
    let comparison = Comparison::measure(context, &SUBJECT, |context| {
        scenes::tablecloth(context.sizes.simulation.vertices)
    })?;
    let mut figure = comparison.figure(context, &SUBJECT, command);
    figure.seconds = Some(context.progress.done());
    Ok(figure)
}
