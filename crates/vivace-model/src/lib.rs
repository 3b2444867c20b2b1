//! What is simulated: particles with masses, and the constraints between them ([`Model`]); where they are and how they move
//! ([`State`]). Nothing here knows how it is solved.
//!
//! A model does not change while it is simulated, but for what is held or torn; a state does. SI units throughout: \[m\], \[kg\], \[s\], \[N\].

mod builder;
mod constraints;
mod error;
mod forces;
mod model;
mod state;
mod tear;
mod time_step;

pub use builder::ModelBuilder;
pub use constraints::{Constraints, KindVisitor, KindVisitorMut, Store};
pub use error::ModelError;
pub use forces::{Forces, Wind};
pub use model::Model;
pub use state::State;
pub use tear::{Tear, TearLimit};
pub use time_step::check_time_step;
