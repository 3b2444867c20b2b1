//! How deep contacts are.

use glam::Vec4;

use super::Contact;
use crate::{HostViews, Kernel, Map};

/// How much contact `i` is short of its distance at q \[m\], 0 if it is not; reads (contacts, q \[m\]).
///
/// A device may round otherwise: by 10⁻⁶ of the size of A q.
#[derive(Debug)]
pub struct ContactDepth;

impl Kernel for ContactDepth {
    const NAME: &'static str = "contact_depth";
    const WGSL: &'static [&'static str] = &[super::WGSL, include_str!("contact_depth.wgsl")];
    type Uniform = ();
    type Inputs = (Contact, Vec4);
}

impl Map for ContactDepth {
    type Output = f32;

    fn map(i: u32, (): &(), (contacts, q): HostViews<'_, Self>, own: &mut f32) {
        let contact = &contacts[i as usize];
        *own = contact.depth(contact.apply(q)).max(0.0);
    }
}
