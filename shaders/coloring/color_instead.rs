//! Another coloring, where the first is none.

use crate::{HostViews, Kernel, Map};

/// The color that another coloring gives, where counter 0 is down; reads (counters, other colors).
#[derive(Debug)]
pub struct ColorInstead;

impl Kernel for ColorInstead {
    const NAME: &'static str = "color_instead";
    const WGSL: &'static [&'static str] = &[include_str!("color_instead.wgsl")];
    type Uniform = ();
    type Inputs = (u32, u32);
}

impl Map for ColorInstead {
    type Output = u32;

    #[inline]
    fn map(v: u32, (): &(), (counters, instead): HostViews<'_, Self>, color: &mut u32) {
        if counters[0] == 0 {
            *color = instead[v as usize];
        }
    }
}
