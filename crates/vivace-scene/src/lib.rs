//! Scenes as data: bodies, what they are made of, how they are held, and what acts on them; in RON and JSON files.
//!
//! ```
//! use vivace_scene::Scene;
//!
//! let text = r#"(
//!     bodies: [(
//!         shape: Cloth(width: 20, height: 20, spacing: 0.05),
//!         material: Cloth(density: 0.2, springs: 100.0),
//!         pins: [Nearest((0, 0, 0)), Nearest((0.95, 0, 0))],
//!     )],
//! )"#;
//! let (model, state) = Scene::from_ron(text)?.build(".".as_ref())?;
//! assert_eq!((model.n_particles(), state.positions.len()), (400, 400));
//! # Ok::<(), vivace_scene::SceneError>(())
//! ```
//!
//! SI units throughout: \[m\], \[kg\], \[s\], \[N\]; y is up. What is left out of a file has its default; what a file has too much is refused.

mod body;
mod collisions;
mod drag;
mod error;
mod material;
mod ready;
mod scene;
mod select;
mod shape;

pub use body::{Attach, Body};
pub use collisions::{Collisions, Obstacle, ObstacleError, Solid};
pub use drag::{Between, Drag, Hold, Key, Path, PathError, Pose};
pub use error::{BodyError, SceneError};
pub use material::{Bending, ClothStrain, Material, VolumeStiffness};
pub use ready::{armadillo, beam, curtain, drape, flag, heap, noodles, pinch, stack, tablecloth};
pub use scene::{Built, Held, Scene};
pub use select::Select;
pub use shape::{Pattern, Shape, Source};
pub use vivace_model::{Forces, Model, State, TearLimit, Wind};
