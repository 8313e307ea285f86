//! RayCast's speed against its error: hard cases, other ways of casting, measurements, plots.
//!
//! - [`stage`]: a scene, its tree, and the truth about it.
//! - [`fault`]: in what an answer is not the truth.
//! - [`cases`]: where known ray casters go wrong.
//! - [`meshes`], [`cameras`]: made in code.
//! - [`embree`]: Embree, where the machine has it.

pub mod cameras;
pub mod cases;
pub mod embree;
pub mod fault;
pub mod meshes;
pub mod stage;

pub use fault::Fault;
pub use stage::Stage;
