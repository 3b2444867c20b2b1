//! Colors, markers and dashes: eight of each, so that a chart also reads in black and white.

use super::plot::Look;
use super::svg::{Svg, num};

/// The palette of Okabe and Ito, darkest contrasts first; distinct for all common forms of color vision.
const COLORS: [&str; 8] =
    ["#0072b2", "#d55e00", "#009e73", "#000000", "#cc79a7", "#e69f00", "#56b4e9", "#8a8a8a"];

const DASHES: [&str; 8] = ["", "8 3", "2 2.5", "8 3 2 3", "12 4", "4 2", "1.5 4", "10 3 2 3 2 3"];

impl Look {
    /// The dash of dots.
    pub const DOTTED: usize = 6;

    pub(super) fn stroke(self) -> &'static str {
        COLORS[self.color % COLORS.len()]
    }

    /// Attributes of a curve.
    pub(super) fn curve(self, width: f64) -> String {
        let dash = DASHES[self.dash % DASHES.len()];
        let dash = if dash.is_empty() { String::new() } else { format!(" stroke-dasharray=\"{dash}\"") };
        format!(
            "fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" stroke-linejoin=\"round\"{dash}",
            self.stroke(),
            num(width)
        )
    }

    /// Draws the marker around `(x, y)`; every second one is hollow.
    pub(super) fn draw(self, svg: &mut Svg, x: f64, y: f64, r: f64) {
        let color = self.stroke();
        let hollow = self.marker % 2 == 1;
        let style = if hollow {
            format!("fill=\"#ffffff\" stroke=\"{color}\" stroke-width=\"1.7\"")
        } else {
            format!("fill=\"{color}\" stroke=\"#ffffff\" stroke-width=\"0.8\"")
        };
        let r = if hollow { r * 0.94 } else { r };
        let ring = |corners: &[(f64, f64)]| -> Vec<(f64, f64)> {
            corners.iter().map(|(dx, dy)| (x + r * dx, y + r * dy)).collect()
        };
        match self.marker % 8 {
            0 | 5 => {
                svg.raw(&format!("<circle cx=\"{}\" cy=\"{}\" r=\"{}\" {style}/>", num(x), num(y), num(r)));
            }
            1 | 4 => svg.rect(x - 0.86 * r, y - 0.86 * r, 1.72 * r, 1.72 * r, &style),
            2 | 7 => svg.path(&ring(&[(0.0, -1.2), (1.1, 0.8), (-1.1, 0.8)]), true, &style),
            3 => svg.path(&ring(&[(0.0, -1.3), (1.15, 0.0), (0.0, 1.3), (-1.15, 0.0)]), true, &style),
            _ => svg.path(&ring(&[(0.0, 1.2), (1.1, -0.8), (-1.1, -0.8)]), true, &style),
        }
    }
}
