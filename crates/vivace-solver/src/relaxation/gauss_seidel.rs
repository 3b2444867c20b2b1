//! Colored Gauss-Seidel: lines 4 to 7 of Algorithm 1.

use crate::Stages;

/// Every color once, over-relaxed from the latest positions: SOR, the default reading of line 7.
pub(super) fn forward(stages: &mut dyn Stages, omega: f32) {
    for color in 0..stages.n_colors() {
        stages.relax_color(color, omega);
    }
}

/// Line 7 as printed: over-relaxed in place from the positions an iteration earlier. Unstable above ω = 4/3.
pub(super) fn from_previous(stages: &mut dyn Stages, omega: f32) {
    for color in 0..stages.n_colors() {
        stages.relax_color_from_previous(color, omega);
    }
}

/// Every color forward, then backward: its iteration matrix is similar to a symmetric one.
pub(super) fn symmetric(stages: &mut dyn Stages) {
    forward(stages, 1.0);
    // The last color would find itself solved already.
    for color in (0..stages.n_colors().saturating_sub(1)).rev() {
        stages.relax_color(color, 1.0);
    }
}
