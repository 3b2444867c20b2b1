//! Line and scatter charts as plain data: what is shown, not how it is drawn.

use super::axis::{Axis, Scale};

/// A value with its spread at one place of the x axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Place on the x axis.
    pub x: f64,
    /// Lower end of the spread.
    pub lo: f64,
    /// The value itself, for samples their median.
    pub mid: f64,
    /// Upper end of the spread.
    pub hi: f64,
}

/// How a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// A line with markers; the spread is a shaded band.
    Line,
    /// A line with markers; the spread is a bar at each point.
    LineWithBars,
    /// Markers only; the spread is a bar at each point.
    Dots,
}

/// Color, marker and dash of a series, as indices into lists that wrap around.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Look {
    /// Index of the color.
    pub color: usize,
    /// Index of the marker.
    pub marker: usize,
    /// Index of the dash pattern; 0 is a full line.
    pub dash: usize,
}

impl Look {
    /// The `idx`-th look: color, marker and dash all differ from those of its neighbors.
    pub fn nth(idx: usize) -> Self {
        Self { color: idx, marker: idx, dash: idx }
    }
}

/// One curve or cloud of points.
#[derive(Clone, Debug)]
pub struct Series {
    /// Name in the legend; series of one name share a look and an entry.
    pub name: String,
    /// How it is drawn.
    pub mark: Mark,
    /// Fixed look; by default that of the name's place in the legend.
    pub look: Option<Look>,
    /// The points, in any order.
    pub points: Vec<Point>,
    /// Quantiles that `samples` takes as the ends of the spread.
    pub quantiles: (f64, f64),
    /// Fewest and most samples behind a point.
    pub(super) n_samples: Option<(usize, usize)>,
    /// Values that were not finite, and where the first was.
    pub(super) not_finite: Option<(usize, f64)>,
    /// Places without a value, where a curve breaks off.
    pub(super) gaps: Vec<f64>,
}

impl Series {
    /// An empty line.
    pub fn new(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            mark: Mark::Line,
            look: None,
            points: Vec::new(),
            quantiles: (0.25, 0.75),
            n_samples: None,
            not_finite: None,
            gaps: Vec::new(),
        }
    }

    /// A line through `points`.
    pub fn line(name: &str, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        points.into_iter().fold(Self::new(name), |series, (x, y)| series.point(x, y))
    }

    /// Drawn as `mark`.
    #[must_use]
    pub fn mark(mut self, mark: Mark) -> Self {
        self.mark = mark;
        self
    }

    /// Drawn with a fixed look.
    #[must_use]
    pub fn look(mut self, look: Look) -> Self {
        self.look = Some(look);
        self
    }

    /// With other quantiles as the spread of the samples that follow.
    #[must_use]
    pub fn quantiles(mut self, lo: f64, hi: f64) -> Self {
        self.quantiles = (lo, hi);
        self
    }

    /// Adds a value without spread.
    #[must_use]
    pub fn point(self, x: f64, y: f64) -> Self {
        self.range(x, y, y, y)
    }

    /// Adds a value with its spread; ends that are not finite shrink to the value.
    #[must_use]
    pub fn range(mut self, x: f64, lo: f64, mid: f64, hi: f64) -> Self {
        if !x.is_finite() || !mid.is_finite() {
            self.drop_value(x);
            self.gaps.push(x);
            return self;
        }
        let end = |v: f64| if v.is_finite() { v } else { mid };
        self.points.push(Point { x, lo: end(lo).min(mid), mid, hi: end(hi).max(mid) });
        self
    }

    /// Adds the median of `values` with their spread; values that are not finite are left out and noted.
    #[must_use]
    pub fn samples(mut self, x: f64, values: &[f64]) -> Self {
        let mut sorted: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
        for _ in sorted.len()..values.len() {
            self.drop_value(x);
        }
        if sorted.is_empty() {
            self.gaps.push(x);
            return self;
        }
        sorted.sort_by(f64::total_cmp);
        let (few, many) = self.n_samples.unwrap_or((sorted.len(), sorted.len()));
        self.n_samples = Some((few.min(sorted.len()), many.max(sorted.len())));
        let (lo, hi) = self.quantiles;
        let (lo, mid, hi) = (quantile(&sorted, lo), quantile(&sorted, 0.5), quantile(&sorted, hi));
        self.range(x, lo, mid, hi)
    }

    fn drop_value(&mut self, x: f64) {
        let (count, first) = self.not_finite.unwrap_or((0, f64::INFINITY));
        self.not_finite = Some((count + 1, if x.is_finite() { first.min(x) } else { first }));
    }

    pub(super) fn has_spread(&self) -> bool {
        self.points.iter().any(|p| p.lo < p.mid || p.hi > p.mid)
    }
}

