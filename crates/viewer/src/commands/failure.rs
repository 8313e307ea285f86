use raycast_core::camera::{PlacementError, PlaneError};
use raycast_core::formats::FormatError;
use raycast_core::image::{FragmentError, ImageError};
use raycast_core::scene::SceneError;
use std::fmt;
use std::process::ExitCode;

/// Why a command was not done; shown as one line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Failure {
    /// What was asked for makes no sense: exit status 2.
    Usage(String),
    /// It could not be done: exit status 1.
    CouldNot(String),
}

impl Failure {
    /// Bad usage.
    pub fn usage(message: impl Into<String>) -> Self {
        Self::Usage(message.into())
    }

    /// Could not.
    pub fn could_not(message: impl Into<String>) -> Self {
        Self::CouldNot(message.into())
    }

    /// The exit status that says so.
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Self::Usage(_) => ExitCode::from(2),
            Self::CouldNot(_) => ExitCode::FAILURE,
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (Self::Usage(message) | Self::CouldNot(message)) = self;
        for (index, line) in message.lines().enumerate() {
            if index > 0 {
                f.write_str(" ")?;
            }
            f.write_str(line.trim())?;
        }
        Ok(())
    }
}

impl std::error::Error for Failure {}

impl From<PlaneError> for Failure {
    fn from(error: PlaneError) -> Self {
        Self::Usage(error.to_string())
    }
}

impl From<PlacementError> for Failure {
    fn from(error: PlacementError) -> Self {
        Self::Usage(error.to_string())
    }
}

impl From<FormatError> for Failure {
    fn from(error: FormatError) -> Self {
        Self::CouldNot(error.to_string())
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        Self::CouldNot(error.to_string())
    }
}

impl From<ImageError> for Failure {
    fn from(error: ImageError) -> Self {
        match error {
            ImageError::UnknownFormat { .. } | ImageError::NotForFragments => {
                Self::Usage(error.to_string())
            }
            _ => Self::CouldNot(error.to_string()),
        }
    }
}

impl From<FragmentError> for Failure {
    fn from(error: FragmentError) -> Self {
        Self::CouldNot(error.to_string())
    }
}
