//! How much a report measures.

use raycast_core::Simd;

/// Sizes and counts that trade a report's precision for its time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReportBudget {
    /// Columns and rows of the pictures that are timed.
    pub size: (u32, u32),
    /// Measurements of each timed task.
    pub rounds: usize,
    /// Rays per mesh that are compared with the oracle.
    pub checked: usize,
    /// The most ray–triangle tests that brute force may take for one measurement.
    pub tests: usize,
    /// Variants of each hard case.
    pub variants: usize,
    /// Cameras of each variant of a hard case.
    pub cameras: usize,
    /// Rays of each variant of a hard case: this many free rays, and this many camera rays.
    pub hard: usize,
    /// Rays at each position of the plots that show where casters break.
    pub breaking: usize,
    /// Triangles of the largest mesh in the plots of speed.
    pub largest: u32,
    /// Samples per pixel of the reference picture.
    pub samples: u32,
    /// Columns and rows of the pictures that are compared with the reference.
    pub compared: (u32, u32),
    /// The widest instruction set for packets, if the machine has it.
    pub simd: Simd,
}

impl ReportBudget {
    /// Some minutes on two cores.
    pub const FULL: Self = Self {
        size: (1280, 720),
        rounds: 5,
        checked: 100_000,
        tests: 30_000_000,
        variants: 2,
        cameras: 2,
        hard: 1_000,
        breaking: 16_384,
        largest: 1_000_000,
        samples: 256,
        compared: (640, 360),
        simd: Simd::Avx2,
    };

    /// Some seconds: only checks that the report works.
    pub const QUICK: Self = Self {
        size: (320, 180),
        rounds: 2,
        checked: 2_000,
        tests: 2_000_000,
        variants: 1,
        cameras: 1,
        hard: 60,
        breaking: 500,
        largest: 20_000,
        samples: 256,
        compared: (160, 90),
        simd: Simd::Avx2,
    };
}
