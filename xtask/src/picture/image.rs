//! Pixels, and the files that hold them.

use crate::report::{ReportError, raster};

/// A picture of RGB pixels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Red, green and blue (sRGB) of each pixel, row by row from the top.
    pub pixels: Vec<u8>,
}

impl Image {
    /// The picture as a PNG file.
    ///
    /// # Errors
    /// [`ReportError::Picture`] if the picture has no pixels, or not as many as it says.
    pub fn png(&self) -> Result<Vec<u8>, ReportError> {
        let (color, depth) = (png::ColorType::Rgb, png::BitDepth::Eight);
        raster::encode("a rendered picture", self.width, self.height, color, depth, &self.pixels)
    }

    fn row(&self, row: usize) -> &[u8] {
        let length = self.width as usize * 3;
        &self.pixels[row * length..(row + 1) * length]
    }

    /// The smallest rectangle that holds every change since `before`; one pixel if nothing has changed.
    fn change_since(&self, before: &Self) -> Rect {
        let (mut left, mut right) = (usize::MAX, 0);
        let (mut top, mut bottom) = (usize::MAX, 0);
        for row in 0..self.height as usize {
            let (new, old) = (self.row(row), before.row(row));
            let differs = |idx: &usize| new[*idx] != old[*idx];
            let Some(first) = (0..new.len()).find(differs) else { continue };
            let last = (first..new.len()).rev().find(differs).unwrap_or(first);
            (left, right) = (left.min(first / 3), right.max(last / 3 + 1));
            (top, bottom) = (top.min(row), row + 1);
        }
        if right == 0 { Rect { x: 0..1, y: 0..1 } } else { Rect { x: left..right, y: top..bottom } }
    }

    fn cut(&self, rect: &Rect) -> Vec<u8> {
        rect.y.clone().flat_map(|row| &self.row(row)[rect.x.start * 3..rect.x.end * 3]).copied().collect()
    }
}

/// Columns and rows of a piece of a picture.
struct Rect {
    x: std::ops::Range<usize>,
    y: std::ops::Range<usize>,
}

/// An animated PNG that repeats without end; each frame is shown for `frame_seconds` \[s\], to the millisecond.
///
/// After the first frame, only the rectangle that changes is stored.
///
/// # Errors
/// [`ReportError::Picture`] without frames, for frames of different sizes or without pixels, and for a duration that is not
/// between 0.001 s and 60 s.
pub fn animation(frames: &[Image], frame_seconds: f32) -> Result<Vec<u8>, ReportError> {
    let fail = |reason: String| ReportError::picture("an animation", reason);
    let first = frames.first().ok_or_else(|| fail("it has no frames".to_owned()))?;
    let length = first.width as usize * first.height as usize * 3;
    for (idx, frame) in frames.iter().enumerate() {
        if (frame.width, frame.height) != (first.width, first.height) || frame.pixels.len() != length {
            return Err(fail(format!("frame {idx} differs in size from the first, or lacks pixels")));
        }
    }
    if !(0.001..=60.0).contains(&frame_seconds) {
        return Err(fail(format!("a frame is to last {frame_seconds} s, which is not within 0.001 to 60")));
    }
    write(frames, first, frame_seconds).map_err(|e| fail(e.to_string()))
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "counts, sizes and times were checked"
)]
fn write(frames: &[Image], first: &Image, frame_seconds: f32) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, first.width, first.height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    encoder.set_animated(frames.len() as u32, 0)?;
    encoder.set_frame_delay((frame_seconds * 1000.0).round() as u16, 1000)?;
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&first.pixels)?;
    for pair in frames.windows(2) {
        let rect = pair[1].change_since(&pair[0]);
        // The place goes back to the corner first: a size is checked against the place of the frame before.
        writer.set_frame_position(0, 0)?;
        writer.set_frame_dimension(rect.x.len() as u32, rect.y.len() as u32)?;
        writer.set_frame_position(rect.x.start as u32, rect.y.start as u32)?;
        writer.write_image_data(&pair[1].cut(&rect))?;
    }
    writer.finish()?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A gray picture with one square of another color.
    fn square(at: usize, color: [u8; 3]) -> Image {
        let (width, height) = (20, 12);
        let mut pixels = vec![200; width * height * 3];
        for row in at..at + 3 {
            for column in at..at + 4 {
                let start = (row * width + column) * 3;
                pixels[start..start + 3].copy_from_slice(&color);
            }
        }
        Image { width: 20, height: 12, pixels }
    }

    /// The frames as a viewer shows them: each piece painted over what was there.
    fn play(bytes: &[u8]) -> (u32, Vec<Image>, usize) {
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let control = *reader.info().animation_control().unwrap();
        assert_eq!(control.num_plays, 0);
        let mut canvas = Image { width: 20, height: 12, pixels: vec![0; 20 * 12 * 3] };
        let (mut shown, mut stored) = (Vec::new(), 0);
        for _ in 0..control.num_frames {
            let mut buffer = vec![0; reader.output_buffer_size().unwrap()];
            reader.next_frame(&mut buffer).unwrap();
            let frame = *reader.info().frame_control().unwrap();
            assert_eq!((frame.delay_num, frame.delay_den), (40, 1000));
            stored += frame.width * frame.height;
            for row in 0..frame.height as usize {
                let length = frame.width as usize * 3;
                let start = ((row + frame.y_offset as usize) * 20 + frame.x_offset as usize) * 3;
                canvas.pixels[start..start + length].copy_from_slice(&buffer[row * length..][..length]);
            }
            shown.push(canvas.clone());
        }
        (control.num_frames, shown, stored as usize)
    }

    #[test]
    fn an_animation_plays_back_what_went_in() {
        let (red, blue) = ([220, 20, 20], [20, 20, 220]);
        let frames = [square(1, red), square(1, red), square(7, red), square(9, blue), square(0, blue)];
        let bytes = animation(&frames, 0.04).unwrap();
        let (count, shown, stored) = play(&bytes);
        assert_eq!(count, 5);
        assert_eq!(shown, frames);
        assert!(stored < 3 * 20 * 12, "{stored} pixels");
    }

    #[test]
    fn what_makes_no_file_is_an_error() {
        let good = square(0, [0; 3]);
        let empty = Image { width: 0, height: 0, pixels: Vec::new() };
        let short = Image { pixels: vec![0; 5], ..good.clone() };
        assert!(empty.png().is_err() && short.png().is_err() && good.png().is_ok());
        assert!(animation(&[], 0.1).is_err() && animation(std::slice::from_ref(&empty), 0.1).is_err());
        assert!(animation(&[good.clone(), short], 0.1).is_err());
        assert!(animation(&[good.clone(), empty], 0.1).is_err());
        for seconds in [0.0, -1.0, 61.0, f32::NAN] {
            assert!(animation(std::slice::from_ref(&good), seconds).is_err(), "{seconds}");
        }
    }
}
