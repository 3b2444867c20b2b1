//! What contacts ask of a sweep over the rows of Y.

use bytemuck::{Pod, Zeroable};
use glam::Vec4;

use super::Contact;
use super::hold::vector;
use crate::{HostViews, Kernel, Scatter};

/// Adds to the anchors of contact `i`'s particles what its force has changed by since it last did, over the anchor's weight: so a vertex that is relaxed
/// feels the force. Reads (contacts, multipliers \[N\]), writes anchors \[m\], whose w is their weight \[N/m\], and the multipliers that
/// they have.
///
/// A device may round otherwise: by 10⁻⁶ of the force over the weight.
#[derive(Debug)]
pub struct Push;

/// Parameters of [`Push`].
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct PushUniform {
    /// What the multiplier is taken times.
    pub scale: f32,
}

impl Kernel for Push {
    const NAME: &'static str = "push";
    const WGSL: &'static [&'static str] = &[super::WGSL, include_str!("push.wgsl")];
    type Uniform = PushUniform;
    type Inputs = (Contact, Vec4);
}

impl Scatter<4> for Push {
    type State = Vec4;
    type Own = Vec4;

    fn scatter(
        i: u32,
        uniform: &PushUniform,
        (contacts, lambdas): HostViews<'_, Self>,
        anchors: &[Vec4],
        pushed: &mut Vec4,
    ) -> [Option<(u32, Vec4)>; 4] {
        let contact = &contacts[i as usize];
        let step = vector(contact, lambdas[i as usize] - *pushed) * uniform.scale;
        *pushed = lambdas[i as usize];
        std::array::from_fn(|slot| {
            let (particle, a) = (contact.particles[slot], contact.weights[slot]);
            (contact.is_free(slot) && a != 0.0).then(|| {
                let anchor = anchors[particle as usize];
                (particle, anchor + (step * (a / anchor.w)).extend(0.0))
            })
        })
    }
}
