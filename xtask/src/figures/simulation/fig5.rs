//! Figure 5: relative error over the armadillo animation. The columns of its data: see [`super`].

use super::{Comparison, Subject, scenes};
use crate::figures::{Context, FigureError};
use crate::report::Figure;

const SUBJECT: Subject<'_> = Subject {
    id: "fig5",
    title: "Figure 5: error in the armadillo animation",
    times: &[4.0, 8.0, 15.0, 25.0],
};

/// Makes the figure.
///
/// # Errors
/// What scenes and solvers run into.
pub fn make(context: &mut Context<'_>, command: &str) -> Result<Figure, FigureError> {
    let comparison = Comparison::measure(context, &SUBJECT, |context| {
        scenes::armadillo(context.families, context.sizes.simulation.vertices)
    })?;
    let mut figure = comparison.figure(context, &SUBJECT, command);
    figure.seconds = Some(context.progress.done());
    Ok(figure)
}
