//! What acts on a particle from outside: gravity and wind, as `Wind` of the model has it.
//!
//! D sums `drag` · area / 3 · (0.1 I + 0.9 n nᵀ) over the particle's triangles; its acceleration by the wind, at the end of the
//! prediction, is a of (I + h D/m) a = D/m (w − v − h g).

use bytemuck::{Pod, Zeroable};
use glam::{Vec3, Vec4};

use crate::{HostViews, Kernel, Map};

/// The acceleration of particle `i` \[m/s²\]; reads (offsets, corners of the triangles of each particle, positions \[m\], velocities
/// \[m/s\]).
///
/// A device may round otherwise: 10⁻⁵ of the acceleration, more where h D/m is far above 1 and triangles are edge on.
#[derive(Debug)]
pub struct Blow;

/// Parameters of [`Blow`].
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct BlowUniform {
    /// Acceleration of every particle \[m/s²\].
    pub gravity: Vec3,
    /// The time step \[s\].
    pub h: f32,
    /// Velocity of the air \[m/s\].
    pub velocity: Vec3,
    /// A sixth of the drag \[kg/(m² s)\]: a corner's part, by twice the area.
    pub sixth_of_drag: f32,
    /// Drag along a triangle, as a share of that across it \[1\].
    pub skin: f32,
    /// WGSL pads to whole vectors.
    pub padding: [u32; 3],
}

impl Kernel for Blow {
    const NAME: &'static str = "blow";
    const WGSL: &'static [&'static str] = &[
        include_str!("../common/vec3.wgsl"),
        include_str!("../pd/symmetric.wgsl"),
        include_str!("blow.wgsl"),
    ];
    type Uniform = BlowUniform;
    type Inputs = (u32, [u32; 3], Vec4, Vec4);
}

impl Map for Blow {
    type Output = Vec4;

    #[inline]
    fn map(i: u32, uniform: &BlowUniform, (offsets, corners, q, v): HostViews<'_, Self>, own: &mut Vec4) {
        let at = i as usize;
        *own = uniform.gravity.extend(0.0);
        let (mut diagonal, mut off) = (Vec3::ZERO, Vec3::ZERO);
        for corners in &corners[offsets[at] as usize..offsets[at + 1] as usize] {
            let [a, b, c] = corners.map(|corner| q[corner as usize].truncate());
            let twice_area = (b - a).cross(c - a);
            let length = twice_area.dot(twice_area).sqrt();
            if length > 0.0 {
                let n = twice_area / length;
                let third = uniform.sixth_of_drag * length;
                let across = third * (1.0 - uniform.skin);
                diagonal += n * n * across + Vec3::splat(third * uniform.skin);
                off += Vec3::new(n.y * n.z, n.z * n.x, n.x * n.y) * across;
            }
        }
        let w = q[at].w;
        if w > 0.0 && diagonal != Vec3::ZERO {
            let (diagonal, off) = (diagonal * w, off * w);
            let relative = uniform.velocity - (v[at].truncate() + uniform.h * uniform.gravity);
            let push = crate::pd::multiplied(diagonal, off, relative);
            let (diagonal, off) = (diagonal * uniform.h + Vec3::ONE, off * uniform.h);
            *own += crate::pd::solved(diagonal, off, push, Vec3::ZERO).extend(0.0);
        }
    }
}
