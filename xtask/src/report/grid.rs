//! Pictures in a grid with headings and lines of text: matrices (figure 2), stills of an animation.

use super::error::ReportError;
use super::font;
use super::raster;
use super::svg::{FRAME, INK, MUTED, Svg, Text};

const MARGIN: f64 = 18.0;
const TITLE: f64 = 18.0;
const HEADING: f64 = 14.5;
const LINE: f64 = 13.0;
const NOTE: f64 = 12.0;
const GAP: f64 = 16.0;

/// One picture with what is said under it.
#[derive(Clone, Debug)]
pub struct Cell {
    /// The picture as PNG.
    pub png: Vec<u8>,
    /// Bounds of diagonal blocks as shares of the side, from 0 to 1; empty for none.
    pub blocks: Vec<f64>,
    /// Lines under the picture; the first is the strongest.
    pub lines: Vec<String>,
}

impl Cell {
    /// A picture without blocks.
    pub fn new(png: Vec<u8>, lines: &[String]) -> Self {
        Self { png, blocks: Vec::new(), lines: lines.to_vec() }
    }
}

/// A labeled row of pictures.
#[derive(Clone, Debug)]
pub struct GridRow {
    /// Heading at the left, read upwards; its second line is smaller.
    pub label: (String, String),
    /// Pictures from left to right.
    pub cells: Vec<Cell>,
}

/// Rows of pictures under column headings.
#[derive(Clone, Debug)]
pub struct PictureGrid {
    /// Heading.
    pub title: String,
    /// Column headings.
    pub columns: Vec<String>,
    /// Rows.
    pub rows: Vec<GridRow>,
    /// Width of a picture on the page \[px\]; its height follows from its pixels.
    pub cell_width: f64,
    /// Lines under the grid.
    pub notes: Vec<String>,
}

impl PictureGrid {
    /// A grid without rows.
    pub fn new(title: &str, columns: &[&str]) -> Self {
        let columns = columns.iter().map(|&name| name.to_owned()).collect();
        Self { title: title.to_owned(), columns, rows: Vec::new(), cell_width: 200.0, notes: Vec::new() }
    }

    /// With one more row; `label` is its heading and a smaller second line.
    #[must_use]
    pub fn row(mut self, label: (&str, &str), cells: Vec<Cell>) -> Self {
        self.rows.push(GridRow { label: (label.0.to_owned(), label.1.to_owned()), cells });
        self
    }

    /// With pictures of another width \[px\].
    #[must_use]
    pub fn cell_width(mut self, width: f64) -> Self {
        self.cell_width = width.max(40.0);
        self
    }

    /// With a line under the grid.
    #[must_use]
    pub fn note(mut self, note: &str) -> Self {
        self.notes.push(note.to_owned());
        self
    }

