//! The parts of the side panel.

/// A part of the side panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// The list of objects, and the controls of the selected one.
    Objects,
    /// The mode, colours and background.
    Look,
    /// Measurements.
    Measure,
    /// Clipping planes.
    Cut,
    /// Faults of meshes.
    Health,
    /// Faces, and textures on them.
    Surface,
    /// The camera in numbers, and bookmarks.
    Camera,
    /// Resolution, field of view, projection and samples.
    Picture,
    /// How the picture is split.
    Tiles,
    /// Threads, and the work that a picture took.
    Rendering,
}

impl Part {
    /// Its title, which a count may follow.
    pub fn title(self) -> &'static str {
        match self {
            Self::Objects => "Objects",
            Self::Look => "Look",
            Self::Measure => "Measure",
            Self::Cut => "Cut",
            Self::Health => "Health",
            Self::Surface => "Surface",
            Self::Camera => "Camera",
            Self::Picture => "Picture",
            Self::Tiles => "Tiles",
            Self::Rendering => "Rendering",
        }
    }
}
