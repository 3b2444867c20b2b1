//! Figure 8: noodles that fall on the floor. The columns of its data: see [`super`].

use super::{Scenario, falling};
use crate::figures::{Context, FigureError};
use crate::report::Figure;

/// Makes the figure.
///
/// # Errors
/// What scenes, solvers and pictures run into.
pub fn make(context: &mut Context<'_>, command: &str) -> Result<Figure, FigureError> {
    let budget = "Noodles: \u{201c}solver time budget including collision handling: 15ms per frame\u{201d}";
    falling(context, Scenario::Noodles, ("fig8", "Figure 8: self-colliding noodles", budget), command)
}
