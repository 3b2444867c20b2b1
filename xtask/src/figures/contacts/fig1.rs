//! Figure 1: three scenes, and what the solver alone takes. The columns of its data: see [`super`].

use super::played::{Frame, Played};
use super::{Scenario, claims, played};
use crate::figures::{Context, FigureError};
use crate::report::{Cell, Figure, PictureGrid, Table};

/// Scenes, and what the paper says of each.
const SCENES: [(Scenario, &str); 3] = [
    (
        Scenario::Heap,
        "\u{201c}Self-colliding cloths (108K triangles, 324K constraints), 5 ms per frame\u{201d}",
    ),
    (
        Scenario::Noodles,
        "\u{201c}Self-colliding noodles (52K triangles, 156K constraints), 4 ms per frame\u{201d}",
    ),
    (
        Scenario::Armadillo,
        "\u{201c}Volumetric Armadillo hanging by one hand (55K tetrahedrons, 55K constraints), 15 ms per frame\u{201d}",
    ),
];

/// Makes the figure.
///
/// # Errors
/// What scenes, solvers and pictures run into.
pub fn make(context: &mut Context<'_>, command: &str) -> Result<Figure, FigureError> {
    context.progress.figure("fig1", 4 * SCENES.len() as u64 + 1);
    let (mut cells, mut about) = (Vec::new(), Vec::new());
    let mut figure = Figure::new("fig1", "Figure 1: three scenes", command, "");
    let mut data: Option<Table> = None;
    for (scenario, paper) in SCENES {
        let played = played(context, scenario)?;
        let last = [played.frames.len()];
        for image in played.pictures(&last, context.sizes.contacts.still) {
            cells.push(Cell::new(image.png()?, &lines(&played)));
        }
        about.push(format!("{}: {}; h = {:.1} ms.", played.name, played.contents, 1e3 * played.time_step));
        figure.claims.push(claims::budget(&played, "Figure 1", paper));
        let rows = played.data();
        match &mut data {
            Some(data) => data.rows.extend(rows.rows),
            None => data = Some(rows),
        }
    }
    context.progress.step("pictures");
    figure.caption = format!(
        "The last frame of each scene. The paper\u{2019}s times are those of the solver alone (see the captions of figures 8 and 9 for its times with collisions); here both are given, as medians over the animation, on {}, with a fixed number of iterations a frame instead of a time budget. {} The paper gives neither stiffness nor mass nor shapes; these are ours.",
        context.machine,
        about.join(" ")
    );
    figure = figure.grid(
        PictureGrid::new("", &["Cloths", "Noodles", "Armadillo"]).cell_width(300.0).row(("", ""), cells),
    );
    figure.data.extend(data);
    figure.seconds = Some(context.progress.done());
    Ok(figure)
}

fn lines(played: &Played) -> [String; 3] {
    let ms = |of: fn(&Frame) -> f64| played.median(of);
    [
        format!("{} triangles, {} constraints", played.n_triangles, played.n_constraints),
        format!(
            "solver alone {:.0} ms ({} iterations)",
            ms(|f| 1e3 * f.report.times.solve),
            played.iterations
        ),
        format!("the whole frame {:.0} ms", ms(|f| 1e3 * f.seconds)),
    ]
}
