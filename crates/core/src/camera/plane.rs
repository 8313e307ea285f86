/// The grid of rays that makes a picture: `columns × rows` of them, `step` apart in scene units at the camera's
/// target, centred on the view axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImagePlane {
    /// Rays in a row.
    pub columns: u32,
    /// Rows of rays.
    pub rows: u32,
    /// The distance between neighbouring rays.
    pub step: f64,
}

/// What stays when the step changes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FrameLock {
    /// The frame stays: half the step doubles the resolution.
    #[default]
    KeepFrame,
    /// The resolution stays: half the step halves the frame.
    KeepResolution,
}

/// The most columns or rows of a picture.
pub const SIDE_LIMIT: u32 = 65_536;

/// A request for an image plane: two of size, step and frame decide it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlaneRequest {
    /// Columns and rows.
    pub size: Option<(u32, u32)>,
    /// Ray spacing at the target, in scene units.
    pub step: Option<f64>,
    /// The frame's height at the target, in scene units: `2 · d · tan(fov / 2)`.
    pub frame_height: Option<f64>,
}

/// Why an image plane is invalid.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum PlaneError {
    /// A side of zero pixels, or of more than the limit.
    #[error("a picture of {columns}x{rows} cannot be made: each side must have 1 to 65536 pixels")]
    BadSize {
        /// The requested columns.
        columns: u64,
        /// The requested rows.
        rows: u64,
    },
    /// A step that is not a positive normal number.
    #[error("a step of {step:e} cannot be used: expected a positive number of at least 2.3e-308")]
    BadStep {
        /// The requested step.
        step: f64,
    },
    /// A frame height that is not a positive number.
    #[error(
        "a frame {height} high cannot be used: expected a positive number (a field of view above 0 and below 180 degrees)"
    )]
    BadFrame {
        /// The requested height.
        height: f64,
    },
    /// All three given, and inconsistent.
    #[error(
        "size, step and field of view (frame) are at odds: {rows} rows {step} apart make a frame {made} high, not {height}; give two of the three"
    )]
    AtOdds {
        /// The requested rows.
        rows: u32,
        /// The requested step.
        step: f64,
        /// The frame height that these make.
        made: f64,
        /// The requested frame height.
        height: f64,
    },
}

impl ImagePlane {
    /// A plane, checked.
    ///
    /// # Errors
    /// A side outside 1 to 65536, a step that [`check_step`] refuses.
    pub fn new(columns: u32, rows: u32, step: f64) -> Result<Self, PlaneError> {
        if columns.min(rows) == 0 || columns.max(rows) > SIDE_LIMIT {
            return Err(PlaneError::BadSize {
                columns: columns.into(),
                rows: rows.into(),
            });
        }
        check_step(step)?;
        Ok(Self {
            columns,
            rows,
            step,
        })
    }

    /// The frame's height in scene units at the target.
    pub fn frame_height(&self) -> f64 {
        f64::from(self.rows) * self.step
    }

    /// The same view with another step; `lock` says whether the frame or the resolution stays.
    ///
    /// # Errors
    /// As [`ImagePlane::new`].
    pub fn with_step(&self, step: f64, lock: FrameLock) -> Result<Self, PlaneError> {
        match lock {
            FrameLock::KeepResolution => Self::new(self.columns, self.rows, step),
            FrameLock::KeepFrame => PlaneRequest {
                size: None,
                step: Some(step),
                frame_height: Some(self.frame_height()),
            }
            .resolve((self.columns, self.rows), self.frame_height()),
        }
    }
}

/// Checks a step: a positive normal number of double precision. Subnormal numbers have fewer bits, and rays made of
/// them would be far from their exact places.
///
/// # Errors
/// Any other number.
pub fn check_step(step: f64) -> Result<(), PlaneError> {
    if step > 0.0 && step.is_normal() {
        Ok(())
    } else {
        Err(PlaneError::BadStep { step })
    }
}

