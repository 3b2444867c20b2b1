//! TetStrain.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use super::Constraint;

/// The rest data.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct TetStrain {
    /// Columns of A.
    pub columns: [[f32; 3]; 4],
    /// Weight.
    pub weight: f32,
}

impl Constraint<4, 3> for TetStrain {
    const NAME: &'static str = "tet_strain";
    #[inline]
    fn weight(&self) -> f32 {
        self.weight
    }
    #[inline]
    fn column(&self, slot: usize) -> [f32; 3] {
        self.columns[slot]
    }
    #[inline]
    fn project(&self, aq: [Vec3; 3]) -> [Vec3; 3] {
        aq
    }
}

impl TetStrain {
    /// Rest.
    pub fn rest(_x: [Vec3; 4], _k: f32) -> Option<Self> { None }
}
