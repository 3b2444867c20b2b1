//! Charts, matrix pictures, tables and the report page, from plain data.
//!
//! A figure hands back a [`Figure`]; a [`Report`] writes its files and the page. A picture is described once and
//! written twice: as SVG, whose text stays text, and as PNG, rasterised with fonts that travel inside the program.

pub mod axis;
mod curve;
mod data;
mod draw;
mod error;
pub mod font;
mod grid;
mod html;
mod look;
mod machine;
mod outcome;
mod plot;
mod progress;
pub mod raster;
mod run;
mod spy;
pub mod svg;
mod table;
#[cfg(test)]
mod tests;

pub use axis::{Axis, Scale};
pub use data::write_csv;
pub use error::ReportError;
pub use grid::{Cell, GridRow, PictureGrid};
pub use machine::{Machine, commit, now};
pub use outcome::{Claim, Figure, Image, Picture, Verdict};
pub use plot::{Chart, Guide, Look, Mark, Panel, Point, Series, quantile};
pub use progress::Progress;
pub use run::{Report, RunInfo};
pub use spy::spy;
pub use table::{Table, Value};
