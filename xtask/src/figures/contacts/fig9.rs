//! Figure 9: cloths that fall on an armchair, of which one is pinched and dragged. The columns of its data: see [`super`].

use super::{Scenario, falling};
use crate::figures::{Context, FigureError};
use crate::report::Figure;

/// Makes the figure.
///
/// # Errors
/// What scenes, solvers and pictures run into.
pub fn make(context: &mut Context<'_>, command: &str) -> Result<Figure, FigureError> {
    let budget = "Cloths: \u{201c}solver time budget including collision handling: 15ms per frame\u{201d}";
    falling(
        context,
        Scenario::Heap,
        ("fig9", "Figure 9: pinching and dragging a cloth on a heap", budget),
        command,
    )
}
