use std::fmt;
use std::str::FromStr;

/// The types of edges that have lines: an edge has a line if any chosen type applies.
///
/// As text the types' words are separated by commas: `polygon,feature:30,boundary`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeKinds {
    /// `all`: every edge.
    pub all: bool,
    /// `polygon`: the edges of the file's polygons; every edge if the file has triangles only.
    pub polygon: bool,
    /// `feature[:DEGREES]`: edges at which the surface turns by at least this angle, 0 to 180 degrees.
    pub feature: Option<f32>,
    /// `silhouette`: edges whose two triangles lie on one side of the edge as seen from the eye. The lines lie
    /// outside, over surfaces that are farther away.
    pub silhouette: bool,
    /// `boundary`: edges of one triangle, in a colour of their own.
    pub boundary: bool,
    /// `non-manifold`: edges of more than two triangles, in a colour of their own.
    pub non_manifold: bool,
}

impl EdgeKinds {
    /// Every edge, whatever it is.
    pub const ALL: Self = Self {
        all: true,
        ..Self::NONE
    };

    /// No edge.
    pub const NONE: Self = Self {
        all: false,
        polygon: false,
        feature: None,
        silhouette: false,
        boundary: false,
        non_manifold: false,
    };

    /// The default angle of feature edges, in degrees.
    pub const FEATURE: f32 = 30.0;

    /// Whether the choice depends on the triangles adjacent to an edge.
    pub(crate) fn ask_neighbours(&self) -> bool {
        self.feature.is_some() || self.silhouette || self.boundary || self.non_manifold
    }
}

impl Default for EdgeKinds {
    fn default() -> Self {
        Self::ALL
    }
}

impl fmt::Display for EdgeKinds {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut words = Vec::new();
        let mut add = |is_chosen: bool, word: &str| {
            if is_chosen {
                words.push(word.to_owned());
            }
        };
        add(self.all, "all");
        add(self.polygon, "polygon");
        if let Some(degrees) = self.feature {
            add(true, &format!("feature:{degrees}"));
        }
        add(self.silhouette, "silhouette");
        add(self.boundary, "boundary");
        add(self.non_manifold, "non-manifold");
        f.write_str(&words.join(","))
    }
}

/// A text that names no types of edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "expected kinds of edges with commas between: all, polygon, feature[:DEGREES] (0 to 180), silhouette, boundary, \
     non-manifold"
)]
pub struct EdgeKindsError;

impl FromStr for EdgeKinds {
    type Err = EdgeKindsError;

    fn from_str(text: &str) -> Result<Self, EdgeKindsError> {
        let mut kinds = Self::NONE;
        for word in text.split(',') {
            match word {
                "all" => kinds.all = true,
                "polygon" => kinds.polygon = true,
                "feature" => kinds.feature = Some(Self::FEATURE),
                "silhouette" => kinds.silhouette = true,
                "boundary" => kinds.boundary = true,
                "non-manifold" => kinds.non_manifold = true,
                _ => {
                    let degrees = word.strip_prefix("feature:").ok_or(EdgeKindsError)?;
                    let degrees: f32 = degrees.parse().map_err(|_| EdgeKindsError)?;
                    if !(0.0..=180.0).contains(&degrees) {
                        return Err(EdgeKindsError);
                    }
                    // Turns minus zero into zero.
                    kinds.feature = Some(degrees + 0.0);
                }
            }
        }
        Ok(kinds)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_are_words_and_come_back() {
        for (text, written) in [
            ("all", "all"),
            ("feature,polygon", "polygon,feature:30"),
            (
                "non-manifold,boundary,silhouette",
                "silhouette,boundary,non-manifold",
            ),
            ("feature:-0", "feature:0"),
            ("feature:12.5,all", "all,feature:12.5"),
        ] {
            let kinds: EdgeKinds = text.parse().expect("kinds");
            assert_eq!(kinds.to_string(), written);
            assert_eq!(written.parse(), Ok(kinds));
        }
        for text in [
            "",
            "all,",
            "edges",
            "feature:",
            "feature:181",
            "feature:nan",
            "feature:-1",
        ] {
            assert_eq!(text.parse::<EdgeKinds>(), Err(EdgeKindsError), "{text}");
        }
    }
}
