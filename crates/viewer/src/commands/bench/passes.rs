//! The time of coarse passes, which the window makes while the camera moves.

use super::TimeRange;
use crate::commands::Failure;
use crate::progress::TerminalProgress;
use raycast_core::camera::Grid;
use raycast_core::render::{Cancel, Pass, View};
use serde::Serialize;
use std::time::{Duration, Instant};

/// The strides that are measured: of every ray, every 2nd one in both directions, and so on.
const STRIDES: [u32; 4] = [1, 2, 4, 8];

/// The measurements of passes of one stride.
#[derive(Debug, Serialize)]
pub(super) struct PassFigures {
    stride: u32,
    /// Visibility, shading, and the tiles with every pixel filled.
    ms: TimeRange,
}

/// Measures passes of a view, in turns, after one of each that warms up.
pub(super) fn measure(
    view: &View,
    frames: u32,
    progress: &TerminalProgress,
) -> Result<Vec<PassFigures>, Failure> {
    let plane = view.camera.plane();
    let tiles = Grid::default().tiles(plane.columns, plane.rows);
    let mut times = STRIDES.map(|_| Vec::new());
    for frame in 0..=frames {
        for (stride, times) in STRIDES.into_iter().zip(&mut times) {
            let pass = Pass { stride, samples: 1 };
            let clock = || Duration::ZERO;
            let started = Instant::now();
            let done =
                view.render_progressively(&tiles, &[pass], &clock, &Cancel::default(), &|_, _| ());
            let wall = started.elapsed();
            if !done {
                return Err(Failure::could_not("the render was stopped"));
            }
            if frame > 0 {
                times.push(wall);
            }
        }
        progress.done(1);
    }
    let figures = STRIDES.into_iter().zip(times);
    Ok(figures
        .map(|(stride, mut times)| PassFigures {
            stride,
            ms: TimeRange::from_times(&mut times),
        })
        .collect())
}