/// The value below which the share `q` of `sorted` lies, interpolated between neighbors; NaN if there are none.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an index within the slice")]
pub fn quantile(sorted: &[f64], q: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let at = q.clamp(0.0, 1.0) * last as f64;
    let below = at.floor() as usize;
    let above = (below + 1).min(last);
    sorted[below] + (sorted[above] - sorted[below]) * (at - below as f64)
}

/// A line of reference across a panel.
#[derive(Clone, Debug)]
pub struct Guide {
    /// Value on the x axis (an upright line) or on the y axis (a level line).
    pub at: f64,
    /// Whether the line is upright.
    pub upright: bool,
    /// What it says.
    pub label: String,
}

/// One pair of axes with its series.
#[derive(Clone, Debug)]
pub struct Panel {
    /// Heading.
    pub title: String,
    /// Level axis.
    pub x: Axis,
    /// Upright axis.
    pub y: Axis,
    /// Curves.
    pub series: Vec<Series>,
    /// Lines of reference.
    pub guides: Vec<Guide>,
}

impl Panel {
    /// A panel without series.
    pub fn new(title: &str, x: Axis, y: Axis) -> Self {
        Self { title: title.to_owned(), x, y, series: Vec::new(), guides: Vec::new() }
    }

    /// With one more series.
    #[must_use]
    pub fn series(mut self, series: Series) -> Self {
        self.series.push(series);
        self
    }

    /// With an upright line of reference.
    #[must_use]
    pub fn guide_x(mut self, at: f64, label: &str) -> Self {
        self.guides.push(Guide { at, upright: true, label: label.to_owned() });
        self
    }

    /// With a level line of reference.
    #[must_use]
    pub fn guide_y(mut self, at: f64, label: &str) -> Self {
        self.guides.push(Guide { at, upright: false, label: label.to_owned() });
        self
    }
}

/// Panels in a grid with one legend.
#[derive(Clone, Debug)]
pub struct Chart {
    /// Heading.
    pub title: String,
    /// Panels, row by row.
    pub panels: Vec<Panel>,
    /// Panels in a row.
    pub columns: usize,
    /// Width and height of the area inside the axes of a panel \[px\].
    pub area: (f64, f64),
    /// Lines under the chart.
    pub notes: Vec<String>,
}

impl Chart {
    /// An empty chart with `columns` panels in a row.
    pub fn new(title: &str, columns: usize) -> Self {
        let area = (340.0, 220.0);
        Self { title: title.to_owned(), panels: Vec::new(), columns: columns.max(1), area, notes: Vec::new() }
    }

    /// With one more panel.
    #[must_use]
    pub fn panel(mut self, panel: Panel) -> Self {
        self.panels.push(panel);
        self
    }

    /// With other panel sizes \[px\].
    #[must_use]
    pub fn area(mut self, width: f64, height: f64) -> Self {
        self.area = (width.max(80.0), height.max(60.0));
        self
    }

    /// With a line under the chart.
    #[must_use]
    pub fn note(mut self, note: &str) -> Self {
        self.notes.push(note.to_owned());
        self
    }

    /// Names of the series in the order of their first panel, with their looks.
    pub(super) fn legend(&self) -> Vec<(&Series, Look)> {
        let mut entries: Vec<(&Series, Look)> = Vec::new();
        for series in self.panels.iter().flat_map(|panel| &panel.series) {
            if !entries.iter().any(|(known, _)| known.name == series.name) {
                entries.push((series, series.look.unwrap_or(Look::nth(entries.len()))));
            }
        }
        entries
    }

