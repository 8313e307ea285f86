//! Images as textures: PNG, JPEG, PNM.

use super::picture::is_seen_soundly;
use super::reading::{MESH, Reading, read};
use raycast_core::picture::{Format, Picture};
use raycast_core::scene::Texture;

/// What must hold of an image file.
///
/// # Errors
/// What does not.
pub fn check(bytes: &[u8]) -> Result<(), String> {
    let Ok(file) = read_with(bytes)? else {
        return Ok(());
    };
    let object = file.scene.objects.first().ok_or("no object")?;
    let texture = object.texture.as_ref().ok_or("no texture")?;
    let picture = Picture {
        width: texture.width(),
        height: texture.height(),
        pixels: texture.texels().to_vec(),
        layers: None,
    };
    let png = picture
        .encode(Format::Png)
        .map_err(|error| error.to_string())?;
    let again = read_with(&png)?.map_err(|error| format!("as PNG it is refused: {error}"))?;
    let texture_of = |object: &raycast_core::scene::Object| object.texture.clone();
    let again = again.scene.objects.first().and_then(texture_of);
    if again
        .as_ref()
        .is_none_or(|again: &std::sync::Arc<Texture>| again != texture)
    {
        return Err("as PNG it is read as another image".to_owned());
    }
    is_seen_soundly(&file)
}

fn read_with(image: &[u8]) -> Result<Reading, String> {
    let files = |name: &str| match name {
        "mesh.obj" => Some(MESH.into()),
        "image" => Some(image.to_vec()),
        _ => None,
    };
    let scene =
        "[shading]\nmode = \"texture\"\n\n[[object]]\nmesh = \"mesh.obj\"\ntexture = \"image\"\n";
    read(scene, &files)
}
