//! Names for files that are to be written.

use super::{PromptKind, State};

/// A name for a file of this kind after the scene's.
pub fn suggested_name(state: &State, kind: PromptKind) -> String {
    let name = state
        .document
        .as_ref()
        .map(|document| document.name.as_str());
    let stem = name.and_then(|name| name.split('.').next());
    let stem = stem.filter(|stem| !stem.is_empty());
    match kind {
        PromptKind::Scene => format!("{}.raycast.toml", stem.unwrap_or("scene")),
        PromptKind::SceneCopy => format!("{}-copy.raycast.toml", stem.unwrap_or("scene")),
        PromptKind::Measurements => format!("{}.csv", stem.unwrap_or("measurements")),
        // Not the name of a mesh that may be open.
        PromptKind::Meshes => format!("{}-meshes.glb", stem.unwrap_or("scene")),
        PromptKind::Outline(_) => format!("{}-section.svg", stem.unwrap_or("scene")),
        _ => format!("{}.png", stem.unwrap_or("picture")),
    }
}
