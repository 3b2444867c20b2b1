//! What contacts do to a vertex, as sweeps see it.

use glam::{Vec3, Vec4};

use crate::{HostViews, Kernel, Update};

/// Shifts the anchor of particle `i` by the force of what contacts have moved it by: that way over its mobility, over the anchor's weight, which w
/// keeps \[N/m\], and says in w that it has. Reads (q \[m\], where it was before \[m\], mobility \[m/N\]).
///
/// A device may round otherwise: by 10⁻⁶ of the shift, and of the size of q.
#[derive(Debug)]
pub struct ShiftAnchor;

impl Kernel for ShiftAnchor {
    const NAME: &'static str = "shift_anchor";
    const WGSL: &'static [&'static str] = &[include_str!("shift_anchor.wgsl")];
    type Uniform = ();
    type Inputs = (Vec4, Vec4, f32);
}

impl Update for ShiftAnchor {
    type State = Vec4;

    #[inline]
    fn update(i: u32, (): &(), (q, from, mobility): HostViews<'_, Self>, anchors: &[Vec4]) -> Vec4 {
        let i = i as usize;
        let (moved, anchor) = (q[i].truncate() - from[i].truncate(), anchors[i]);
        if moved == Vec3::ZERO {
            return anchor;
        }
        let weight = anchor.w.abs();
        (anchor.truncate() + moved / (mobility[i] * weight)).extend(-weight)
    }
}
