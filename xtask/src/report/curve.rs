//! Draws what is inside the axes of a panel: bands, curves, markers, lines of reference.

use super::draw::Placed;
use super::plot::{Look, Mark, Point, Series};
use super::svg::{INK, MUTED, Svg, Text};

/// Markers on a curve before some are left out, so that a long series stays a line.
const MOST_MARKERS: usize = 16;
const RADIUS: f64 = 4.2;

/// A point in pixels, with its ends.
struct Dot {
    x: f64,
    lo: f64,
    mid: f64,
    hi: f64,
    inside: bool,
}

pub(super) fn draw(svg: &mut Svg, placed: &Placed<'_>, legend: &[(&Series, Look)], clip: &str) {
    let (left, top, width, height) = (placed.left, placed.top, placed.width, placed.height);
    svg.raw(&format!("<clipPath id=\"{clip}\">"));
    svg.rect(left, top, width, height, "");
    svg.raw("</clipPath>");
    guides(svg, placed);

    let look =
        |series: &Series| legend.iter().find(|(known, _)| known.name == series.name).map(|(_, look)| *look);
    let curves: Vec<(&Series, Look, Vec<Dot>)> = placed
        .panel
        .series
        .iter()
        .map(|series| (series, look(series).unwrap_or(Look::nth(0)), dots(placed, series)))
        .collect();
    svg.raw(&format!("<g clip-path=\"url(#{clip})\">"));
    for (series, look, dots) in &curves {
        for run in runs(placed, series, dots) {
            if series.mark == Mark::Line && run.len() > 1 {
                band(svg, run, *look);
            } else {
                bars(svg, run, *look);
            }
        }
    }
    for (series, look, dots) in &curves {
        for run in runs(placed, series, dots).filter(|run| series.mark != Mark::Dots && run.len() > 1) {
            let line: Vec<_> = run.iter().map(|dot| (dot.x, dot.mid)).collect();
            svg.path(&line, false, &look.curve(2.0));
        }
    }
    svg.raw("</g>");
    for (idx, (series, look, dots)) in curves.iter().enumerate() {
        let stride = if series.mark == Mark::Dots { 1 } else { dots.len().div_ceil(MOST_MARKERS).max(1) };
        let start = if stride > 1 { (idx * stride) / curves.len() } else { 0 };
        for dot in dots.iter().skip(start).step_by(stride).filter(|dot| dot.inside) {
            look.draw(svg, dot.x, dot.mid, RADIUS);
        }
        if let Some(x) = series.not_finite.and_then(|(_, x)| placed.px(x)) {
            cross(svg, x.clamp(left, left + width), top + 8.0, *look);
        }
    }
    if curves.iter().all(|(_, _, dots)| dots.is_empty()) {
        let at = Text::at(left + width / 2.0, top + height / 2.0, 13.0).middle().fill(MUTED).halo();
        svg.text(at, "no data");
    }
}

/// Points with a place on both axes, from left to right; ends without one shrink to the edge of the panel.
fn dots(placed: &Placed<'_>, series: &Series) -> Vec<Dot> {
    let mut points: Vec<&Point> = series.points.iter().collect();
    points.sort_by(|a, b| a.x.total_cmp(&b.x));
    let dot = |point: &Point| {
        let (x, mid) = (placed.px(point.x)?, placed.py(point.mid)?);
        let lo = placed.py(point.lo).unwrap_or(placed.top + placed.height);
        let hi = placed.py(point.hi).unwrap_or(mid);
        Some(Dot { x, lo, mid, hi, inside: placed.x.holds(point.x) && placed.y.holds(point.mid) })
    };
    points.into_iter().filter_map(dot).collect()
}

/// The dots between places without a value: a curve must not bridge what is not known.
fn runs<'a>(placed: &Placed<'_>, series: &Series, dots: &'a [Dot]) -> impl Iterator<Item = &'a [Dot]> {
    let mut gaps: Vec<f64> = series.gaps.iter().filter_map(|x| placed.px(*x)).collect();
    gaps.sort_by(f64::total_cmp);
    let before = move |dot: &Dot| gaps.partition_point(|gap| *gap < dot.x);
    dots.chunk_by(move |a, b| before(a) == before(b))
}

fn band(svg: &mut Svg, dots: &[Dot], look: Look) {
    if dots.iter().all(|dot| dot.lo - dot.hi < 0.3) {
        return;
    }
    let upper = dots.iter().map(|dot| (dot.x, dot.hi));
    let lower = dots.iter().rev().map(|dot| (dot.x, dot.lo));
    let ring: Vec<_> = upper.chain(lower).collect();
    svg.path(&ring, true, &format!("fill=\"{}\" fill-opacity=\"0.18\" stroke=\"none\"", look.stroke()));
}

fn bars(svg: &mut Svg, dots: &[Dot], look: Look) {
    let style = format!("stroke=\"{}\" stroke-width=\"1.3\"", look.stroke());
    for dot in dots.iter().filter(|dot| dot.lo - dot.hi > 0.3) {
        svg.line((dot.x, dot.lo), (dot.x, dot.hi), &style);
        for y in [dot.lo, dot.hi] {
            svg.line((dot.x - 3.5, y), (dot.x + 3.5, y), &style);
        }
    }
}

fn cross(svg: &mut Svg, x: f64, y: f64, look: Look) {
    let style = format!("stroke=\"{}\" stroke-width=\"2.2\" stroke-linecap=\"round\"", look.stroke());
    svg.line((x - 4.0, y - 4.0), (x + 4.0, y + 4.0), &style);
    svg.line((x - 4.0, y + 4.0), (x + 4.0, y - 4.0), &style);
}

/// Lines of reference, under the curves.
fn guides(svg: &mut Svg, placed: &Placed<'_>) {
    let (right, bottom) = (placed.left + placed.width, placed.top + placed.height);
    let style =
        format!("stroke=\"{INK}\" stroke-width=\"1.1\" stroke-dasharray=\"5 3\" stroke-opacity=\"0.7\"");
    for guide in &placed.panel.guides {
        if guide.upright && placed.x.holds(guide.at) {
            let Some(x) = placed.px(guide.at) else { continue };
            svg.line((x, placed.top), (x, bottom), &style);
        } else if !guide.upright && placed.y.holds(guide.at) {
            let Some(y) = placed.py(guide.at) else { continue };
            svg.line((placed.left, y), (right, y), &style);
        }
    }
}

/// What the lines of reference say, over everything else.
pub(super) fn guide_labels(svg: &mut Svg, placed: &Placed<'_>) {
    let (left, top, right) = (placed.left, placed.top, placed.left + placed.width);
    for guide in &placed.panel.guides {
        let label = Text::at(0.0, 0.0, 12.0).fill(MUTED).halo();
        if guide.upright && placed.x.holds(guide.at) {
            let Some(x) = placed.px(guide.at) else { continue };
            // The text stays on the roomier side of its line.
            if x < (left + right) / 2.0 {
                svg.text(Text { x: x + 5.0, y: top + 15.0, ..label }, &guide.label);
            } else {
                svg.text(Text { x: x - 5.0, y: top + 15.0, ..label }.end(), &guide.label);
            }
        } else if !guide.upright && placed.y.holds(guide.at) {
            let Some(y) = placed.py(guide.at) else { continue };
            let above = if y - top > 22.0 { y - 5.0 } else { y + 15.0 };
            svg.text(Text { x: right - 6.0, y: above, ..label }.end(), &guide.label);
        }
    }
}
