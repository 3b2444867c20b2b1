//! Ways that lead into a solid end outside.

use glam::Vec4;

use super::solid::{self, SAME_SIDE, Solid};
use crate::{HostViews, Kernel, Map};

/// Ends the way of particle `i` where it would come nearer to the solid than its distance: beside the surface at the end of its way where
/// that is the same side, else where it meets the solid; or, if the solid lets nothing slide, on its straight way. Reads (from \[m\] and the inverse mass \[1/kg\], values of a field \[m\]).
#[derive(Debug)]
pub struct KeepOut;

impl Kernel for KeepOut {
    const NAME: &'static str = "keep_out";
    const WGSL: &'static [&'static str] = &[solid::WGSL, include_str!("keep_out.wgsl")];
    type Uniform = Solid;
    type Inputs = (Vec4, f32);
}

impl Map for KeepOut {
    type Output = Vec4;

    fn map(i: u32, solid: &Solid, (from, values): HostViews<'_, Self>, own: &mut Vec4) {
        let from = from[i as usize];
        // Where neither moves there is nothing to shorten: what is pinned stays even inside.
        if from.w == 0.0 || (solid.is_still() && from.truncate() == own.truncate()) {
            return;
        }
        let way = solid.way(from.truncate(), own.truncate());
        let Some(part) = solid.first_within(values, way, solid.distance, 0.0) else { return };
        let mut place = way[0] + part * (way[1] - way[0]);
        let (there, end) = (solid.seen_from(values, place), solid.seen_from(values, way[1]));
        if solid.slides != 0 && there.normal.dot(end.normal) >= SAME_SIDE {
            if end.distance >= solid.distance {
                return;
            }
            place = way[1] + (solid.distance - end.distance) * end.normal;
        }
        *own = if solid.slides == 0 { from + part * (*own - from) } else { solid.ended(place).extend(own.w) };
    }
}
