//! RayCast's speed against its error: hard cases, other casters, measurements, plots.
//!
//! - [`stage`]: a scene, its tree, and the truth about it.
//! - [`wrong_answer`], [`errors`]: in what an answer is not the truth, and what a caster answered to many rays.
//! - [`verify`]: pictures against the truth.
//! - [`known_answers`]: rays with the truth about them.
//! - [`cases`]: where known ray casters go wrong.
//! - [`fuzz_kernel`]: tiles, single rays and the truth, on what a fuzzer's bytes say.
//! - [`meshes`], [`cameras`], [`scenes`]: made in code.
//! - [`casters`]: RayCast's casters and other people's, behind one trait; [`embree`] is loaded
//!   at run time.
//! - [`mod@report`]: everything measured and written down, in [`sections`]; [`budget`] says how much,
//!   [`subject`] at what, [`views`] from where, [`machine`] on what, [`progress`] how far it is.
//! - [`metrics`]: how far a picture is from another.
//! - [`timing`], [`pareto`]: what is typical of times, and what is best of two kinds.
//! - [`chart`], [`table`], [`figure`]: plots, numbers, drawings in space.

pub mod budget;
pub mod cameras;
pub mod cases;
pub mod casters;
#[allow(clippy::disallowed_methods, reason = "a plot is no picture of a scene")]
pub mod chart;
pub mod embree;
pub mod errors;
mod expected;
pub mod figure;
pub mod fuzz_kernel;
pub mod known_answers;
pub mod machine;
pub mod meshes;
#[allow(clippy::disallowed_methods, reason = "figures are shown to few digits")]
pub mod metrics;
pub mod pareto;
pub mod progress;
pub mod report;
mod sample_places;
pub mod scenes;
pub mod sections;
pub mod stage;
pub mod subject;
#[allow(clippy::disallowed_methods, reason = "figures are shown to few digits")]
pub mod table;
#[allow(clippy::disallowed_methods, reason = "figures are shown to few digits")]
pub mod timing;
pub mod verify;
pub mod views;
pub mod wrong_answer;

pub use budget::ReportBudget;
pub use progress::ReportProgress;
pub use report::report;
pub use stage::Stage;
pub use subject::Input;
pub use table::ReportError;
pub use wrong_answer::WrongAnswer;
