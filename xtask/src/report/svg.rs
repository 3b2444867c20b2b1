//! A small writer of SVG documents: text stays text, numbers stay short, everything is escaped.

use std::fmt::Write as _;

use super::font;

/// Text and line color.
pub const INK: &str = "#1b1f24";
/// Color of secondary text.
pub const MUTED: &str = "#57606a";
/// Color of frames and tick marks.
pub const FRAME: &str = "#6e7781";

/// Escapes text for XML and HTML, and drops the control characters that XML forbids.
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\n' | '\t' => out.push(c),
            '\u{fffe}' | '\u{ffff}' => {}
            _ if c.is_control() => {}
            _ => out.push(c),
        }
    }
    out
}

/// A coordinate with at most two decimals.
pub fn num(value: f64) -> String {
    if !value.is_finite() {
        return "0".to_owned();
    }
    let text = format!("{value:.2}");
    let short = text.trim_end_matches('0').trim_end_matches('.');
    if short == "-0" { "0".to_owned() } else { short.to_owned() }
}

/// Which end of a text sits at its position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// The text begins there.
    Start,
    /// The text is centered there.
    Middle,
    /// The text ends there.
    End,
}

/// How and where a text is set; `y` is the baseline.
#[derive(Clone, Copy, Debug)]
pub struct Text {
    /// Position \[px\].
    pub x: f64,
    /// Baseline \[px\].
    pub y: f64,
    /// Font size \[px\].
    pub size: f64,
    /// Alignment.
    pub anchor: Anchor,
    /// Bold face.
    pub bold: bool,
    /// Color.
    pub fill: &'static str,
    /// Turned by a quarter, reading upwards.
    pub upwards: bool,
    /// White outline, for text over lines.
    pub halo: bool,
}

impl Text {
    /// Plain ink at a position.
    pub fn at(x: f64, y: f64, size: f64) -> Self {
        Self { x, y, size, anchor: Anchor::Start, bold: false, fill: INK, upwards: false, halo: false }
    }

    /// Centered at its position.
    #[must_use]
    pub fn middle(mut self) -> Self {
        self.anchor = Anchor::Middle;
        self
    }

    /// Ending at its position.
    #[must_use]
    pub fn end(mut self) -> Self {
        self.anchor = Anchor::End;
        self
    }

    /// In bold.
    #[must_use]
    pub fn bold(mut self) -> Self {
        self.bold = true;
        self
    }

    /// In a color.
    #[must_use]
    pub fn fill(mut self, fill: &'static str) -> Self {
        self.fill = fill;
        self
    }

    /// Reading upwards.
    #[must_use]
    pub fn upwards(mut self) -> Self {
        self.upwards = true;
        self
    }

    /// With a white outline.
    #[must_use]
    pub fn halo(mut self) -> Self {
        self.halo = true;
        self
    }
}

/// An SVG document in the making.
#[derive(Clone, Debug)]
pub struct Svg {
    /// Width \[px\].
    pub width: f64,
    /// Height \[px\].
    pub height: f64,
    title: String,
    body: String,
}

impl Svg {
    /// An empty document on white; `title` is what a screen reader says.
    pub fn new(width: f64, height: f64, title: &str) -> Self {
        let mut svg = Self { width, height, title: title.to_owned(), body: String::new() };
        svg.rect(0.0, 0.0, width, height, "fill=\"#ffffff\"");
        svg
    }

    /// Adds an element that is already written.
    pub fn raw(&mut self, element: &str) {
        self.body.push_str(element);
        self.body.push('\n');
    }

    /// A rectangle; `style` holds attributes.
    pub fn rect(&mut self, x: f64, y: f64, width: f64, height: f64, style: &str) {
        let (x, y, w, h) = (num(x), num(y), num(width), num(height));
        let _ = writeln!(self.body, "<rect x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\" {style}/>");
    }

