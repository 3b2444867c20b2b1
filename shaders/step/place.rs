//! Pinned particles that are led.

use glam::Vec4;

use crate::{HostViews, Kernel, Update};

/// Puts q where its place says, if the place's w is not 0 \[m\]; the inverse mass stays. Reads (places).
#[derive(Debug)]
pub struct Place;

impl Kernel for Place {
    const NAME: &'static str = "place";
    const WGSL: &'static [&'static str] = &[include_str!("place.wgsl")];
    type Uniform = ();
    type Inputs = (Vec4,);
}

impl Update for Place {
    type State = Vec4;

    #[inline]
    fn update(i: u32, (): &(), (places,): HostViews<'_, Self>, q: &[Vec4]) -> Vec4 {
        let (place, own) = (places[i as usize], q[i as usize]);
        if place.w == 0.0 { own } else { place.truncate().extend(own.w) }
    }
}
