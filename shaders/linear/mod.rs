//! Kernels that solve `Y δ = r`, x, y and z at once: preconditioned conjugate gradients (Hestenes and Stiefel 1952), and substitution
//! with a factor. One file each.
//!
//! Scalars stay where the vectors are: dot products are sums in a fixed order, and whoever takes a step reads its length there.

mod add_scaled;
mod divide;
mod dot;
mod find_scalars;
mod multiply;
mod pick;
mod substitute;
mod sum_pairs;
mod sweep;
mod turn;

use crate::Shader;

pub use add_scaled::{AddScaled, AddScaledUniform};
pub use divide::Divide;
pub use dot::Dot;
pub use find_scalars::{FindScalars, FindScalarsUniform, Scalars};
pub use multiply::Multiply;
pub use pick::{Pick, PickUniform};
pub use substitute::{Substitute, SubstituteUniform};
pub use sum_pairs::SumPairs;
pub use sweep::{Sweep, SweepUniform};
pub use turn::Turn;

const PAIR: &str = include_str!("pair.wgsl");
const SCALARS: &str = include_str!("scalars.wgsl");

/// Every kernel of this module.
pub const SHADERS: [Shader; 10] = [
    Shader::map::<AddScaled>(),
    Shader::map::<Divide>(),
    Shader::map::<Dot>(),
    Shader::map::<FindScalars>(),
    Shader::map::<Multiply>(),
    Shader::map::<Pick>(),
    Shader::update::<Substitute>(),
    Shader::map::<SumPairs>(),
    Shader::update::<Sweep>(),
    Shader::map::<Turn>(),
];
