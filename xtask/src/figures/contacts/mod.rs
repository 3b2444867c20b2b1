//! Figures 1, 8 and 9: scenes whose bodies collide, frame by frame.
//!
//! The columns of the data (`figN` stands for each), a row for each frame: `scene`, `frame`, `time_ms` (the whole frame), and of it
//! `detect_ms` (finding contacts), `color_ms` (contacts made constraints, colored), `solve_ms`, `guard_ms` (holding back what
//! would pass); `contacts` (of the last small step); of the graph of vertices with these, beside the frame: `changed_edges`, `recolored` (vertices), `vertex_colors`,
//! `recolor_ms` (the coloring follows), `color_anew_ms` (it is made anew); `colors` (of the solver), `iterations`, `held_back`
//! (particles, by the guard);
//! `deepest_mm` and `mean_depth_mm` (how much nearer than the thickness the contacts are at the end of the frame), `crossings` (pairs
//! of an edge and a triangle that cross at the end of the frame, by exact signs), `inside_mm` (how deep a particle is inside of an
//! obstacle's own surface, at most), `mean_stretch` and `greatest_stretch` (of the edges, against their length at rest).

mod charts;
mod claims;
pub mod fig1;
pub mod fig8;
pub mod fig9;
pub mod played;
mod recoloring;

use std::rc::Rc;

use super::{Context, FigureError};
use crate::report::Figure;
use played::{Played, Script};

/// How large the scenes are, and how long they play.
#[derive(Debug, Clone, PartialEq)]
pub struct Sizes {
    /// Vertices across a noodle; the paper's 8.
    pub noodles: usize,
    /// Vertices along the shorter side of a cloth of the heap; the paper's 78.
    pub heap: usize,
    /// Vertices of the armadillo; the paper's 10,000.
    pub armadillo: usize,
    /// Frames of an animation.
    pub n_frames: u32,
    /// Width of a still \[px\].
    pub still: u32,
}

impl Sizes {
    /// Half a minute for all three figures.
    pub fn quick() -> Self {
        Self { noodles: 2, heap: 10, armadillo: 1000, n_frames: 40, still: 360 }
    }

    /// The paper's sizes.
    pub fn normal() -> Self {
        Self { noodles: 8, heap: 78, armadillo: 10_000, n_frames: 60, still: 480 }
    }

    /// The paper's sizes, longer.
    pub fn full() -> Self {
        Self { n_frames: 120, ..Self::normal() }
    }
}

/// A scene of these figures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scenario {
    /// Noodles that fall on the floor.
    Noodles,
    /// Cloths that fall on an armchair; one is pinched and dragged.
    Heap,
    /// The armadillo that hangs by one hand, without collisions.
    Armadillo,
}

impl Scenario {
    fn script(self, sizes: &Sizes) -> Script {
        match self {
            Self::Noodles => Script::noodles(sizes.noodles),
            Self::Heap => Script::heap(sizes.heap),
            Self::Armadillo => Script::armadillo(sizes.armadillo),
        }
    }
}

/// Plays a scenario, once for all figures of a run.
fn played(context: &mut Context<'_>, scenario: Scenario) -> Result<Rc<Played>, FigureError> {
    if let Some((_, played)) = context.played.iter().find(|(known, _)| *known == scenario) {
        return Ok(Rc::clone(played));
    }
    let sizes = context.sizes.contacts.clone();
    let (pool, progress) = (context.pool, &mut *context.progress);
    let script = scenario.script(&sizes);
    let played = Rc::new(pool.install(|| Played::play(script, sizes.n_frames, progress))?);
    context.played.push((scenario, Rc::clone(&played)));
    Ok(played)
}

/// A figure of one scene: stills, an animation, charts; `about` is its id, its title, and what the paper says a frame may cost.
fn falling(
    context: &mut Context<'_>,
    scenario: Scenario,
    about: (&str, &str, &str),
    command: &str,
) -> Result<Figure, FigureError> {
    let (id, title, budget) = about;
    context.progress.figure(id, 5);
    let played = played(context, scenario)?;
    context.progress.step("pictures");
    let caption = format!(
        "{}: {}; h = {:.1} ms. {}, {} iterations a frame: a fixed number, not a time budget. Times are of {}: the solver alone, and the whole frame with collisions. Bodies keep {:.1} mm apart. Contacts are colored as constraints in every small step; the graph of vertices with the last of them as edges, which is what the paper recolors, is colored beside that.",
        played.name,
        played.contents,
        1e3 * played.time_step,
        played.solver,
        played.iterations,
        context.machine,
        1e3 * played.thickness.unwrap_or_default()
    );
    let still = context.sizes.contacts.still;
    let figure = Figure::new(id, title, command, &caption).grid(charts::stills(&played, still)?);
    let figure_name = title.split(':').next().unwrap_or(title);
    let mut figure = charts::with_animation(figure, &played, still)?
        .chart(charts::over_time(&played))
        .table(played.summary())
        .data(played.data())
        .option("frames", played.frames.len());
    figure.claims.push(claims::budget(&played, figure_name, budget));
    figure.claims.extend(claims::recoloring(&played, figure_name));
    figure.claims.push(claims::artifacts(&played, figure_name));
    figure.seconds = Some(context.progress.done());
    Ok(figure)
}