    /// A straight line; `style` holds attributes.
    pub fn line(&mut self, from: (f64, f64), to: (f64, f64), style: &str) {
        let (x1, y1, x2, y2) = (num(from.0), num(from.1), num(to.0), num(to.1));
        let _ = writeln!(self.body, "<line x1=\"{x1}\" y1=\"{y1}\" x2=\"{x2}\" y2=\"{y2}\" {style}/>");
    }

    /// A path through `points`; `style` holds attributes.
    pub fn path(&mut self, points: &[(f64, f64)], closed: bool, style: &str) {
        let mut data = String::new();
        for (idx, point) in points.iter().enumerate() {
            let verb = if idx == 0 { 'M' } else { 'L' };
            let _ = write!(data, "{verb}{} {}", num(point.0), num(point.1));
        }
        if closed {
            data.push('Z');
        }
        let _ = writeln!(self.body, "<path d=\"{data}\" {style}/>");
    }

    /// A text in one line.
    pub fn text(&mut self, at: Text, text: &str) {
        self.rich_text(at, &escape(text));
    }

    /// A text whose content is already escaped and may hold `tspan` elements.
    pub fn rich_text(&mut self, at: Text, content: &str) {
        let anchor = match at.anchor {
            Anchor::Start => "",
            Anchor::Middle => " text-anchor=\"middle\"",
            Anchor::End => " text-anchor=\"end\"",
        };
        let (x, y) = (num(at.x), num(at.y));
        let weight = if at.bold { " font-weight=\"700\"" } else { "" };
        let turn = if at.upwards { format!(" transform=\"rotate(-90 {x} {y})\"") } else { String::new() };
        let halo = if at.halo {
            " stroke=\"#ffffff\" stroke-width=\"4\" stroke-linejoin=\"round\" paint-order=\"stroke\""
        } else {
            ""
        };
        let (size, fill) = (num(at.size), at.fill);
        let _ = writeln!(
            self.body,
            "<text x=\"{x}\" y=\"{y}\" font-size=\"{size}\" fill=\"{fill}\"{anchor}{weight}{turn}{halo}>{content}</text>"
        );
    }

    /// An embedded picture in PNG.
    pub fn image(&mut self, x: f64, y: f64, width: f64, height: f64, data_uri: &str) {
        let (x, y, w, h) = (num(x), num(y), num(width), num(height));
        let _ = writeln!(
            self.body,
            "<image x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\" preserveAspectRatio=\"none\" href=\"{data_uri}\"/>"
        );
    }

    /// A file of its own.
    pub fn to_file(&self) -> String {
        self.document(" xmlns=\"http://www.w3.org/2000/svg\"")
    }

    /// The element for the inside of an HTML page, which needs no namespace.
    pub fn to_inline(&self) -> String {
        self.document("")
    }

    fn document(&self, namespace: &str) -> String {
        let (w, h, title) = (num(self.width), num(self.height), escape(&self.title));
        format!(
            "<svg{namespace} width=\"{w}\" height=\"{h}\" viewBox=\"0 0 {w} {h}\" role=\"img\" \
             font-family=\"{}\">\n<title>{title}</title>\n{}</svg>\n",
            font::FAMILIES,
            self.body
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_escaped() {
        let mut svg = Svg::new(10.0, 10.0, "a <b> & \"c\"");
        svg.text(Text::at(1.0, 2.0, 10.0), "x < y & z\u{0}");
        let file = svg.to_file();
        assert!(file.contains("x &lt; y &amp; z</text>"));
        assert!(file.contains("<title>a &lt;b&gt; &amp; &quot;c&quot;</title>"));
        assert!(resvg::usvg::roxmltree::Document::parse(&file).is_ok());
        assert!(!svg.to_inline().contains("http"));
    }

    #[test]
    fn coordinates_are_short() {
        assert_eq!(num(1.0), "1");
        assert_eq!(num(1.256), "1.26");
        assert_eq!(num(-0.001), "0");
        assert_eq!(num(120.0), "120");
        assert_eq!(num(f64::NAN), "0");
    }
}