    /// The notes, and what must be said about spread and about values that cannot be shown.
    pub fn all_notes(&self) -> Vec<String> {
        let mut notes = self.notes.clone();
        // Series of one kind share a note, however many samples each has.
        let mut kinds: Vec<(&str, (f64, f64), usize, usize)> = Vec::new();
        for series in self.panels.iter().flat_map(|panel| &panel.series) {
            let Some((few, many)) = series.n_samples.filter(|_| series.has_spread()) else { continue };
            let shape = if series.mark == Mark::Line { "Shade" } else { "Bars" };
            match kinds.iter_mut().find(|kind| kind.0 == shape && kind.1 == series.quantiles) {
                Some(kind) => (kind.2, kind.3) = (kind.2.min(few), kind.3.max(many)),
                None => kinds.push((shape, series.quantiles, few, many)),
            }
        }
        for (shape, (lo, hi), few, many) in kinds {
            let count = if few == many { format!("{few}") } else { format!("{few} to {many}") };
            notes.push(format!(
                "Markers: median of {count} samples. {shape}: {:.0}% to {:.0}% quantile.",
                100.0 * lo,
                100.0 * hi
            ));
        }
        for panel in &self.panels {
            let place = if panel.title.is_empty() {
                String::new()
            } else {
                format!(" in \u{201c}{}\u{201d}", panel.title)
            };
            for series in &panel.series {
                let name = &series.name;
                if let Some((count, first)) = series.not_finite {
                    let (verb, mark) = (
                        if count == 1 { "value is" } else { "values are" },
                        if first.is_finite() { "; a cross at the upper edge shows the first" } else { "" },
                    );
                    notes.push(format!("{name}{place}: {count} {verb} not finite and left out{mark}."));
                }
                let hidden = series.points.iter().filter(|p| lost_on_log(panel, p)).count();
                if hidden > 0 {
                    let verb =
                        if hidden == 1 { "value of 0 or below has" } else { "values of 0 or below have" };
                    notes.push(format!("{name}{place}: {hidden} {verb} no place on a logarithmic axis."));
                }
            }
        }
        notes
    }
}

fn lost_on_log(panel: &Panel, point: &Point) -> bool {
    (panel.x.scale == Scale::Log && point.x <= 0.0) || (panel.y.scale == Scale::Log && point.mid <= 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_become_median_and_quartiles() {
        let series = Series::new("a").samples(2.0, &[4.0, 1.0, 3.0, 2.0, 5.0]);
        assert_eq!(series.points, [Point { x: 2.0, lo: 2.0, mid: 3.0, hi: 4.0 }]);
        assert_eq!(quantile(&[1.0, 2.0], 0.5), 1.5);
        assert!(quantile(&[], 0.5).is_nan());
    }

    #[test]
    fn unusable_values_are_noted() {
        let series = Series::line("a", [(1.0, f64::NAN), (2.0, f64::INFINITY), (3.0, 0.0), (4.0, 1.0)])
            .samples(5.0, &[f64::NAN, 2.0]);
        assert_eq!(series.points.len(), 3);
        let chart =
            Chart::new("", 1).panel(Panel::new("p", Axis::linear("x"), Axis::log("y")).series(series));
        let notes = chart.all_notes().join("\n");
        assert!(notes.contains("3 values are not finite"), "{notes}");
        assert!(notes.contains("1 value of 0 or below has no place"), "{notes}");
    }

    #[test]
    fn one_name_has_one_look() {
        let panel = || Panel::new("", Axis::linear("x"), Axis::linear("y"));
        let chart = Chart::new("", 2)
            .panel(panel().series(Series::new("a")).series(Series::new("b")))
            .panel(panel().series(Series::new("b")).series(Series::new("c")));
        let names: Vec<_> =
            chart.legend().iter().map(|(series, look)| (series.name.clone(), look.color)).collect();
        assert_eq!(names, [("a".to_owned(), 0), ("b".to_owned(), 1), ("c".to_owned(), 2)]);
    }
}
