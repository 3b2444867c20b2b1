//! Draws a chart: panels in a grid under a shared legend.

#![expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "counts of ticks")]

use super::axis::{Label, Span, Tick};
use super::curve;
use super::font;
use super::plot::{Chart, Look, Mark, Panel, Series};
use super::svg::{FRAME, INK, MUTED, Svg, Text, escape, num};

const MARGIN: f64 = 18.0;
const TITLE: f64 = 18.0;
const HEADING: f64 = 14.5;
const LABEL: f64 = 14.0;
const TICK: f64 = 12.5;
const NOTE: f64 = 12.0;
const SAMPLE: f64 = 38.0;

/// A panel with its ends and its room known.
pub(super) struct Placed<'a> {
    pub(super) panel: &'a Panel,
    pub(super) x: Span,
    pub(super) y: Span,
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) width: f64,
    pub(super) height: f64,
    /// Room left of the axes \[px\], equal for all panels of a column.
    room: f64,
    names_x: bool,
}

impl Placed<'_> {
    pub(super) fn px(&self, value: f64) -> Option<f64> {
        self.x.place(value).map(|at| self.left + at.clamp(-5.0, 6.0) * self.width)
    }

    pub(super) fn py(&self, value: f64) -> Option<f64> {
        self.y.place(value).map(|at| self.top + (1.0 - at.clamp(-5.0, 6.0)) * self.height)
    }

    fn y_ticks(&self) -> Vec<Tick> {
        self.y.ticks((self.height / 34.0) as usize)
    }

    /// As many labels as fit side by side.
    fn x_ticks(&self) -> Vec<Tick> {
        let mut most = 9;
        loop {
            let ticks = self.x.ticks(most);
            let needed: f64 = ticks
                .iter()
                .filter_map(|tick| tick.label.as_ref())
                .map(|label| label_width(label) + 16.0)
                .sum();
            if needed <= self.width || most <= 2 {
                return ticks;
            }
            most -= 1;
        }
    }
}

impl Chart {
    /// The picture; `id` must be unique in a page that holds several.
    pub fn svg(&self, id: &str) -> Svg {
        let mut placed = self.fit();
        let columns = self.columns.min(placed.len()).max(1);
        let rows = placed.len().div_ceil(columns);
        let lefts: Vec<f64> = (0..columns)
            .map(|column| placed.iter().skip(column).step_by(columns).map(left_room).fold(0.0, f64::max))
            .collect();
        let gap = 26.0;
        let inner: f64 =
            lefts.iter().map(|left| left + self.area.0).sum::<f64>() + gap * (columns - 1) as f64;
        let title_width = font::width(&self.title, TITLE, true);
        let width = (inner + 2.0 * MARGIN + 8.0).max(title_width + 2.0 * MARGIN);

        let mut y = MARGIN;
        let title_at = (!self.title.is_empty()).then(|| {
            y += TITLE + 4.0;
            y - 4.0
        });
        let legend = self.legend();
        let entries = legend_rows(&legend, width - 2.0 * MARGIN);
        let legend_at = y + 22.0;
        y += if entries.is_empty() { 2.0 } else { 14.0 + 22.0 * entries.len() as f64 };

        for row in 0..rows {
            let first = row * columns;
            let last = (first + columns).min(placed.len());
            let has_heading = placed[first..last].iter().any(|p| !p.panel.title.is_empty());
            let has_names = placed[first..last].iter().any(|p| p.names_x);
            y += if has_heading { 30.0 } else { 14.0 };
            let mut x = MARGIN;
            for (column, panel) in placed[first..last].iter_mut().enumerate() {
                x += lefts[column];
                (panel.left, panel.top, panel.room) = (x, y, lefts[column]);
                x += self.area.0 + gap;
            }
            y += self.area.1 + if has_names { 46.0 } else { 26.0 };
        }
        let notes: Vec<String> =
            self.all_notes().iter().flat_map(|note| font::wrap(note, NOTE, width - 2.0 * MARGIN)).collect();
        let notes_at = y + 16.0;
        if !notes.is_empty() {
            y += 8.0 + 17.0 * notes.len() as f64;
        }

        let mut svg = Svg::new(width.ceil(), (y + 10.0).ceil(), &self.title);
        if let Some(at) = title_at {
            svg.text(Text::at(MARGIN, at, TITLE).bold(), &self.title);
        }
        for (row, entries) in entries.iter().enumerate() {
            for (x, series, look) in entries {
                legend_entry(&mut svg, MARGIN + x, legend_at + 22.0 * row as f64, series, *look);
            }
        }
        for (idx, panel) in placed.iter().enumerate() {
            draw_axes(&mut svg, panel);
            curve::draw(&mut svg, panel, &legend, &format!("clip-{id}-{idx}"));
            curve::guide_labels(&mut svg, panel);
        }
        for (idx, note) in notes.iter().enumerate() {
            svg.text(Text::at(MARGIN, notes_at + 17.0 * idx as f64, NOTE).fill(MUTED), note);
        }
        svg
    }

    fn fit(&self) -> Vec<Placed<'_>> {
        let below = |idx: usize| self.panels.get(idx + self.columns);
        let placed = self.panels.iter().enumerate().map(|(idx, panel)| {
            let points = || panel.series.iter().flat_map(|series| &series.points);
            let guides =
                |upright: bool| panel.guides.iter().filter(move |g| g.upright == upright).map(|g| g.at);
            let heights = points().flat_map(|p| [p.mid, p.lo, p.hi]);
            Placed {
                panel,
                x: Span::fit(&panel.x, points().map(|p| p.x).chain(guides(true))),
                y: Span::fit(&panel.y, heights.chain(guides(false))),
                left: 0.0,
                top: 0.0,
                width: self.area.0,
                height: self.area.1,
                room: 0.0,
                names_x: below(idx).is_none_or(|next| next.x.title() != panel.x.title()),
            }
        });
        placed.collect()
    }
}

