//! Size, step and frame: two of the three determine the third.

use super::viewpoint::fov_range;
use super::{Resolution, State, TILES_LIMIT, WINDOW_PIXELS};
use raycast_core::camera::{FrameLock, Grid, ImagePlane, Projection};

/// Sets the step; the lock says whether resolution or frame follows.
pub(super) fn set_step(state: &mut State, step: f64) {
    let Ok(plane) = state.plane() else {
        return;
    };
    match plane.with_step(step, state.lock) {
        Ok(next) => take_plane(state, plane, next),
        Err(error) => state.report(error.to_string()),
    }
}

/// Multiplies the step.
pub(super) fn scale_step(state: &mut State, factor: f64) {
    match (state.lock, state.resolution) {
        // The density changes without rounding, so that the inverse factor restores it.
        (FrameLock::KeepFrame, Resolution::Window { density }) if factor.is_normal() => {
            let least = 1.0 / f64::from(state.viewport.0.min(state.viewport.1).max(1));
            let density = (density / factor).max(least);
            set_resolution(state, Resolution::Window { density });
        }
        _ => {
            if let Ok(plane) = state.plane() {
                set_step(state, plane.step * factor);
            }
        }
    }
}

/// Sets the picture's plane.
fn take_plane(state: &mut State, last: ImagePlane, next: ImagePlane) {
    if (last.columns, last.rows) != (next.columns, next.rows) {
        let resolution = match state.resolution {
            Resolution::Window { .. } => Resolution::Window {
                density: f64::from(next.rows) / f64::from(state.viewport.1.max(1)),
            },
            Resolution::Fixed(..) => Resolution::Fixed(next.columns, next.rows),
        };
        if !set_resolution(state, resolution) {
            return;
        }
    }
    set_frame(state, next.frame_height());
}

/// Sets the frame's height at the target, by the field of view or the orthographic scale.
pub(super) fn set_frame(state: &mut State, height: f64) {
    if !(height.is_normal() && height > 0.0) {
        return;
    }
    match state.viewpoint.projection {
        projection @ (Projection::Perspective | Projection::Panoramic(_)) => {
            let (narrowest, widest) = fov_range(projection);
            state.viewpoint.fov = projection
                .fov_degrees(height, state.viewpoint.orbit.distance)
                .clamp(narrowest, widest);
        }
        Projection::Orthographic => {
            let now = state.frame_height();
            state.viewpoint.orbit.distance *= height / now;
        }
    }
}

/// Sets a resolution if the window can show it; shows a message if not.
pub(super) fn set_resolution(state: &mut State, resolution: Resolution) -> bool {
    let (columns, rows) = match resolution {
        Resolution::Fixed(columns, rows) => (f64::from(columns), f64::from(rows)),
        Resolution::Window { density } => (
            f64::from(state.viewport.0) * density,
            f64::from(state.viewport.1) * density,
        ),
    };
    let limit = state.side_limit;
    if columns.max(rows) > f64::from(limit) || columns * rows > WINDOW_PIXELS as f64 {
        state.report(format!(
            "A picture of {columns:.0}×{rows:.0} is more than the window shows ({limit} a \
                 side, {} megapixels); `raycast render --size` makes larger ones.",
            WINDOW_PIXELS >> 20
        ));
        return false;
    }
    state.resolution = resolution;
    state.grid = limited(state.grid, state.size());
    true
}

/// Limits a grid to the number of tiles that the window can handle.
pub(super) fn limited(grid: Grid, (columns, rows): (u32, u32)) -> Grid {
    match grid {
        Grid::Size(size) => {
            let pixels = u64::from(columns) * u64::from(rows);
            let least = (pixels.div_ceil(TILES_LIMIT) as f64).sqrt().ceil() as u32;
            Grid::Size(size.max(least).max(4))
        }
        Grid::Count {
            columns: across,
            rows: down,
        } => Grid::Count {
            columns: across.clamp(1, 256),
            rows: down.clamp(1, 256),
        },
    }
}
