//! RayCast's speed against its error: hard cases, other ways of casting, measurements, plots.
//!
//! - [`stage`]: a scene, its tree, and the truth about it.
//! - [`fault`], [`errors`]: in what an answer is not the truth, and what a way answered to many rays.
//! - [`verify`]: pictures against the truth.
//! - [`checked`]: rays with the truth about them.
//! - [`cases`]: where known ray casters go wrong.
//! - [`fuzz_kernel`]: tiles, single rays and the truth, on what a fuzzer's bytes say.
//! - [`meshes`], [`cameras`], [`scenes`]: made in code.
//! - [`ways`]: RayCast's ways of casting and other people's, behind one trait; [`embree`] is loaded
//!   at run time.
//! - [`mod@report`]: everything measured and written down, in [`sections`]; [`effort`] says how much,
//!   [`subject`] at what, [`views`] from where, [`machine`] on what, [`watch`] how far it is.
//! - [`metrics`]: how far a picture is from another.
//! - [`timing`], [`pareto`]: what is typical of times, and what is best of two kinds.
//! - [`chart`], [`table`], [`figure`]: plots, numbers, drawings in space.

pub mod cameras;
pub mod cases;
pub mod chart;
pub mod checked;
pub mod effort;
pub mod embree;
pub mod errors;
pub mod fault;
pub mod figure;
pub mod fuzz_kernel;
pub mod machine;
pub mod meshes;
pub mod metrics;
pub mod pareto;
pub mod report;
pub mod scenes;
pub mod sections;
pub mod stage;
pub mod subject;
pub mod table;
pub mod timing;
pub mod verify;
pub mod views;
pub mod watch;
pub mod ways;

pub use effort::Effort;
pub use fault::Fault;
pub use report::report;
pub use stage::Stage;
pub use subject::Input;
pub use table::ReportError;
pub use watch::Watch;