    /// The picture, with the pixels embedded.
    pub fn svg(&self) -> Result<Svg, ReportError> {
        let n_columns =
            self.rows.iter().map(|row| row.cells.len()).max().unwrap_or(0).max(self.columns.len());
        let labeled = self.rows.iter().any(|row| !row.label.0.is_empty());
        let left = MARGIN + if labeled { 44.0 } else { 0.0 };
        let pitch = self.cell_width + GAP;
        let inner = left + pitch * n_columns as f64 - GAP + MARGIN;
        let width = inner.max(font::width(&self.title, TITLE, true) + 2.0 * MARGIN).max(160.0);
        let notes: Vec<String> =
            self.notes.iter().flat_map(|note| font::wrap(note, NOTE, width - 2.0 * MARGIN)).collect();
        let heights: Vec<(f64, f64)> =
            self.rows.iter().map(|row| self.room(row)).collect::<Result<_, _>>()?;

        let top = MARGIN + if self.title.is_empty() { 0.0 } else { TITLE + 12.0 };
        let heading = if self.columns.iter().all(String::is_empty) { 0.0 } else { HEADING + 9.0 };
        let body: f64 = heights.iter().map(|(picture, text)| picture + text + GAP).sum();
        let notes_at = top + heading + body + 6.0;
        let height = notes_at + 17.0 * notes.len() as f64 + 4.0;

        let mut svg = Svg::new(width.ceil(), height.ceil(), &self.title);
        if !self.title.is_empty() {
            svg.text(Text::at(MARGIN, MARGIN + TITLE, TITLE).bold(), &self.title);
        }
        for (column, name) in self.columns.iter().enumerate() {
            let x = left + pitch * column as f64 + self.cell_width / 2.0;
            svg.text(Text::at(x, top + HEADING, HEADING).middle().bold(), name);
        }
        let mut y = top + heading;
        for (row, (picture, text)) in self.rows.iter().zip(&heights) {
            let center = y + picture / 2.0;
            svg.text(Text::at(MARGIN + 14.0, center, HEADING).middle().bold().upwards(), &row.label.0);
            svg.text(Text::at(MARGIN + 32.0, center, LINE).middle().upwards().fill(MUTED), &row.label.1);
            for (column, cell) in row.cells.iter().enumerate() {
                self.draw_cell(&mut svg, cell, left + pitch * column as f64, y)?;
            }
            y += picture + text + GAP;
        }
        for (idx, note) in notes.iter().enumerate() {
            svg.text(Text::at(MARGIN, notes_at + 17.0 * idx as f64, NOTE).fill(MUTED), note);
        }
        Ok(svg)
    }

    /// Height of a cell's picture on the page.
    fn picture_height(&self, cell: &Cell) -> Result<f64, ReportError> {
        let (width, height) = raster::png_size(&self.title, &cell.png)?;
        Ok(self.cell_width * f64::from(height) / f64::from(width.max(1)))
    }

    /// Heights of a row's pictures and of the text under them.
    fn room(&self, row: &GridRow) -> Result<(f64, f64), ReportError> {
        let mut picture: f64 = 0.0;
        for cell in &row.cells {
            picture = picture.max(self.picture_height(cell)?);
        }
        let lines = row.cells.iter().map(|cell| cell.lines.len()).max().unwrap_or(0);
        Ok((picture, if lines == 0 { 0.0 } else { 6.0 + 18.0 * lines as f64 }))
    }

    fn draw_cell(&self, svg: &mut Svg, cell: &Cell, x: f64, y: f64) -> Result<(), ReportError> {
        let (width, height) = (self.cell_width, self.picture_height(cell)?);
        svg.image(x, y, width, height, &raster::data_uri("image/png", &cell.png));
        for pair in cell.blocks.windows(2) {
            let (from, share) = (pair[0], pair[1] - pair[0]);
            let style = "fill=\"#56b4e9\" fill-opacity=\"0.28\"";
            svg.rect(x + from * width, y + from * height, share * width, share * height, style);
        }
        let inner = cell.blocks.get(1..cell.blocks.len().saturating_sub(1)).unwrap_or_default();
        let mut last = 0.0;
        for bound in inner {
            // Where many small colors crowd, lines would cover the entries.
            if (bound - last) * width < 6.0 {
                continue;
            }
            last = *bound;
            let style = "stroke=\"#d55e00\" stroke-width=\"0.6\" stroke-opacity=\"0.55\"";
            svg.line((x, y + bound * height), (x + width, y + bound * height), style);
            svg.line((x + bound * width, y), (x + bound * width, y + height), style);
        }
        svg.rect(x, y, width, height, &format!("fill=\"none\" stroke=\"{FRAME}\" stroke-width=\"1\""));
        for (idx, line) in cell.lines.iter().enumerate() {
            let at = Text::at(x + width / 2.0, y + height + 19.0 + 18.0 * idx as f64, LINE).middle();
            svg.text(at.fill(if idx == 0 { INK } else { MUTED }), line);
        }
        Ok(())
    }
}
