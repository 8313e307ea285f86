//! The truth about rays and triangles, by exact arithmetic.
//!
//! It is independent of the code that it checks: it takes plain values, uses another big-number library, and decides
//! exactly every triangle that a proven bound in double precision does not exclude.
//!
//! - [`oracle`]: the closest triangle that a ray hits, and how it hits a given one.
//! - [`random`]: pseudorandom numbers for queries, the same on every machine.

mod exact;
mod filter;
mod half_space;
mod hit;
pub mod oracle;
pub mod random;
mod ray;
mod tree;
mod triangle;
mod truth;

pub use half_space::HalfSpace;
pub use oracle::Oracle;
pub use ray::Ray;
pub use triangle::Triangle;
pub use truth::Truth;
