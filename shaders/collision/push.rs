//! What contacts do, as forces.

use bytemuck::{Pod, Zeroable};
use glam::Vec4;

use super::Contact;
use crate::{HostViews, Kernel, Scatter};

/// Adds the force of contact `i`, its multiplier times a scale, to its particles. Reads (contacts), writes forces \[N\]; the multipliers stay as
/// they are.
///
/// A device may round otherwise: by 10⁻⁶ of the force.
#[derive(Debug)]
pub struct Push;

/// Parameters of [`Push`].
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct PushUniform {
    /// What the multiplier is taken times \[1/s²\].
    pub scale: f32,
}

impl Kernel for Push {
    const NAME: &'static str = "push";
    const WGSL: &'static [&'static str] = &[super::WGSL, include_str!("push.wgsl")];
    type Uniform = PushUniform;
    type Inputs = (Contact,);
}

impl Scatter<4> for Push {
    type State = Vec4;
    type Own = Vec4;

    fn scatter(
        i: u32,
        uniform: &PushUniform,
        (contacts,): HostViews<'_, Self>,
        forces: &[Vec4],
        lambda: &mut Vec4,
    ) -> [Option<(u32, Vec4)>; 4] {
        let contact = &contacts[i as usize];
        let force = (contact.normal * lambda.w + lambda.truncate()) * uniform.scale;
        std::array::from_fn(|slot| {
            let (particle, a) = (contact.particles[slot], contact.weights[slot]);
            (contact.is_free(slot) && a != 0.0)
                .then(|| (particle, forces[particle as usize] + (force * a).extend(0.0)))
        })
    }
}
