//! The paper's claims about scenes that collide, judged from what was played. Each states its threshold.

use super::played::{Frame, Played};
use crate::report::{Claim, Verdict, quantile};

const RECOLORING: &str = "\u{201c}The topology of the graph changes due to collisions, so recoloring is necessary and Vivace handles this very well\u{201d}";
const EACH_FRAME: &str =
    "\u{201c}The coloring algorithm is fast enough to be rerun as needed, even for each frame\u{201d}";
const ARTIFACTS: &str =
    "Hundreds of thousands of constraints \u{201c}without noticeable visual artifacts\u{201d}";

fn verdict(held: bool) -> Verdict {
    if held { Verdict::Held } else { Verdict::NotHeld }
}

/// The claim about what a frame may cost on the paper's machine, which is none of ours.
pub(super) fn budget(played: &Played, figure: &str, paper: &str) -> Claim {
    let time = |of: fn(&Frame) -> f64| {
        let all = played.sorted(of);
        format!("{:.0} ms (99%: {:.0})", quantile(&all, 0.5), quantile(&all, 0.99))
    };
    Claim::new(
        paper,
        &format!(
            "{figure}, {}: the paper\u{2019}s machine is a GPU. On this CPU, {} constraints, {} iterations: the solver alone {}, with collisions {} a frame in the median.",
            played.name,
            played.n_constraints,
            played.iterations,
            time(|f| 1e3 * f.report.times.solve),
            time(|f| 1e3 * f.seconds)
        ),
        Verdict::NotTestable,
    )
}

/// Recoloring as contacts change.
pub(super) fn recoloring(played: &Played, figure: &str) -> Vec<Claim> {
    let (name, n) = (&played.name, played.frames.len());
    let changed = played.frames.iter().filter(|f| f.change.edges > 0).count();
    let colors = |range: std::ops::Range<usize>| {
        played.frames[range].iter().map(|f| f.change.colors).max().unwrap_or(0)
    };
    let (first, last) = (colors(0..n / 2), colors(n / 2..n));
    let share = quantile(&played.sorted(|f| f.change.seconds / f.seconds), 0.95);
    vec![
        Claim::new(
            RECOLORING,
            &format!(
                "{figure}, {name}: edges come or go in {changed} of {n} frames, {:.0} in the median and {:.0} at most; {:.0} and {:.0} vertices get another color, and the coloring was checked in each frame. Colors of the vertices: at most {first} in the first half, {last} in the second (handled well: always proper, and at most 2 colors more in the second half).",
                played.median(|f| f.change.edges as f64),
                played.most(|f| f.change.edges as f64),
                played.median(|f| f.change.vertices as f64),
                played.most(|f| f.change.vertices as f64)
            ),
            verdict(last <= first + 2),
        ),
        Claim::new(
            EACH_FRAME,
            &format!(
                "{figure}, {name}, this CPU: the coloring of the vertices follows the contacts in {:.2} ms in the median; made anew it takes {:.2} ms. In 95% of the frames it takes {:.2}% of the frame or less (fast enough: at most 10%).",
                played.median(|f| 1e3 * f.change.seconds),
                played.median(|f| 1e3 * f.change.seconds_anew),
                100.0 * share
            ),
            verdict(share <= 0.1),
        ),
    ]
}

/// Whether anything can be seen to be wrong.
pub(super) fn artifacts(played: &Played, figure: &str) -> Claim {
    let crossing = played.frames.iter().filter(|f| f.crossings > 0).count();
    let inside = 1e3 * played.most(|f| f.inside);
    let stretch = 100.0 * played.median(|f| f.stretch[0]);
    let thickness = 1e3 * played.thickness.map_or(0.0, f64::from);
    Claim::new(
        ARTIFACTS,
        &format!(
            "{figure}, {}: pairs cross at the end of {crossing} of {} frames, by exact signs; a particle is at most {inside:.2} mm inside of an obstacle\u{2019}s own surface (thickness: {thickness:.1} mm); edges are stretched by {stretch:.1}% in the mean of the median frame (not noticeable: no crossing, nothing inside by more than half the thickness, at most 10%).",
            played.name,
            played.frames.len()
        ),
        verdict(crossing == 0 && inside <= 0.5 * thickness && stretch <= 10.0),
    )
}