impl PlaneRequest {
    /// The plane of a request: two of the three decide it; `default_size` and `default_frame` replace what is
    /// missing.
    ///
    /// With a step and a frame, the number of rows is rounded to an integer, the step is kept, and the default size
    /// gives the aspect ratio.
    ///
    /// # Errors
    /// A number out of range, or three that disagree by more than half a row.
    pub fn resolve(
        self,
        default_size: (u32, u32),
        default_frame: f64,
    ) -> Result<ImagePlane, PlaneError> {
        if let Some(step) = self.step {
            check_step(step)?;
        }
        let height = self.frame_height.unwrap_or(default_frame);
        if !(height.is_finite() && height > 0.0) {
            return Err(PlaneError::BadFrame { height });
        }
        match (self.size, self.step) {
            (Some((columns, rows)), Some(step)) => {
                let made = f64::from(rows) * step;
                if self.frame_height.is_some() && (made - height).abs() > 0.5 * step {
                    return Err(PlaneError::AtOdds {
                        rows,
                        step,
                        made,
                        height,
                    });
                }
                ImagePlane::new(columns, rows, step)
            }
            (None, Some(step)) => {
                let rows = (height / step).round().max(1.0);
                let aspect = f64::from(default_size.0) / f64::from(default_size.1.max(1));
                let columns = (rows * aspect).round().max(1.0);
                if rows.max(columns) > f64::from(SIDE_LIMIT) {
                    return Err(PlaneError::BadSize {
                        columns: columns as u64,
                        rows: rows as u64,
                    });
                }
                ImagePlane::new(columns as u32, rows as u32, step)
            }
            (size, None) => {
                let (columns, rows) = size.unwrap_or(default_size);
                ImagePlane::new(columns, rows, height / f64::from(rows.max(1)))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_of_three_decide() {
        let request = |size, step, frame_height| PlaneRequest {
            size,
            step,
            frame_height,
        };
        let resolve = |r: PlaneRequest| r.resolve((1280, 720), 2.0);
        assert_eq!(
            resolve(request(None, None, None)),
            ImagePlane::new(1280, 720, 2.0 / 720.0)
        );
        assert_eq!(
            resolve(request(Some((100, 50)), None, Some(5.0))),
            ImagePlane::new(100, 50, 0.1)
        );
        assert_eq!(
            resolve(request(Some((100, 50)), Some(0.5), None)),
            ImagePlane::new(100, 50, 0.5)
        );
        assert_eq!(
            resolve(request(None, Some(0.01), Some(1.0))),
            ImagePlane::new(178, 100, 0.01)
        );
        assert!(resolve(request(Some((100, 50)), Some(0.1), Some(5.0))).is_ok());
        assert!(matches!(
            resolve(request(Some((100, 50)), Some(0.2), Some(5.0))),
            Err(PlaneError::AtOdds { .. })
        ));
        assert!(matches!(
            resolve(request(Some((0, 5)), None, None)),
            Err(PlaneError::BadSize { .. })
        ));
        assert!(matches!(
            resolve(request(None, Some(f64::NAN), None)),
            Err(PlaneError::BadStep { .. })
        ));
        for step in [1e-320, 0.0, -1.0, f64::INFINITY] {
            let refused = resolve(request(Some((4, 4)), Some(step), None));
            assert_eq!(refused, Err(PlaneError::BadStep { step }));
        }
        assert_eq!(
            PlaneError::BadStep { step: 1e-320 }.to_string(),
            "a step of 1e-320 cannot be used: expected a positive number of at least 2.3e-308"
        );
        assert!(matches!(
            resolve(request(None, Some(1e-9), None)),
            Err(PlaneError::BadSize { .. })
        ));
    }

    #[test]
    fn the_lock_says_what_follows_the_step() {
        let plane = ImagePlane::new(160, 90, 0.1).expect("a good plane");
        let denser = plane
            .with_step(0.05, FrameLock::KeepFrame)
            .expect("a good step");
        assert_eq!((denser.columns, denser.rows), (320, 180));
        assert!((denser.frame_height() - plane.frame_height()).abs() < 1e-12);
        let nearer = plane
            .with_step(0.05, FrameLock::KeepResolution)
            .expect("a good step");
        assert_eq!((nearer.columns, nearer.rows), (160, 90));
        assert!((nearer.frame_height() - plane.frame_height() / 2.0).abs() < 1e-12);
    }
}
