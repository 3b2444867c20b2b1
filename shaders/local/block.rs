//! The blocks of the Hessian of a particle's constraints.

use std::marker::PhantomData;

use glam::{Vec3, Vec4};

use super::{CORNERS, corners, join, row};
use crate::constraint::Constraint;
use crate::{HostViews, Kernel, Map};

/// Adds by how much the blocks of the constraints of kind `C` at particle `i` differ from their part in Y \[N/m\]: the entries
/// (xx, yy, zz) and (yz, zx, xy); reads (offsets, slots, particles, rest data, q).
///
/// A device may round otherwise: entries differ by 10⁻⁵ of the diagonal of Y.
#[derive(Debug)]
pub struct Block<C, const N: usize, const R: usize>(PhantomData<C>);

impl<C: Constraint<N, R>, const N: usize, const R: usize> Kernel for Block<C, N, R> {
    const NAME: &'static str = "block";
    const WGSL: &'static [&'static str] = &join::<C, N, R>(&[CORNERS, include_str!("block.wgsl")]);
    type Uniform = ();
    type Inputs = (u32, u32, [u32; N], C, Vec4);
}

impl<C: Constraint<N, R>, const N: usize, const R: usize> Map for Block<C, N, R> {
    type Output = [Vec4; 2];

    #[inline]
    fn map(i: u32, (): &(), (offsets, slots, particles, rest, q): HostViews<'_, Self>, own: &mut [Vec4; 2]) {
        let [mut diagonal, mut off] = own.map(Vec4::truncate);
        for (k, slot) in row::<N>(i, offsets, slots) {
            let block = rest[k].block(&corners(k, particles, q), slot);
            let [x, y, z] = [block.x_axis, block.y_axis, block.z_axis];
            diagonal += Vec3::new(x.x, y.y, z.z) - Vec3::splat(rest[k].entry(slot, slot));
            off += Vec3::new(y.z, z.x, x.y);
        }
        *own = [diagonal.extend(0.0), off.extend(0.0)];
    }
}
