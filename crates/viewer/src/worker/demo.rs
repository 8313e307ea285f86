//! The demo scene, which a window without files opens: it is part of the program.

use raycast_core::formats::{FormatError, SceneFile, read_scene_from};

/// The scene file, and the files that it names.
const SCENE: &str = include_str!("../../../../assets/demo.raycast.toml");
const FILES: &[(&str, &[u8])] = &[
    ("cube.obj", include_bytes!("../../../../assets/cube.obj")),
    ("cube.mtl", include_bytes!("../../../../assets/cube.mtl")),
    (
        "dahlia.obj",
        include_bytes!("../../../../assets/dahlia.obj"),
    ),
    (
        "dahlia.mtl",
        include_bytes!("../../../../assets/dahlia.mtl"),
    ),
    (
        "leopard.png",
        include_bytes!("../../../../assets/leopard.png"),
    ),
    (
        "monkey.obj",
        include_bytes!("../../../../assets/monkey.obj"),
    ),
    (
        "monkey.mtl",
        include_bytes!("../../../../assets/monkey.mtl"),
    ),
    (
        "plinth.obj",
        include_bytes!("../../../../assets/plinth.obj"),
    ),
    (
        "plinth.mtl",
        include_bytes!("../../../../assets/plinth.mtl"),
    ),
    ("torus.obj", include_bytes!("../../../../assets/torus.obj")),
    ("torus.mtl", include_bytes!("../../../../assets/torus.mtl")),
];

/// The demo scene.
///
/// # Errors
/// None with the files that the program is built from: a test reads them.
pub fn scene() -> Result<SceneFile, FormatError> {
    read_scene_from(SCENE, &|name| {
        let (_, bytes) = FILES.iter().find(|(file, _)| *file == name)?;
        Some(bytes.to_vec())
    })
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_embedded_scene_is_whole() {
        let file = super::scene().expect("the program's own files");
        assert!(file.warnings.is_empty(), "{:?}", file.warnings);
        assert!(file.scene.objects.len() >= 4);
        assert!(
            file.scene
                .objects
                .iter()
                .any(|object| object.texture.is_some())
        );
        assert!(file.camera.is_some());
    }
}
