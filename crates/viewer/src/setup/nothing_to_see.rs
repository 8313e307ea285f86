use super::dropped::reasons;
use crate::failure::{Failure, Reason};
use raycast_core::scene::Dropped;

/// A scene in which no ray can hit anything.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NothingToSee {
    /// The scene's name.
    pub name: String,
    /// Its triangles.
    pub triangles: usize,
    /// Those that were dropped, by reason.
    pub dropped: Dropped,
    /// Those of hidden objects that were not dropped. All others are placed where no ray can hit them.
    pub hidden: usize,
}

impl std::fmt::Display for NothingToSee {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: there is nothing to see: ", self.name)?;
        let dropped = self.dropped.total() as usize;
        let misplaced = self.triangles.saturating_sub(dropped + self.hidden);
        let reasons = reasons(&self.dropped);
        match self.triangles {
            0 => f.write_str("it holds no triangle"),
            1 if dropped == 1 => write!(f, "its one triangle was dropped: {reasons}"),
            all if dropped == all => {
                write!(f, "all of its {all} triangles were dropped: {reasons}")
            }
            all => {
                let others = [
                    (self.hidden, "hidden"),
                    (misplaced, "scaled to nothing or too far away"),
                ];
                let others = others.into_iter().filter(|(count, _)| *count > 0);
                let words = (Some(reasons).into_iter().filter(|words| !words.is_empty()))
                    .chain(others.map(|(count, why)| format!("{count} {why}")));
                let words: Vec<_> = words.collect();
                write!(
                    f,
                    "of its {all} triangles none is seen: {}",
                    words.join(", ")
                )
            }
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
        let message_with = |triangles, zero_area, not_finite, hidden| {
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
                hidden,
            }
            .to_string()
        };
        let message =
            |triangles, zero_area, not_finite| message_with(triangles, zero_area, not_finite, 0);
        assert_eq!(
            message(3, 2, 1),
            "a.obj: there is nothing to see: all of its 3 triangles were dropped: 2 without area, 1 not finite"
        );
        assert!(message(1, 1, 0).ends_with("its one triangle was dropped: 1 without area"));
        assert!(message(0, 0, 0).ends_with("it holds no triangle"));
        let all = message_with(9, 2, 0, 3);
        assert!(
            all.ends_with(
                "of its 9 triangles none is seen: 2 without area, 3 hidden, 4 scaled to nothing or too far away"
            ),
            "{all}"
        );
        let hidden = message_with(1, 0, 0, 1);
        assert!(hidden.ends_with("none is seen: 1 hidden"), "{hidden}");
    }
}
