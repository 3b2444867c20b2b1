//! One projection of each contact of a color: C = n · (A q − origin) − distance ≥ 0, with Coulomb's friction in position form.

use bytemuck::{Pod, Zeroable};
use glam::Vec4;

use super::Contact;
use crate::{HostViews, Kernel, Scatter};

/// Moves the particles of contact `i`, and changes its multiplier: across the normal in x, y, z, along it in w. The one along the
/// normal never pulls; the one across it takes back what has slipped since the start of the (small) step, up to friction times the first. Reads
/// (contacts, mobility), writes q \[m\] and the multipliers: a constraint of XPBD. With inverse masses \[1/kg\] as mobility multipliers are
/// \[N s²\]; with one over what vertices resist with \[m/N\], forces.
///
/// A device may round otherwise: moves and multipliers differ by 10⁻⁵ of their size, and of that of A q.
#[derive(Debug)]
pub struct Hold;

/// Parameters of [`Hold`].
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct HoldUniform {
    /// How far a contact gives way, as part of what its particles would under the same multiplier \[1\].
    pub compliance: f32,
}

impl Kernel for Hold {
    const NAME: &'static str = "hold";
    const WGSL: &'static [&'static str] = &[super::WGSL, include_str!("hold.wgsl")];
    type Uniform = HoldUniform;
    type Inputs = (Contact, f32);
}

impl Scatter<4> for Hold {
    type State = Vec4;
    type Own = Vec4;

    fn scatter(
        i: u32,
        uniform: &HoldUniform,
        (contacts, mobility): HostViews<'_, Self>,
        q: &[Vec4],
        lambda: &mut Vec4,
    ) -> [Option<(u32, Vec4)>; 4] {
        let contact = &contacts[i as usize];
        let p = contact.particles.map(|p| p as usize);
        let a = contact.weights;
        let w = Vec4::from(p.map(|p| mobility[p])) * a;
        let softness = w.dot(a);
        if softness <= 0.0 {
            return [None; 4];
        }
        let compliance = uniform.compliance * softness;
        let scale = 1.0 / (softness + compliance);
        let aq = contact.apply(q);
        let held = lambda.truncate();
        let along = (lambda.w + scale * (contact.depth(aq) - compliance * lambda.w)).max(0.0);
        let mut across = held - (contact.slip(aq) + held * compliance) * scale;
        let (most, length) = (contact.friction * along, across.length());
        if length > most {
            across *= most / length;
        }
        let step = contact.normal * (along - lambda.w) + (across - held);
        *lambda = across.extend(along);
        std::array::from_fn(|slot| {
            let moved = contact.is_free(slot) && a[slot] != 0.0;
            moved.then(|| (contact.particles[slot], q[p[slot]] + (step * w[slot]).extend(0.0)))
        })
    }
}