fn left_room(placed: &Placed<'_>) -> f64 {
    let ticks = placed.y_ticks();
    let widest = ticks.iter().filter_map(|tick| tick.label.as_ref()).map(label_width).fold(0.0, f64::max);
    widest + 10.0 + LABEL + 10.0
}

fn label_width(label: &Label) -> f64 {
    match label {
        Label::Text(text) => font::width(text, TICK, false),
        Label::Power(digit, exp) => {
            let base = if *digit == 1 { "10".to_owned() } else { format!("{digit}\u{b7}10") };
            font::width(&base, TICK, false) + font::width(&signed(*exp), 0.74 * TICK, false)
        }
    }
}

fn signed(exp: i32) -> String {
    if exp < 0 { format!("\u{2212}{}", -exp) } else { exp.to_string() }
}

fn draw_label(svg: &mut Svg, at: Text, label: &Label) {
    match label {
        Label::Text(text) => svg.text(at, text),
        Label::Power(digit, exp) => {
            let base = if *digit == 1 { String::new() } else { format!("{digit}\u{b7}") };
            let (rise, size) = (num(-0.4 * TICK), num(0.74 * TICK));
            let exponent = signed(*exp);
            let content = format!("{base}10<tspan dy=\"{rise}\" font-size=\"{size}\">{exponent}</tspan>");
            svg.rich_text(at, &content);
        }
    }
}

fn draw_axes(svg: &mut Svg, placed: &Placed<'_>) {
    let (left, top) = (placed.left, placed.top);
    let (right, bottom) = (left + placed.width, top + placed.height);
    let (x_ticks, y_ticks) = (placed.x_ticks(), placed.y_ticks());
    let grid = |tick: &Tick| {
        if tick.label.is_some() {
            "stroke=\"#d8dee4\" stroke-width=\"1\""
        } else {
            "stroke=\"#eef1f4\" stroke-width=\"0.7\""
        }
    };
    let reach = |tick: &Tick| if tick.label.is_some() { 5.0 } else { 3.0 };
    let tick_style = format!("stroke=\"{FRAME}\" stroke-width=\"1\"");
    for major in [false, true] {
        for tick in x_ticks.iter().filter(|tick| tick.label.is_some() == major) {
            let Some(x) = placed.px(tick.value) else { continue };
            svg.line((x, top), (x, bottom), grid(tick));
            svg.line((x, bottom), (x, bottom + reach(tick)), &tick_style);
            if let Some(label) = &tick.label {
                draw_label(svg, Text::at(x, bottom + 19.0, TICK).middle(), label);
            }
        }
        for tick in y_ticks.iter().filter(|tick| tick.label.is_some() == major) {
            let Some(y) = placed.py(tick.value) else { continue };
            svg.line((left, y), (right, y), grid(tick));
            svg.line((left - reach(tick), y), (left, y), &tick_style);
            if let Some(label) = &tick.label {
                draw_label(svg, Text::at(left - 8.0, y + 4.4, TICK).end(), label);
            }
        }
    }
    let frame = format!("fill=\"none\" stroke=\"{FRAME}\" stroke-width=\"1\"");
    svg.rect(left, top, placed.width, placed.height, &frame);
    if !placed.panel.title.is_empty() {
        svg.text(Text::at(left, top - 9.0, HEADING).bold(), &placed.panel.title);
    }
    if placed.names_x {
        svg.text(Text::at(left + placed.width / 2.0, bottom + 39.0, LABEL).middle(), &placed.panel.x.title());
    }
    let name_x = left - placed.room + LABEL;
    svg.text(Text::at(name_x, top + placed.height / 2.0, LABEL).middle().upwards(), &placed.panel.y.title());
}

/// Entries of the legend with their places, broken into rows.
fn legend_rows<'a>(legend: &[(&'a Series, Look)], limit: f64) -> Vec<Vec<(f64, &'a Series, Look)>> {
    let mut rows: Vec<Vec<(f64, &Series, Look)>> = Vec::new();
    let mut x = f64::INFINITY;
    for (series, look) in legend {
        let wide = SAMPLE + 8.0 + font::width(&series.name, LABEL, false);
        if x + wide > limit {
            rows.push(Vec::new());
            x = 0.0;
        }
        if let Some(row) = rows.last_mut() {
            row.push((x, *series, *look));
        }
        x += wide + 24.0;
    }
    rows
}

fn legend_entry(svg: &mut Svg, x: f64, y: f64, series: &Series, look: Look) {
    let middle = y - 5.0;
    if series.mark == Mark::Line && series.has_spread() {
        let style = format!("fill=\"{}\" fill-opacity=\"0.18\"", look.stroke());
        svg.rect(x, middle - 7.0, SAMPLE, 14.0, &style);
    }
    if series.mark != Mark::Dots {
        svg.path(&[(x, middle), (x + SAMPLE, middle)], false, &look.curve(2.0));
    }
    look.draw(svg, x + SAMPLE / 2.0, middle, 4.4);
    svg.rich_text(Text::at(x + SAMPLE + 8.0, y, LABEL).fill(INK), &escape(&series.name));
}
