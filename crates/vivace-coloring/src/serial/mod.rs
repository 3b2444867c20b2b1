//! First fit in its serial orders, DSATUR, and first fit in blocks. The serial ones are the oracles of everything else.

mod align;
mod blocked;
mod dsatur;
mod first_fit;

pub use blocked::blocked_first_fit;
pub use dsatur::dsatur;
pub(crate) use first_fit::Palette;
pub use first_fit::{Order, first_fit};
