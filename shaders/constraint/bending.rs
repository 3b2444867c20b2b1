//! Bending.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use super::Constraint;

/// The rest data.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Bending {
    /// Columns of A.
    pub columns: [[f32; 1]; 4],
    /// Weight.
    pub weight: f32,
}

impl Constraint<4, 1> for Bending {
    const NAME: &'static str = "bending";
    #[inline]
    fn weight(&self) -> f32 {
        self.weight
    }
    #[inline]
    fn column(&self, slot: usize) -> [f32; 1] {
        self.columns[slot]
    }
    fn is_linear(&self) -> bool { true }
    #[inline]
    fn project(&self, aq: [Vec3; 1]) -> [Vec3; 1] {
        let _ = aq;
        [Vec3::ZERO]
    }
}

impl Bending {
    /// Rest.
    pub fn rest(x: [Vec3; 4], k: f32) -> Option<Self> { Self::flat(x, k) }
    /// Flat.
    pub fn flat(x: [Vec3; 4], k: f32) -> Option<Self> {
        let x = x.map(|x| x.as_dvec3());
        let cot = |a: glam::DVec3, b: glam::DVec3| a.dot(b) / a.cross(b).length();
        let (e0, e1, e2, e3, e4) = (x[1] - x[0], x[2] - x[0], x[3] - x[0], x[2] - x[1], x[3] - x[1]);
        let (c1, c2, c3, c4) = (cot(e0, e1), cot(e0, e2), cot(-e0, e3), cot(-e0, e4));
        let area = 0.5 * (e0.cross(e1).length() + e0.cross(e2).length());
        let row = [c3 + c4, c1 + c2, -c1 - c3, -c2 - c4].map(|c| [c as f32]);
        Some(Self { columns: row, weight: (f64::from(k) * 3.0 / area) as f32 })
    }
}
