//! One projection of each contact of a color: C = n · (A q − origin) − distance ≥ 0, with Coulomb's friction.
//!
//! Where multipliers are impulses that inertia alone resists, friction is one of them, up to the coefficient times that along the normal. Where they are
//! forces on a vertex that others hold, too, that would stop a body at once, for as many sweeps as it is stiff: the first depths are those of
//! what was predicted. There friction takes back of the way that was predicted what its force could, as [`crate::constraint::Contact`] has it.

use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec4};

use super::Contact;
use crate::{HostViews, Kernel, Scatter};

/// Moves the particles of contact `i`, and changes its multiplier: across the normal in x, y, z, along it in w. The one along the normal never pulls; the one
/// across it takes back what has slipped since the start of the frame, up to friction times the first. Reads (contacts, mobility: how far
/// a multiplier of 1 moves each particle), writes q \[m\] and the multipliers.
///
/// With inverse masses \[1/kg\] for mobilities this is a constraint of XPBD, and multipliers are in N s². With one over the diagonal of Y \[m/N\] it
/// solves a contact and its particles together, all others standing still, and multipliers are forces \[N\].
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
    /// Relaxation; beyond 1 there is nothing to be gained.
    pub omega: f32,
    /// A [`Friction`].
    pub friction: u32,
    /// The time step, squared \[s²\]: for [`Friction::Reach`].
    pub squared_h: f32,
}

/// What friction does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum Friction {
    /// Nothing yet.
    None = 0,
    /// A multiplier, up to the coefficient times that along the normal.
    Multiplier = 1,
    /// A bound of how far may be slipped: as far as predicted, less what the force takes back.
    Reach = 2,
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
        let w = Vec4::new(mobility[p[0]], mobility[p[1]], mobility[p[2]], mobility[p[3]]) * a;
        let softness = w.dot(a);
        if softness <= 0.0 {
            return [None; 4];
        }
        let compliance = uniform.compliance * softness;
        let scale = uniform.omega.min(1.0) / (softness + compliance);
        let aq = contact.apply(q);
        let along = (lambda.w + scale * (contact.depth(aq) - compliance * lambda.w)).max(0.0);
        let held = lambda.truncate();
        let slip = contact.slip(aq);
        let mut across = Vec3::ZERO;
        if uniform.friction == Friction::Multiplier as u32 {
            across = held - (slip + held * compliance) * scale;
            let (most, length) = (contact.friction * along, across.length());
            if length > most {
                across *= most / length;
            }
        } else if uniform.friction == Friction::Reach as u32 && along > 0.0 && contact.friction > 0.0 {
            let taken = contact.friction * along * contact.inverse_mass * uniform.squared_h;
            let reach = (contact.ahead - taken).max(0.0);
            // Where it would be if nothing were held.
            let free = slip - held * softness;
            let length = free.length();
            if length > reach {
                across = free * ((reach / length - 1.0) / (softness + compliance));
            }
            across = held + (across - held) * uniform.omega.min(1.0);
        }
        let step = contact.normal * (along - lambda.w) + (across - held);
        *lambda = across.extend(along);
        std::array::from_fn(|slot| {
            let moved = contact.is_free(slot) && a[slot] != 0.0;
            moved.then(|| (contact.particles[slot], q[p[slot]] + (step * w[slot]).extend(0.0)))
        })
    }
}

/// The multiplier as a vector.
pub(super) fn vector(contact: &Contact, lambda: Vec4) -> Vec3 {
    contact.normal * lambda.w + lambda.truncate()
}
