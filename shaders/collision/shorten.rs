//! The guard: ways are shortened.

use bytemuck::{Pod, Zeroable};
use glam::Vec4;

use crate::{HostViews, Kernel, Select};

/// Shortens the way of particle `i` to the part of it that it may go, and selects it if that is not the whole; reads (parts, as
/// [`Hit`](super::Hit) leaves them; from \[m\]).
#[derive(Debug)]
pub struct Shorten;

/// Parameters of [`Shorten`].
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct ShortenUniform {
    /// Whether all particles stay where they are if any pair hits.
    pub gives_up: u32,
    /// How many particles there are.
    pub n: u32,
}

impl Kernel for Shorten {
    const NAME: &'static str = "shorten";
    const WGSL: &'static [&'static str] = &[include_str!("shorten.wgsl")];
    type Uniform = ShortenUniform;
    type Inputs = (u32, Vec4);
}

impl Select for Shorten {
    type Output = Vec4;

    fn select(i: u32, uniform: &ShortenUniform, (parts, from): HostViews<'_, Self>, own: &mut Vec4) -> bool {
        let from = from[i as usize];
        if uniform.gives_up != 0 {
            if parts[uniform.n as usize] == 0 {
                *own = from;
            }
            return false;
        }
        let bits = parts[i as usize];
        if bits == u32::MAX {
            return false;
        }
        let part = f32::from_bits(bits);
        *own = if part > 0.0 { from + part * (*own - from) } else { from };
        true
    }
}
