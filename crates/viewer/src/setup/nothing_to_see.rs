use super::dropped::reasons;
use crate::failure::{Failure, Reason};
use raycast_core::scene::Dropped;

/// A scene in which no ray can hit anything.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NothingToSee {
    /// The scene's name.
    pub name: String,
    /// Its triangles, all of them dropped.
    pub triangles: usize,
    /// The reasons.
    pub dropped: Dropped,
}

impl std::fmt::Display for NothingToSee {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: there is nothing to see: ", self.name)?;
        match self.triangles {
            0 => f.write_str("it holds no triangle"),
            1 => write!(
                f,
                "its one triangle was dropped: {}",
                reasons(&self.dropped)
            ),
            all => write!(
                f,
                "all of its {all} triangles were dropped: {}",
                reasons(&self.dropped)
            ),
        }
    }
}

impl std::error::Error for NothingToSee {}

impl From<NothingToSee> for Failure {
    fn from(error: NothingToSee) -> Self {
        Self::CouldNot(Reason::of(error))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn says_how_many_were_dropped_and_why() {
        let message = |triangles, zero_area, not_finite| {
            let name = "a.obj".to_owned();
            let dropped = Dropped {
                zero_area,
                not_finite,
                ..Dropped::default()
            };
            NothingToSee {
                name,
                triangles,
                dropped,
            }
            .to_string()
        };
        assert_eq!(
            message(3, 2, 1),
            "a.obj: there is nothing to see: all of its 3 triangles were dropped: 2 without area, 1 not finite"
        );
        assert!(message(1, 1, 0).ends_with("its one triangle was dropped: 1 without area"));
        assert!(message(0, 0, 0).ends_with("it holds no triangle"));
    }
}
