//! Kernels around the solve, over vectors: lines 1 and 9 of Algorithm 1, earlier positions, sums. One file each.
//!
//! A vector is (x, y, z, w). Positions have the inverse mass \[1/kg\] for w, 0 where pinned.

mod blow;
mod copy_vector;
mod copy_vector_where;
mod decide;
mod extrapolate;
mod pick_weight;
mod place;
mod predict;
mod set_vector;
mod squared_distance;
mod squared_length;
mod sum;
mod update_velocity;

use crate::Shader;
use crate::constraint::Xpbd;
use crate::pd::Omega;

pub use blow::{Blow, BlowUniform};
pub use copy_vector::CopyVector;
pub use copy_vector_where::{CopyVectorWhere, CopyVectorWhereUniform};
pub use decide::{Decide, DecideUniform, Watch};
pub use extrapolate::{Extrapolate, ExtrapolateUniform};
pub use pick_weight::{PickWeight, PickWeightUniform, Weight};
pub use place::Place;
pub use predict::{Predict, PredictUniform};
pub use set_vector::{SetVector, SetVectorUniform};
pub use squared_distance::SquaredDistance;
pub use squared_length::SquaredLength;
pub use sum::{BLOCK, Sum, SumUniform};
pub use update_velocity::{UpdateVelocity, UpdateVelocityUniform};

const WATCH: &str = include_str!("watch.wgsl");

/// Every kernel of this module.
pub const SHADERS: [Shader; 15] = [
    Shader::map::<Blow>(),
    Shader::map::<CopyVector>(),
    Shader::map::<CopyVectorWhere>(),
    Shader::map::<Decide>(),
    Shader::map::<Extrapolate>(),
    Shader::update::<Place>(),
    Shader::map::<PickWeight<Omega>>(),
    Shader::map::<PickWeight<ExtrapolateUniform>>(),
    Shader::map::<PickWeight<Xpbd>>(),
    Shader::map::<Predict>(),
    Shader::map::<SetVector>(),
    Shader::map::<SquaredDistance>(),
    Shader::map::<SquaredLength>(),
    Shader::map::<Sum>(),
    Shader::map::<UpdateVelocity>(),
];
