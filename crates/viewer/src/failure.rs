//! Failures of commands.

use raycast_core::camera::{PlaneError, PoseError};
use raycast_core::formats::FormatError;
use raycast_core::picture::{FragmentError, ImageError, OutOfMemory};
use raycast_core::scene::SceneError;
use std::error::Error;
use std::fmt;
use std::process::ExitCode;
use std::sync::Arc;

/// Why a command failed; displayed as one line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Failure {
    /// Bad usage: exit status 2.
    Usage(Reason),
    /// The command could not be completed: exit status 1.
    CouldNot(Reason),
}

/// The message of a failure, and the error that caused it, if any. Two are equal if their messages are.
#[derive(Clone, Debug)]
pub struct Reason {
    message: String,
    source: Option<Arc<dyn Error + Send + Sync>>,
}

impl Reason {
    /// An error, with its own message.
    pub fn of(error: impl Error + Send + Sync + 'static) -> Self {
        Self {
            message: error.to_string(),
            source: Some(Arc::new(error)),
        }
    }
}

impl PartialEq for Reason {
    fn eq(&self, other: &Self) -> bool {
        self.message == other.message
    }
}

impl Eq for Reason {}

impl From<String> for Reason {
    fn from(message: String) -> Self {
        Self {
            message,
            source: None,
        }
    }
}

impl Failure {
    /// Bad usage, with this message.
    pub fn usage(message: impl Into<String>) -> Self {
        Self::Usage(message.into().into())
    }

    /// A failure with this message.
    pub fn could_not(message: impl Into<String>) -> Self {
        Self::CouldNot(message.into().into())
    }

    fn reason(&self) -> &Reason {
        let (Self::Usage(reason) | Self::CouldNot(reason)) = self;
        reason
    }

    /// The exit status of the failure.
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Self::Usage(_) => ExitCode::from(2),
            Self::CouldNot(_) => ExitCode::FAILURE,
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, line) in self.reason().message.lines().enumerate() {
            if index > 0 {
                f.write_str(" ")?;
            }
            f.write_str(line.trim())?;
        }
        Ok(())
    }
}

impl Error for Failure {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        let source = self.reason().source.as_deref()?;
        Some(source)
    }
}

impl From<PlaneError> for Failure {
    fn from(error: PlaneError) -> Self {
        Self::Usage(Reason::of(error))
    }
}

impl From<PoseError> for Failure {
    fn from(error: PoseError) -> Self {
        Self::Usage(Reason::of(error))
    }
}

impl From<FormatError> for Failure {
    fn from(error: FormatError) -> Self {
        Self::CouldNot(Reason::of(error))
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        Self::CouldNot(Reason::of(error))
    }
}

impl From<ImageError> for Failure {
    fn from(error: ImageError) -> Self {
        match error {
            ImageError::UnknownFormat { .. } | ImageError::NotForFragments => {
                Self::Usage(Reason::of(error))
            }
            _ => Self::CouldNot(Reason::of(error)),
        }
    }
}

impl From<OutOfMemory> for Failure {
    fn from(error: OutOfMemory) -> Self {
        Self::CouldNot(Reason::of(error))
    }
}

impl From<FragmentError> for Failure {
    fn from(error: FragmentError) -> Self {
        Self::CouldNot(Reason::of(error))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn a_failure_keeps_the_error_that_it_came_from() {
        let missing = raycast_core::formats::read_texture(Path::new("none/there.png"));
        let error = missing.expect_err("there is no such file");
        let message = error.to_string();
        let failure = Failure::from(error);
        assert_eq!(failure.to_string(), message);
        let source = failure.source().expect("a source");
        assert!(source.is::<FormatError>());
        let io = source.source().and_then(|io| io.downcast_ref());
        let io: &std::io::Error = io.expect("the system's own error");
        assert_eq!(io.kind(), std::io::ErrorKind::NotFound);
        assert_eq!(failure, Failure::could_not(message));
        assert!(Failure::usage("no").source().is_none());
    }
}
