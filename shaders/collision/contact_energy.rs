//! The energy of contacts.

use bytemuck::{Pod, Zeroable};
use glam::Vec4;

use super::Contact;
use crate::{HostViews, Kernel, Map};

/// w d²/2 \[J\] of contact `i`, d its depth at q; friction has no energy here. Reads (contacts, mobility, q \[m\]), see [`Hold`](super::Hold).
///
/// A device may round otherwise: the depth by 10⁻⁶ of the size of A q.
#[derive(Debug)]
pub struct ContactEnergy;

/// Parameters of [`ContactEnergy`].
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct ContactEnergyUniform {
    /// w times the mobility of a contact.
    pub stiffness: f32,
}

impl Kernel for ContactEnergy {
    const NAME: &'static str = "contact_energy";
    const WGSL: &'static [&'static str] = &[super::WGSL, include_str!("contact_energy.wgsl")];
    type Uniform = ContactEnergyUniform;
    type Inputs = (Contact, f32, Vec4);
}

impl Map for ContactEnergy {
    type Output = f32;

    fn map(
        i: u32,
        uniform: &ContactEnergyUniform,
        (contacts, mobility, q): HostViews<'_, Self>,
        own: &mut f32,
    ) {
        let contact = &contacts[i as usize];
        let p = contact.particles.map(|p| mobility[p as usize]);
        let softness = (Vec4::from(p) * contact.weights).dot(contact.weights);
        let depth = contact.depth(contact.apply(q)).max(0.0);
        *own = if softness > 0.0 { 0.5 * uniform.stiffness / softness * depth * depth } else { 0.0 };
    }
}
