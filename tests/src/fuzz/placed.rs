//! What holds of every file that places several objects.

use super::mesh::is_sound;
use super::picture::is_seen_soundly;
use super::reading::{Reading, is_message};
use raycast_core::formats::{SaveError, SceneFile};
use raycast_core::scene::Mesh;
use std::path::Path;
use std::sync::Arc;

/// Of more objects than this nothing is drawn: that takes longer than a fuzzer waits.
const MAX_OBJECTS: usize = 4096;

/// Whether all meshes are sound, and the scene, saved and read again, is the same to the last bit.
///
/// # Errors
/// The first thing that does not hold.
pub fn is_placed_soundly(
    file: &SceneFile,
    read: impl Fn(&str) -> Result<Reading, String>,
) -> Result<(), String> {
    let objects = &file.scene.objects;
    if objects.len() > MAX_OBJECTS {
        return Ok(());
    }
    let mut last: Option<&Arc<Mesh>> = None;
    for object in objects {
        if last.is_none_or(|last| !Arc::ptr_eq(last, &object.mesh)) {
            is_sound(&object.mesh)?;
        }
        last = Some(&object.mesh);
    }
    let saved = match file.to_toml(Path::new("")) {
        Err(SaveError::Scene(refusal)) => return is_message(&refusal.to_string()),
        saved => saved.map_err(|error| format!("it cannot be saved: {error}"))?,
    };
    let again = read(&saved)?.map_err(|error| format!("saved, it is refused: {error}"))?;
    if again.scene.content() != file.scene.content() {
        return Err(format!("saved as {saved:?} it is another scene"));
    }
    is_seen_soundly(file)
}
