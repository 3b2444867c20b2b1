//! The fonts that pictures are measured and rasterised with.
//!
//! They travel inside the program: a PNG looks the same on a machine without any font. Noto Sans is the face, DejaVu
//! Sans steps in for the glyphs that Noto Sans lacks (subscripts, some mathematical signs).

use std::sync::{Arc, OnceLock};

use resvg::usvg::fontdb;
use ttf_parser::Face;

/// Families for SVG files, most wanted first; viewers without the first take a later one of similar width.
pub const FAMILIES: &str = "Noto Sans, Segoe UI, Helvetica Neue, Arial, DejaVu Sans, sans-serif";

struct Faces {
    regular: Option<Face<'static>>,
    bold: Option<Face<'static>>,
    fallback: Option<Face<'static>>,
}

fn faces() -> &'static Faces {
    static FACES: OnceLock<Faces> = OnceLock::new();
    FACES.get_or_init(|| Faces {
        regular: Face::parse(notosans::REGULAR_TTF, 0).ok(),
        bold: Face::parse(notosans::BOLD_TTF, 0).ok(),
        fallback: Face::parse(dejavu::sans::regular(), 0).ok(),
    })
}

/// The rasteriser's fonts: the embedded ones and nothing else.
pub(super) fn database() -> Arc<fontdb::Database> {
    static DATABASE: OnceLock<Arc<fontdb::Database>> = OnceLock::new();
    let database = DATABASE.get_or_init(|| {
        let mut fonts = fontdb::Database::new();
        let noto = [notosans::REGULAR_TTF, notosans::BOLD_TTF];
        for bytes in noto.into_iter().chain([dejavu::sans::regular(), dejavu::sans::bold()]) {
            fonts.load_font_data(bytes.to_vec());
        }
        fonts.set_sans_serif_family("Noto Sans");
        Arc::new(fonts)
    });
    Arc::clone(database)
}

/// A face that has a glyph for `c`, of the weight of the face that lacks it where there is one.
pub(super) fn fallback(
    c: char,
    used: &[fontdb::ID],
    fonts: &mut Arc<fontdb::Database>,
) -> Option<fontdb::ID> {
    let weight = used.first().and_then(|id| fonts.face(*id)).map(|face| face.weight);
    let covers = |id| {
        let face = fonts.with_face_data(id, |data, idx| Face::parse(data, idx).ok()?.glyph_index(c));
        face.flatten().is_some()
    };
    let mut able: Vec<_> = fonts.faces().filter(|face| !used.contains(&face.id) && covers(face.id)).collect();
    able.sort_by_key(|face| Some(face.weight) != weight);
    able.first().map(|face| face.id)
}

/// Width of `text` in the units of `size`.
pub fn width(text: &str, size: f64, bold: bool) -> f64 {
    let faces = faces();
    let face = if bold { &faces.bold } else { &faces.regular };
    text.chars().map(|c| advance(face, c).or_else(|| advance(&faces.fallback, c)).unwrap_or(0.6)).sum::<f64>()
        * size
}

fn advance(face: &Option<Face<'static>>, c: char) -> Option<f64> {
    let face = face.as_ref()?;
    let units = face.glyph_hor_advance(face.glyph_index(c)?)?;
    Some(f64::from(units) / f64::from(face.units_per_em()))
}

/// Breaks `text` at spaces into lines of at most `limit`; a single longer word stays whole.
pub fn wrap(text: &str, size: f64, limit: f64) -> Vec<String> {
    let mut lines = Vec::new();
    let mut line = String::new();
    for word in text.split_whitespace() {
        let longer = if line.is_empty() { word.to_owned() } else { format!("{line} {word}") };
        if !line.is_empty() && width(&longer, size, false) > limit {
            lines.push(std::mem::replace(&mut line, word.to_owned()));
        } else {
            line = longer;
        }
    }
    if !line.is_empty() {
        lines.push(line);
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn widths_grow_with_text_size_and_weight() {
        assert!(width("", 10.0, false).abs() < 1e-9);
        assert!(width("mm", 10.0, false) > width("ii", 10.0, false));
        assert!((width("abc", 20.0, false) - 2.0 * width("abc", 10.0, false)).abs() < 1e-9);
        assert!(width("abc", 10.0, true) > width("abc", 10.0, false));
        // Not in Noto Sans, so the fallback answers.
        assert!(width("₀∈", 10.0, false) > 5.0);
    }

    #[test]
    fn wrapping_keeps_every_word() {
        let text = "one two three aVeryLongWordThatCannotBeBroken four";
        let lines = wrap(text, 10.0, 60.0);
        assert!(lines.len() > 2);
        assert_eq!(lines.join(" "), text);
        assert!(wrap("  ", 10.0, 60.0).is_empty());
    }

    #[test]
    fn only_embedded_fonts_are_known() {
        assert_eq!(database().faces().count(), 4);
    }

    #[test]
    fn the_fallback_keeps_the_weight() {
        let mut fonts = database();
        for face in fonts.clone().faces().take(2) {
            let found = fallback('\u{2208}', &[face.id], &mut fonts).unwrap();
            assert_eq!(fonts.face(found).unwrap().weight, face.weight);
        }
        assert_eq!(fallback('\u{e000}', &[], &mut fonts), None);
    }
}
