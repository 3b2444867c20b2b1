//! A run: its facts, its figures, and the folder they are written to.

use std::path::{Path, PathBuf};

use serde_json::json;

use super::data;
use super::error::ReportError;
use super::html;
use super::machine::{self, Machine};
use super::outcome::Figure;

/// What is true of all figures of a run.
#[derive(Clone, Debug)]
pub struct RunInfo {
    /// Heading of the page.
    pub title: String,
    /// Paragraphs under the heading.
    pub summary: Vec<String>,
    /// The exact command of the run.
    pub command: String,
    /// Commit of the source.
    pub commit: String,
    /// Seed of all random numbers.
    pub seed: u64,
    /// The machine.
    pub machine: Machine,
    /// Date and time of the start.
    pub date: String,
    /// Settings.
    pub options: Vec<(String, String)>,
}

impl RunInfo {
    /// Facts of a run that starts now, from the source in `folder`.
    pub fn new(title: &str, command: &str, seed: u64, folder: &Path) -> Self {
        Self {
            title: title.to_owned(),
            summary: Vec::new(),
            command: command.to_owned(),
            commit: machine::commit(folder),
            seed,
            machine: Machine::probe(),
            date: machine::now(),
            options: Vec::new(),
        }
    }

    /// With a paragraph under the heading.
    #[must_use]
    pub fn paragraph(mut self, text: &str) -> Self {
        self.summary.push(text.to_owned());
        self
    }

    /// With a setting.
    #[must_use]
    pub fn option(mut self, name: &str, value: impl ToString) -> Self {
        self.options.push((name.to_owned(), value.to_string()));
        self
    }
}

/// A figure as it stands on the page: its pictures drawn, its files written.
pub(super) struct Written {
    pub(super) figure: Figure,
    /// Element and file names of each picture.
    pub(super) pictures: Vec<(String, Vec<String>)>,
    /// File names of the data.
    pub(super) data: Vec<String>,
}

/// Writes figures into a folder, and the page anew after each: what is done stays, even if a later figure fails.
pub struct Report {
    folder: PathBuf,
    info: RunInfo,
    figures: Vec<Written>,
}

impl Report {
    /// Makes the folder.
    pub fn create(folder: &Path, info: RunInfo) -> Result<Self, ReportError> {
        std::fs::create_dir_all(folder).map_err(|source| ReportError::io(folder, source))?;
        Ok(Self { folder: folder.to_owned(), info, figures: Vec::new() })
    }

    /// Facts of the run; adapters and options may be added until the last figure.
    pub fn info_mut(&mut self) -> &mut RunInfo {
        &mut self.info
    }

    /// Writes the files of `figure`, then the page.
    pub fn add(&mut self, figure: Figure) -> Result<(), ReportError> {
        let mut pictures = Vec::new();
        for (idx, picture) in figure.pictures.iter().enumerate() {
            let stem = figure.picture_stem(idx);
            let drawn = picture.draw(&stem)?;
            let mut names = Vec::new();
            for (ending, bytes) in &drawn.files {
                let name = format!("{stem}.{ending}");
                self.write(&name, bytes)?;
                names.push(name);
            }
            pictures.push((drawn.inline, names));
        }
        let mut data = Vec::new();
        for (table, stem) in figure.data.iter().zip(figure.data_stems()) {
            let (csv, json) = (format!("{stem}.csv"), format!("{stem}.json"));
            data::write_csv(&self.folder.join(&csv), table)?;
            self.write(&json, &data::pretty(&json, &data::figure_json(&self.info, &figure, table))?)?;
            data.extend([csv, json]);
        }
        self.figures.push(Written { figure, pictures, data });
        self.write("report.json", &data::pretty("report.json", &self.summary())?)?;
        self.write("report.html", html::page(&self.info, &self.figures).as_bytes())
    }

    /// Writes the page a last time and says where it is.
    pub fn finish(self) -> Result<PathBuf, ReportError> {
        self.write("report.json", &data::pretty("report.json", &self.summary())?)?;
        self.write("report.html", html::page(&self.info, &self.figures).as_bytes())?;
        Ok(self.folder.join("report.html"))
    }

    fn write(&self, name: &str, bytes: &[u8]) -> Result<(), ReportError> {
        let path = self.folder.join(name);
        std::fs::write(&path, bytes).map_err(|source| ReportError::io(&path, source))
    }

    fn summary(&self) -> serde_json::Value {
        let figures: Vec<_> = self
            .figures
            .iter()
            .map(|written| {
                let figure = &written.figure;
                let claims: Vec<_> = figure
                    .claims
                    .iter()
                    .map(|claim| json!({"paper": claim.paper, "found": claim.found, "verdict": claim.verdict.words()}))
                    .collect();
                let files: Vec<_> = written.pictures.iter().flat_map(|(_, names)| names).chain(&written.data).collect();
                json!({
                    "figure": figure.id, "title": figure.title, "command": figure.command,
                    "caption": figure.caption, "seconds": figure.seconds, "claims": claims, "files": files,
                })
            })
            .collect();
        let mut summary = data::run_json(&self.info);
        summary.insert("figures".to_owned(), figures.into());
        summary.into()
    }
}
