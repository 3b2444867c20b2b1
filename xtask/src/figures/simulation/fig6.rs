//! Figure 6: stills of the tablecloth, a row for each method. The columns of its data: see `stills.rs`.

use glam::Vec3;

use super::stills::{self, Row, Subject};
use super::{methods, scenes};
use crate::figures::{Context, FigureError};
use crate::report::{Claim, Figure, Verdict};

const SUBJECT: Subject<'_> = Subject {
    id: "fig6",
    title: "Figure 6: stills of the tablecloth",
    ms: 8.0,
    methods: &[methods::PAPER, methods::SHIPPED, methods::WANG, methods::JACOBI],
    direction: Vec3::new(-0.7, -0.35, -1.0),
    most_strain: 0.5,
};

/// Makes the figure.
///
/// # Errors
/// What scenes, solvers and pictures run into.
pub fn make(context: &mut Context<'_>, command: &str) -> Result<Figure, FigureError> {
    context.progress.figure(SUBJECT.id, stills::n_steps(&SUBJECT));
    let scene = scenes::tablecloth(context.sizes.simulation.vertices)?;
    let (mut figure, rows) = stills::make(context, &SUBJECT, &scene, command)?;
    let claim = anchors(&rows);
    figure.caption = format!(
        "In short. {}\n\nStills from the animation of figure 4, and at equal work. {} The lowest row is converged: Direct, 200 iterations a frame. Time: of the solver in that frame, {}.",
        claim.found, scene.caption, context.machine
    );
    figure.claims.push(claim);
    figure.seconds = Some(context.progress.done());
    Ok(figure)
}

/// The paper's own limitation: the cloth gives near what holds it.
fn anchors(rows: &[Row]) -> Claim {
    let last = |row: &Row| row.anchors.last().copied().unwrap_or(f32::NAN);
    let truth = rows.last().map_or(f32::NAN, last);
    let paper: Vec<&Row> = rows.iter().filter(|row| row.name == methods::PAPER).collect();
    let strain = |row: &Row| format!("{} at {}: {:.0}%", row.name, row.run.limit.name(), 100.0 * last(row));
    let others = rows.iter().filter(|row| row.name != "Converged").map(strain);
    let found = format!(
        "Figure 6, mean strain of the edges within a tenth of the scene of an anchor, in the last still: {}; converged {:.0}% (excessive: at least 1.5 times the converged). Blown up before: not counted.",
        others.collect::<Vec<_>>().join("; "),
        100.0 * truth
    );
    let left: Vec<f32> = paper.iter().filter(|row| row.run.blown_up.is_none()).map(|row| last(row)).collect();
    let verdict = match left.iter().all(|strain| *strain >= 1.5 * truth) {
        _ if left.is_empty() || truth.is_nan() => Verdict::NotTestable,
        true => Verdict::Held,
        false => Verdict::NotHeld,
    };
    Claim::new(
        "\u{201c}In Fig. 6 the cloth flexes excessively near the anchor points due to the theoretical limits of the convergence speed of relaxation methods\u{201d}",
        &found,
        verdict,
    )
}
