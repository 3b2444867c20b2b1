//! A particle's own block of the Hessian, springs exactly.

use glam::{Vec3, Vec4};

use super::{Row, SpringTap, Tap, VEC3, WGSL, guarded};
use crate::{HostViews, Kernel, Map};

/// The block of particle `i` \[N/m\]: that of Y, with k (u uᵀ + across (I − u uᵀ)) in place of k I for its springs, to which passes add
/// by how much theirs differ; its diagonal and its entries yz, zx, xy; reads (rows, taps, springs, q).
#[derive(Debug)]
pub struct SpringBlock;

impl Kernel for SpringBlock {
    const NAME: &'static str = "spring_block";
    const WGSL: &'static [&'static str] = &[VEC3, WGSL, include_str!("spring_block.wgsl")];
    type Uniform = ();
    type Inputs = (Row, Tap, SpringTap, Vec4);
}

impl Map for SpringBlock {
    type Output = [Vec4; 2];

    #[inline]
    fn map(i: u32, (): &(), (rows, taps, springs, q): HostViews<'_, Self>, own: &mut [Vec4; 2]) {
        let (row, at) = (&rows[i as usize], q[i as usize].truncate());
        let mut isotropic = 1.0 / row.inverse_diagonal;
        let (mut diagonal, mut off) = (Vec3::ZERO, Vec3::ZERO);
        for e in row.entries(0, row.n_springs) {
            let d = q[taps[e].column as usize].truncate() - at;
            let (spring, squared) = (springs[e], guarded(d.length_squared()));
            let across = (spring.stiffness - spring.pull / squared.sqrt()).max(0.0);
            isotropic += across - spring.stiffness;
            let scaled = d * ((spring.stiffness - across) / squared);
            diagonal += scaled * d;
            off += Vec3::new(scaled.y * d.z, scaled.z * d.x, scaled.x * d.y);
        }
        *own = [(diagonal + Vec3::splat(isotropic)).extend(0.0), off.extend(0.0)];
    }
}
