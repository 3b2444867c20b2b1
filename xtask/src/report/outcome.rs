//! What a figure hands back: everything that the page and the files are made from.

use super::error::ReportError;
use super::grid::PictureGrid;
use super::plot::Chart;
use super::raster;
use super::table::Table;

/// How a claim of the paper fared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The measurement agrees.
    Held,
    /// The measurement disagrees.
    NotHeld,
    /// This machine or this run cannot tell.
    NotTestable,
}

impl Verdict {
    /// The verdict in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Held => "held",
            Self::NotHeld => "not held",
            Self::NotTestable => "not testable here",
        }
    }
}

/// A sentence of the paper against what was found.
#[derive(Clone, Debug)]
pub struct Claim {
    /// What the paper says.
    pub paper: String,
    /// What this run found.
    pub found: String,
    /// How the two compare.
    pub verdict: Verdict,
}

impl Claim {
    /// A claim with its verdict.
    pub fn new(paper: &str, found: &str, verdict: Verdict) -> Self {
        Self { paper: paper.to_owned(), found: found.to_owned(), verdict }
    }
}

/// Something to look at.
#[derive(Clone, Debug)]
pub enum Picture {
    /// Curves.
    Chart(Chart),
    /// Pictures in a grid.
    Grid(PictureGrid),
    /// A finished picture or animation.
    Image(Image),
}

/// Bytes of a picture file.
#[derive(Clone, Debug)]
pub struct Image {
    /// What it shows, for readers who cannot see it.
    pub title: String,
    /// File ending: png, apng or gif.
    pub ending: &'static str,
    /// The file.
    pub bytes: Vec<u8>,
}

impl Image {
    /// The media type that belongs to the ending.
    pub(super) fn media_type(&self) -> &'static str {
        match self.ending {
            "gif" => "image/gif",
            "apng" => "image/apng",
            _ => "image/png",
        }
    }
}

/// A picture in the forms that are written.
pub(super) struct Drawn {
    /// An element for the page.
    pub(super) inline: String,
    /// Files: ending and bytes.
    pub(super) files: Vec<(&'static str, Vec<u8>)>,
}

impl Picture {
    /// Draws the picture; `id` is unique within the page.
    pub(super) fn draw(&self, id: &str) -> Result<Drawn, ReportError> {
        let svg = match self {
            Self::Chart(chart) => chart.svg(id),
            Self::Grid(grid) => grid.svg()?,
            Self::Image(image) => {
                let uri = raster::data_uri(image.media_type(), &image.bytes);
                let alt = super::svg::escape(&image.title);
                let inline = format!("<img src=\"{uri}\" alt=\"{alt}\"/>");
                return Ok(Drawn { inline, files: vec![(image.ending, image.bytes.clone())] });
            }
        };
        let file = svg.to_file();
        let png = raster::png_from_svg(id, &file)?;
        Ok(Drawn { inline: svg.to_inline(), files: vec![("svg", file.into_bytes()), ("png", png)] })
    }
}

/// A figure's outcome.
#[derive(Clone, Debug, Default)]
pub struct Figure {
    /// Short name, the stem of its files: `fig3`.
    pub id: String,
    /// Heading.
    pub title: String,
    /// The exact command that makes this figure alone.
    pub command: String,
    /// What is shown, on what, and which stand-ins were used.
    pub caption: String,
    /// Pictures.
    pub pictures: Vec<Picture>,
    /// Tables on the page.
    pub tables: Vec<Table>,
    /// Claims of the paper.
    pub claims: Vec<Claim>,
    /// Tables for files: CSV each, and together as JSON.
    pub data: Vec<Table>,
    /// Settings of this figure, beside those of the run.
    pub options: Vec<(String, String)>,
    /// How long it took \[s\].
    pub seconds: Option<f64>,
}

impl Figure {
    /// A figure without content.
    pub fn new(id: &str, title: &str, command: &str, caption: &str) -> Self {
        Self {
            id: id.to_owned(),
            title: title.to_owned(),
            command: command.to_owned(),
            caption: caption.to_owned(),
            ..Self::default()
        }
    }

    /// With a chart.
    #[must_use]
    pub fn chart(mut self, chart: Chart) -> Self {
        self.pictures.push(Picture::Chart(chart));
        self
    }

    /// With a grid of pictures.
    #[must_use]
    pub fn grid(mut self, grid: PictureGrid) -> Self {
        self.pictures.push(Picture::Grid(grid));
        self
    }

    /// With a finished picture.
    #[must_use]
    pub fn image(mut self, title: &str, ending: &'static str, bytes: Vec<u8>) -> Self {
        self.pictures.push(Picture::Image(Image { title: title.to_owned(), ending, bytes }));
        self
    }

    /// With a table on the page.
    #[must_use]
    pub fn table(mut self, table: Table) -> Self {
        self.tables.push(table);
        self
    }

    /// With a table in files.
    #[must_use]
    pub fn data(mut self, data: Table) -> Self {
        self.data.push(data);
        self
    }

    /// With a claim.
    #[must_use]
    pub fn claim(mut self, paper: &str, found: &str, verdict: Verdict) -> Self {
        self.claims.push(Claim::new(paper, found, verdict));
        self
    }

    /// With a setting.
    #[must_use]
    pub fn option(mut self, name: &str, value: impl ToString) -> Self {
        self.options.push((name.to_owned(), value.to_string()));
        self
    }

    /// Stem of the file of picture `idx`: the id alone for the first.
    pub(super) fn picture_stem(&self, idx: usize) -> String {
        if idx == 0 { self.id.clone() } else { format!("{}-{}", self.id, idx + 1) }
    }

    /// Stems of the files of the data tables, all different.
    pub(super) fn data_stems(&self) -> Vec<String> {
        let mut stems: Vec<String> = Vec::new();
        for (idx, table) in self.data.iter().enumerate() {
            let name = slug(&table.name);
            let stem = if name.is_empty() { self.id.clone() } else { format!("{}-{name}", self.id) };
            stems.push(if stems.contains(&stem) { format!("{stem}-{}", idx + 1) } else { stem });
        }
        stems
    }
}

/// Letters and digits of `text`, with single dashes between.
fn slug(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        if c.is_ascii_alphanumeric() {
            out.push(c.to_ascii_lowercase());
        } else if !out.is_empty() && !out.ends_with('-') {
            out.push('-');
        }
    }
    out.trim_end_matches('-').to_owned()
}
