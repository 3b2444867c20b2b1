//! From SVG to PNG, and PNG bytes from pixels.

#![expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "pixel arithmetic")]

use base64::Engine as _;
use resvg::{tiny_skia, usvg};

use super::error::ReportError;
use super::font;

/// Pixels of a PNG for each unit of its SVG.
pub const SCALE: f32 = 2.0;

/// Rasterises an SVG file at `SCALE`, on white, with the embedded fonts.
pub fn png_from_svg(what: &str, svg: &str) -> Result<Vec<u8>, ReportError> {
    let fail = |reason: String| ReportError::picture(what, reason);
    let options = usvg::Options {
        fontdb: font::database(),
        font_resolver: usvg::FontResolver {
            select_font: usvg::FontResolver::default_font_selector(),
            select_fallback: Box::new(font::fallback),
        },
        font_family: "Noto Sans".to_owned(),
        ..usvg::Options::default()
    };
    let tree = usvg::Tree::from_str(svg, &options).map_err(|e| fail(e.to_string()))?;
    let width = (tree.size().width() * SCALE).ceil() as u32;
    let height = (tree.size().height() * SCALE).ceil() as u32;
    let mut pixmap = tiny_skia::Pixmap::new(width, height)
        .ok_or_else(|| fail(format!("no room for a picture of {width} x {height} pixels")))?;
    pixmap.fill(tiny_skia::Color::WHITE);
    resvg::render(&tree, tiny_skia::Transform::from_scale(SCALE, SCALE), &mut pixmap.as_mut());
    let rgb: Vec<u8> =
        pixmap.pixels().iter().flat_map(|pixel| [pixel.red(), pixel.green(), pixel.blue()]).collect();
    encode(what, width, height, png::ColorType::Rgb, png::BitDepth::Eight, &rgb)
}

/// A gray picture in 16 levels, two pixels a byte; `levels` holds one value of 0 (black) to 15 (white) a pixel, row by row.
pub fn png_from_gray16(what: &str, width: u32, height: u32, levels: &[u8]) -> Result<Vec<u8>, ReportError> {
    if width == 0 || levels.len() != width as usize * height as usize {
        return Err(ReportError::picture(what, "pixels do not fill the picture"));
    }
    let mut packed = Vec::with_capacity(levels.len().div_ceil(2));
    for row in levels.chunks(width as usize) {
        for pair in row.chunks(2) {
            packed.push((pair[0].min(15) << 4) | pair.get(1).map_or(0, |&level| level.min(15)));
        }
    }
    encode(what, width, height, png::ColorType::Grayscale, png::BitDepth::Four, &packed)
}

/// A PNG file of raw pixels, row by row.
pub(crate) fn encode(
    what: &str,
    width: u32,
    height: u32,
    color: png::ColorType,
    depth: png::BitDepth,
    data: &[u8],
) -> Result<Vec<u8>, ReportError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(color);
    encoder.set_depth(depth);
    encoder.set_compression(png::Compression::High);
    let result = encoder.write_header().and_then(|mut writer| {
        writer.write_image_data(data)?;
        writer.finish()
    });
    result.map_err(|e| ReportError::picture(what, e))?;
    Ok(bytes)
}

/// Width and height \[px\] of a PNG.
pub fn png_size(what: &str, bytes: &[u8]) -> Result<(u32, u32), ReportError> {
    let decoder = png::Decoder::new(std::io::Cursor::new(bytes));
    let reader = decoder.read_info().map_err(|e| ReportError::picture(what, e))?;
    Ok((reader.info().width, reader.info().height))
}

/// Bytes as a data URI.
pub fn data_uri(media_type: &str, bytes: &[u8]) -> String {
    format!("data:{media_type};base64,{}", base64::engine::general_purpose::STANDARD.encode(bytes))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Size and the number of distinct colors of a PNG: a picture with one color is blank.
    pub(crate) fn inspect(bytes: &[u8]) -> (u32, u32, usize) {
        let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
        decoder.set_transformations(png::Transformations::EXPAND);
        let mut reader = decoder.read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let frame = reader.next_frame(&mut pixels).unwrap();
        let colors: std::collections::BTreeSet<&[u8]> =
            pixels[..frame.buffer_size()].chunks(frame.color_type.samples()).collect();
        (frame.width, frame.height, colors.len())
    }

    #[test]
    fn text_shows_without_installed_fonts() {
        let head = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"80\" height=\"20\" font-family=\"Nowhere, sans-serif\">";
        let blank = png_from_svg("blank", &format!("{head}</svg>")).unwrap();
        assert_eq!(inspect(&blank), (160, 40, 1));
        for text in ["Luby", "n₀ ∈ Δ"] {
            let png =
                png_from_svg("text", &format!("{head}<text x=\"2\" y=\"15\">{text}</text></svg>")).unwrap();
            let (width, height, colors) = inspect(&png);
            assert_eq!((width, height), (160, 40));
            assert!(colors > 4, "{text}: {colors} colors");
        }
    }

    #[test]
    fn gray_levels_survive_odd_widths() {
        let png = png_from_gray16("gray", 3, 2, &[0, 1, 2, 13, 14, 15]).unwrap();
        assert_eq!(inspect(&png), (3, 2, 6));
        assert_eq!(png_size("gray", &png).unwrap(), (3, 2));
        assert!(png_from_gray16("gray", 3, 2, &[0]).is_err());
        assert!(png_size("gray", b"no picture").is_err());
    }
}
