//! TriangleStrain.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use super::Constraint;

/// The rest data.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct TriangleStrain {
    /// Columns of A.
    pub columns: [[f32; 2]; 3],
    /// Weight.
    pub weight: f32,
}

impl Constraint<3, 2> for TriangleStrain {
    const NAME: &'static str = "triangle_strain";
    #[inline]
    fn weight(&self) -> f32 {
        self.weight
    }
    #[inline]
    fn column(&self, slot: usize) -> [f32; 2] {
        self.columns[slot]
    }
    #[inline]
    fn project(&self, aq: [Vec3; 2]) -> [Vec3; 2] {
        aq
    }
}

impl TriangleStrain {
    /// Rest.
    pub fn rest(_x: [Vec3; 3], _k: f32, _limit: f32) -> Option<Self> { None }
}
