//! Kernels of collisions: which primitives meet, contacts, their colors, what they do to positions, and the guard. One file each.
//!
//! A surface is an array of *primitives*: triangles, then edges, then vertices, each as four particles, the last of them repeated. Boxes
//! around their ways are the leaves of two trees, one over triangles and one over edges, eight children to a node, whose shape never
//! changes: it follows the surface at rest, and what is near there stays near. A *pair* is a point and the corners of a triangle, or the
//! ends of two edges, whose first particle then has the bit [`EDGES`].

mod bound;
mod claim_color;
mod contact_depth;
mod contact_energy;
mod deepest;
mod draw_color;
mod drift;
mod find_value;
mod hit;
mod hold;
mod keep_out;
mod meet;
mod meet_solid;
mod proximity;
mod push;
mod release_color;
mod settle_color;
mod shorten;
mod solid;
mod swept_box;
mod thin;
mod touch;

use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec4};

use crate::Shader;

pub use bound::{Bound, BoundUniform, CHILDREN};
pub use claim_color::{ClaimColor, ClaimColorUniform};
pub use contact_depth::ContactDepth;
pub use contact_energy::{ContactEnergy, ContactEnergyUniform};
pub use deepest::Deepest;
pub use draw_color::{ClaimUniform, DrawColor};
pub use drift::{Drift, DriftUniform};
pub use find_value::{FindValue, FindValueUniform};
pub use hit::{Hit, HitUniform};
pub use hold::{Hold, HoldUniform};
pub use keep_out::KeepOut;
pub use meet::{LEVELS, Meet, MeetUniform};
pub use meet_solid::MeetSolid;
pub use proximity::EDGES;
pub use push::{Push, PushUniform};
pub use release_color::ReleaseColor;
pub use settle_color::SettleColor;
pub use shorten::{Shorten, ShortenUniform};
pub use solid::{Solid, SolidShape};
pub use swept_box::{SweptBox, SweptBoxUniform};
pub use thin::{KeepThin, Thin};
pub use touch::{Touch, TouchUniform};

const WGSL: &str = include_str!("mod.wgsl");
const COLORS: &str = include_str!("colors.wgsl");

/// Colors of contacts.
pub const N_COLORS: u32 = 64;
/// No color.
pub const NO_COLOR: u32 = u32::MAX;

/// In [`Contact::free`]: its primitives are two edges.
pub const BETWEEN_EDGES: u32 = 1 << 4;

/// One contact, an inequality of positions q \[m\]: `normal · (Σ weights[k] · q[particles[k]] − origin) ≥ distance`.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Contact {
    /// A point, then a triangle's corners; or the ends of one edge, then of the other. Against a solid, the first four times.
    pub particles: [u32; 4],
    /// They add up to 0 between two primitives; (1, 0, 0, 0) against a solid \[1\].
    pub weights: Vec4,
    /// Unit vector towards the first side, or out of the solid \[1\].
    pub normal: Vec3,
    /// The least distance to be kept \[m\].
    pub distance: f32,
    /// Σ weights · q at the start of the (small) step, moved along with a solid \[m\].
    pub start: Vec3,
    /// Coulomb's coefficient \[1\].
    pub friction: f32,
    /// Point of a solid's surface at the end of the (small) step \[m\]; 0 between two primitives.
    pub origin: Vec3,
    /// A bit for each particle that is free to move, and [`BETWEEN_EDGES`].
    pub free: u32,
}

impl Contact {
    /// Σ weights · q \[m\], relative to the first particle where nothing would cancel.
    fn apply(&self, q: &[Vec4]) -> Vec3 {
        let x = self.particles.map(|p| q[p as usize].truncate());
        let w = self.weights;
        if w.y == 0.0 && w.z == 0.0 && w.w == 0.0 {
            return w.x * x[0];
        }
        w.y * (x[1] - x[0]) + w.z * (x[2] - x[0]) + w.w * (x[3] - x[0])
    }

    /// How much is missing of the distance \[m\].
    fn depth(&self, aq: Vec3) -> f32 {
        self.distance - self.normal.dot(aq - self.origin)
    }

    /// How far `aq` has slipped across the normal since the start of the (small) step \[m\].
    fn slip(&self, aq: Vec3) -> Vec3 {
        let moved = aq - self.start;
        moved - self.normal * self.normal.dot(moved)
    }

    fn is_free(&self, slot: usize) -> bool {
        self.free & (1 << slot) != 0
    }
}

/// Where `particle` keeps whether it has `color`: one of a power of two entries, `mask` + 1.
fn entry(particle: u32, color: u32, mask: u32) -> u32 {
    crate::pcg::pcg(particle.wrapping_mul(N_COLORS) + color) & mask
}

/// Every kernel of this module.
pub const SHADERS: [Shader; 21] = [
    Shader::update::<Bound>(),
    Shader::lower::<ClaimColor, 4>(),
    Shader::map::<ContactDepth>(),
    Shader::map::<ContactEnergy>(),
    Shader::lower::<Deepest, 1>(),
    Shader::map::<DrawColor>(),
    Shader::map::<Drift>(),
    Shader::expand::<FindValue>(),
    Shader::lower::<Hit, 9>(),
    Shader::scatter::<Hold, 4>(),
    Shader::map::<KeepOut>(),
    Shader::expand::<Meet>(),
    Shader::select::<MeetSolid>(),
    Shader::scatter::<Push, 4>(),
    Shader::map::<ReleaseColor>(),
    Shader::select::<SettleColor>(),
    Shader::select::<Shorten>(),
    Shader::map::<SweptBox>(),
    Shader::select::<KeepThin>(),
    Shader::scatter::<Thin, 1>(),
    Shader::expand::<Touch>(),
];
